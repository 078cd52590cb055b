#include "io/files/kept_warnings.hpp"

#include <cstdint>
#include <span>

#include "core/util/shortened.hpp"
#include "io/files/input_error.hpp"

namespace clearway {
namespace {

namespace names {
constexpr const char* kWarningsGroup = "warnings";  // one group per warning, named from 0
constexpr const char* kWarningCount = "count";
constexpr const char* kCode = "code";
constexpr const char* kMessage = "message";
constexpr const char* kNumberNames = "names";  // one per line; only where there are numbers
constexpr const char* kNumbers = "numbers";
constexpr const char* kStretchCount = "stretch_count";  // only where there are stretches
constexpr const char* kStretches = "stretches";         // stretch_count x 2 poses
}  // namespace names

/// Most bytes of a warning's text; an attribute holds at most 64 KiB.
constexpr std::size_t kMostTextBytes = 1 << 15;
constexpr std::uint32_t kMostWarnings = 1 << 16;
constexpr std::uint32_t kMostNumbers = 1 << 10;
constexpr std::uint32_t kMostStretches = 1 << 12;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// Writes the stretches. Where an attribute cannot hold them all, the last one reaches from the
/// first that does not fit to the end, so that no pose of a stretch is lost.
void write_stretches(const hdf5::Id& group, std::vector<PoseRange> stretches) {
  if (stretches.empty()) return;
  if (stretches.size() > kMostStretches) {
    stretches[kMostStretches - 1].last = stretches.back().last;
    stretches.resize(kMostStretches);
  }
  std::vector<std::uint32_t> ends;
  for (const PoseRange& stretch : stretches) {
    ends.insert(ends.end(), {stretch.first, stretch.last});
  }
  hdf5::write_number(group, names::kStretchCount, static_cast<std::uint32_t>(stretches.size()));
  hdf5::write_attribute(group, names::kStretches, std::span<const std::uint32_t>(ends), 2);
}

std::vector<PoseRange> read_stretches(const hdf5::Id& group, const std::string& name) {
  std::vector<PoseRange> stretches;
  if (!hdf5::has_attribute(group, names::kStretchCount, name)) return stretches;
  const auto count = hdf5::read_number<std::uint32_t>(group, names::kStretchCount, name);
  if (count == 0 || count > kMostStretches) {
    refuse(name, "/warnings holds a warning with " + std::to_string(count) +
                     " stretches, expected 1 to " + std::to_string(kMostStretches));
  }
  const auto ends =
      hdf5::read_attribute<std::uint32_t>(group, names::kStretches, std::size_t{2} * count, name);
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const PoseRange stretch{ends[i], ends[i + 1]};
    const bool follows = stretches.empty() || stretch.first > stretches.back().last;
    if (stretch.first > stretch.last || !follows) {
      refuse(name, "the stretches of a warning in /warnings do not ascend");
    }
    stretches.push_back(stretch);
  }
  return stretches;
}

void write_warning(const hdf5::Id& group, const Message& warning) {
  hdf5::write_attribute(group, names::kCode, warning.code);
  hdf5::write_attribute(group, names::kMessage, shortened(warning.text, kMostTextBytes));
  write_stretches(group, warning.stretches);
  if (warning.numbers.empty()) return;
  std::string lines;
  std::vector<double> numbers;
  for (const auto& [name, number] : warning.numbers) {
    lines += name + "\n";
    numbers.push_back(number);
  }
  hdf5::write_attribute(group, names::kNumberNames, lines);
  hdf5::write_attribute(group, names::kNumbers, std::span<const double>(numbers));
}

Message read_warning(const hdf5::Id& group, const std::string& name) {
  Message warning{Message::Severity::kWarning, hdf5::read_text_attribute(group, names::kCode, name),
                  hdf5::read_text_attribute(group, names::kMessage, name)};
  warning.stretches = read_stretches(group, name);
  if (!hdf5::has_attribute(group, names::kNumberNames, name)) return warning;
  const auto lines = lines_of(hdf5::read_text_attribute(group, names::kNumberNames, name));
  if (lines.empty() || lines.size() > kMostNumbers) {
    refuse(name, "/warnings holds a warning with " + std::to_string(lines.size()) +
                     " numbers, expected 1 to " + std::to_string(kMostNumbers));
  }
  const auto numbers = hdf5::read_attribute<double>(group, names::kNumbers, lines.size(), name);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    warning.numbers.emplace_back(lines[i], numbers[i]);
  }
  return warning;
}

}  // namespace

void write_warnings(const hdf5::Id& file, const std::vector<Message>& warnings) {
  const hdf5::Id all = hdf5::create_group(file, names::kWarningsGroup);
  hdf5::write_number(all, names::kWarningCount, static_cast<std::uint32_t>(warnings.size()));
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    write_warning(hdf5::create_group(all, std::to_string(i)), warnings[i]);
  }
}

std::vector<Message> read_warnings(const hdf5::Id& file, const std::string& name) {
  const hdf5::Id all = hdf5::open_group(file, names::kWarningsGroup, name);
  const auto count = hdf5::read_number<std::uint32_t>(all, names::kWarningCount, name);
  if (count > kMostWarnings) {
    refuse(name, "attribute 'count' of /warnings is " + std::to_string(count) +
                     ", expected at most " + std::to_string(kMostWarnings));
  }
  std::vector<Message> warnings;
  for (std::uint32_t i = 0; i < count; ++i) {
    warnings.push_back(read_warning(hdf5::open_group(all, std::to_string(i), name), name));
  }
  return warnings;
}

}  // namespace clearway
