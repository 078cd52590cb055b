#include "io/convert/checks/same_scans.hpp"

#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "core/util/format.hpp"

namespace clearway {

std::optional<Message> warning_on_same_scans(std::span<const std::filesystem::path> files,
                                             std::span<const SourceFile> sources,
                                             std::span<const FileBox> boxes) {
  constexpr std::size_t kNamed = 3;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> first_with;
  std::size_t count = 0;
  std::uint64_t points = 0;
  std::string names;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (boxes[i].points == 0) continue;
    const auto [first, is_new] = first_with.try_emplace({sources[i].bytes, sources[i].xxh64}, i);
    if (is_new) continue;
    points += boxes[i].points;
    if (count++ >= kNamed) continue;
    std::error_code ignored;
    const std::filesystem::path& earlier = files[first->second];
    const bool one_file = std::filesystem::equivalent(files[i], earlier, ignored);
    names += (names.empty() ? "" : "; ") + files[i].string() +
             (one_file ? " is the same file as " : " has the same bytes as ") + earlier.string();
  }
  if (count == 0) return std::nullopt;
  if (count > kNamed) names += "; and " + std::to_string(count - kNamed) + " more";
  return Message{Message::Severity::kWarning,
                 "same-scan",
                 names + ": " + format_count(points) + " points are in the store twice",
                 {{"files", static_cast<double>(count)}, {"points", static_cast<double>(points)}}};
}

}  // namespace clearway
