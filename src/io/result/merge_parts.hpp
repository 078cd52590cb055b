#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/merge.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// All parts of one result, in the order of their numbers.
class PartSet {
 public:
  /// Opens the files. Throws InputError, with their names, unless they are the parts of one result,
  /// each once; ResourceError where the process may not open so many files.
  explicit PartSet(const std::vector<std::filesystem::path>& files);

  const std::vector<ResultReader>& parts() const { return parts_; }
  /// The header of the result that the parts make.
  const ResultHeader& header() const { return header_; }
  /// The warnings of the runs of the parts, each once, in the order of the parts.
  std::vector<PartWarning> warnings() const;
  std::uint64_t collisions() const;
  std::uint64_t clearances() const;
  std::uint64_t near() const;
  /// The findings of all parts together, with the warnings of each part, except which points are
  /// certainly too close, which certain_points_in() finds.
  ResultFindings findings() const;
  /// The answer of all parts, without what only reading their rows shows: places, points inside the
  /// model and poses of the profile.
  Answer answer() const;

 private:
  std::vector<ResultReader> parts_;
  ResultHeader header_;
};

/// What all parts together know of seen space.
struct MergedSpace {
  UnseenCubes unseen;  ///< the cubes that the beams of no part saw
  SweptCells swept;    ///< the same in all parts, because each sweeps the whole query
};

/// Throws ResourceError where merging takes more memory than this.
void check_merge_memory(const PartSet& set, std::uint64_t memory_bytes);

/// Writes the result of all parts to `path`, with a few rows of each part in memory, and sets
/// `summary` to what its tables say in short. space: only where seen space is asked for. findings:
/// those of the whole result. Every row is read once and checked against its part's hash. Throws
/// InputError for damaged parts and for a point that is in two of them, ResourceError for a full
/// disk or too little memory, and Interrupted.
void merge_parts(const PartSet& set, const std::optional<MergedSpace>& space,
                 const std::filesystem::path& path, std::uint64_t memory_bytes,
                 const ResultFindings& findings, Progress& progress, TableSummary& summary);

}  // namespace clearway
