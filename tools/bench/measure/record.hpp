#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace clearway::bench {

using Json = nlohmann::ordered_json;

/// The JSON file of an experiment: what was measured where, and its cases, each written as soon as
/// it is there, so that an experiment that was stopped goes on where it was.
class Record {
 public:
  /// header: experiment, size, machine, clearway, parameters. An existing file is refused with
  /// UsageError unless `force`, which replaces it, or `resume`, which goes on with it where its
  /// header is the same but for the parameter "limit" (seconds).
  Record(std::filesystem::path path, const Json& header, bool resume, bool force);

  bool empty() const { return all_["cases"].empty(); }

  /// The case of that key, or nullptr; that too for one that was stopped by a smaller limit than
  /// the header's, which is to be measured anew.
  const Json* find(const std::string& key) const;
  /// Adds and gives back a case; it replaces one of its "key". Throws ResourceError where the file
  /// cannot be written.
  Json add(Json of_case);

 private:
  void write() const;

  std::filesystem::path path_;
  Json all_;
};

}  // namespace clearway::bench
