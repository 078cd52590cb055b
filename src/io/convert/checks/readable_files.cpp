#include "io/convert/checks/readable_files.hpp"

#include "clearway/error.hpp"
#include "core/util/format.hpp"

namespace clearway {

ReadableFiles readable_files(std::span<const std::filesystem::path> files,
                             const PointReadOptions& how_to_read, Progress& progress) {
  ReadableFiles out;
  PointBatch batch;
  progress.begin("check", 0, "points");
  for (const std::filesystem::path& file : files) {
    try {
      const auto reader = open_point_file(file, how_to_read);
      while (reader->read(batch)) {
        throw_if_stopped(progress);
        progress.advance(batch.size());
      }
      out.files.push_back(file);
    } catch (const InputError& error) {
      out.reasons.emplace_back(error.what());
    }
  }
  progress.end();
  if (out.files.empty() && !out.reasons.empty()) {
    throw InputError("none of the " + format_count(files.size()) +
                     " files can be read, expected one at least; the first: " + out.reasons[0]);
  }
  return out;
}

std::optional<Message> warning_on_skipped(std::span<const std::string> reasons) {
  constexpr std::size_t kNamed = 10;
  if (reasons.empty()) return std::nullopt;
  std::string text = format_count(reasons.size()) +
                     (reasons.size() == 1 ? " file is left out" : " files are left out");
  for (std::size_t i = 0; i < reasons.size() && i < kNamed; ++i) text += "; " + reasons[i];
  if (reasons.size() > kNamed) text += "; and " + std::to_string(reasons.size() - kNamed) + " more";
  return Message{Message::Severity::kWarning,
                 "skipped-files",
                 text,
                 {{"files", static_cast<double>(reasons.size())}}};
}

}  // namespace clearway
