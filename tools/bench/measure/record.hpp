#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace clearway::bench {

using Json = nlohmann::ordered_json;

/// The JSON file of an experiment: what was measured where, and its cases. Each case is written as
/// soon as it is measured, so that an interrupted experiment can go on from there.
class Record {
 public:
  /// header: experiment, size, machine, clearway, parameters. An existing file is refused with
  /// UsageError unless `force`, which replaces it, or `resume`, which continues it where its header
  /// is equal except for the parameters "limit" (seconds) and "scenes", to which those of
  /// `header` are added.
  Record(std::filesystem::path path, const Json& header, bool resume, bool force);

  bool empty() const { return all_["cases"].empty(); }

  /// The case with that key; nullptr where there is none, or where a smaller limit than the
  /// header's stopped it, so that it is to be measured anew.
  const Json* find(const std::string& key) const;
  /// Adds a case, in place of one with the same "key", and returns it. Throws ResourceError where
  /// the file cannot be written.
  Json add(Json of_case);

 private:
  void write() const;

  std::filesystem::path path_;
  Json all_;
};

}  // namespace clearway::bench
