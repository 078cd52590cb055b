#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"

namespace clearway {

/// A warning of the searches that wrote the parts.
// NOLINTNEXTLINE(bugprone-exception-escape): of messages that are moved
struct PartWarning : Message {
  std::uint32_t parts = 0;  ///< in how many it is
};

struct MergeOptions {
  int threads = 0;  ///< 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  bool overwrite = false;  ///< an existing result
  bool resume = false;     ///< leaves a result of the same parts as it is
  bool strict = false;     ///< any warning of a part ends with InputError, nothing merged
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< the warnings that the report holds, each once
  StopFlag stop = nullptr;
};

/// What the merged result says. The answer of a result that was there already is read from its
/// file.
struct MergeReport : Answer {
  bool was_finished = false;  ///< the result was there already
  std::string length_unit;    ///< of the environment, as Store::length_unit
  std::uint32_t parts = 0;
  std::vector<PartWarning> warnings = {};  ///< each once, in the order of the parts
};

/// Makes one result of all parts that searches with SearchOptions::shard wrote, in any order: the
/// bytes that one search of everything writes. Throws InputError, naming the files, for parts of
/// different questions, stores or numbers of parts, for one that is missing, there twice or
/// damaged, and for what is no part; the same for parts that were computed in different ways, where
/// the answer depends on it. UsageError for an output that exists or is a part; ResourceError for a
/// full disk, too little memory, or more parts than files that the process may open (ulimit -n);
/// Interrupted when asked to stop.
MergeReport merge(const std::vector<std::filesystem::path>& parts,
                  const std::filesystem::path& output, const MergeOptions& options = {});

}  // namespace clearway
