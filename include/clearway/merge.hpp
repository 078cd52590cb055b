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

/// A warning of the searches that wrote the parts, with the number of parts that have it.
// NOLINTNEXTLINE(bugprone-exception-escape): of messages that are moved
struct PartWarning : Message {
  std::uint32_t parts = 0;  ///< number of parts that have this warning
};

struct MergeOptions {
  int threads = 0;  ///< 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  bool overwrite = false;  ///< replaces an existing result
  bool resume = false;     ///< leaves an existing result of the same parts as it is
  bool strict = false;     ///< any warning of a part ends with InputError, and nothing is merged
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< receives the warnings that the report holds, each once
  StopFlag stop = nullptr;
};

/// What the merged result says. If the result existed already, its answer is read from its file.
struct MergeReport : Answer {
  bool was_finished = false;  ///< true if the result existed already, so that nothing was merged
  std::string length_unit;    ///< unit of the environment, as in Store::length_unit()
  std::uint32_t parts = 0;
  /// The warnings of the parts, each once and in the order of the parts, and then those that only
  /// the merge can give. Where the parts count beams, Answer::warnings has their sums instead.
  std::vector<PartWarning> part_warnings = {};
};

/// Merges all parts that searches with SearchOptions::shard wrote into one result. The parts may be
/// in any order; the file has the bytes that one search of everything writes. Throws InputError,
/// naming the files, for parts of different questions, stores or numbers of parts; for a part that
/// is missing, given twice or damaged; for a file that is not a part; and for parts that were
/// computed in different ways, if the answer depends on it. UsageError for an output that exists or
/// is a part; ResourceError for a full disk, too little memory, or more parts than files that the
/// process may open (ulimit -n); Interrupted when asked to stop.
MergeReport merge(const std::vector<std::filesystem::path>& parts,
                  const std::filesystem::path& output, const MergeOptions& options = {});

}  // namespace clearway
