#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

/// What `clearway check` remembers of the files in its folder, so that it makes none again that is
/// still right. A record that is missing, damaged or of another release only costs time.
namespace clearway::tool {

inline constexpr const char* kRecordName = "check.json";

/// All that the output of a step depends on: its options, but for those that change no byte of it,
/// and what identifies the contents of all files that they name: of a store its fingerprint and
/// sources, and of a vehicle its files. step: the command, parsed.
nlohmann::ordered_json key_of(const CLI::App& step);

class CheckRecord {
 public:
  /// Reads the record in a folder.
  explicit CheckRecord(std::filesystem::path folder);

  /// Whether the folder has a record, which says that its files are those of a check.
  bool exists() const;

  /// What was noted about a file of the folder, provided that it was made for `what` and has not
  /// changed since; otherwise null.
  nlohmann::ordered_json find(const std::string& name, const nlohmann::ordered_json& what) const;

  /// Notes that a file of the folder was made for `what`, with anything worth remembering.
  void note(const std::string& name, const nlohmann::ordered_json& what,
            const nlohmann::ordered_json& remembered);

  /// How wide the corridor of the store had to be for `what`, in metres; 0 where nothing is noted.
  double corridor(const nlohmann::ordered_json& what) const;
  void note_corridor(const nlohmann::ordered_json& what, double metres);

  /// Writes the file of the record, unless it is there with these contents. Throws ResourceError.
  void write() const;

 private:
  std::filesystem::path folder_;
  nlohmann::ordered_json read_, now_;
};

}  // namespace clearway::tool
