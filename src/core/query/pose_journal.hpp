#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/query/search_result.hpp"

namespace clearway {

/// The points 64 * word + i, for all set bits i, that the model touches at `pose` or, without first
/// poses, at some pose.
struct PoseMark {
  std::uint64_t word;
  std::uint64_t bits;
  std::uint32_t pose;
};

/// Keeps what an engine that works pose by pose has found, so that another run can continue from
/// it. A mark is true whatever becomes of the poses around it; poses are finished when every mark
/// that they need was appended before.
class PoseJournal {
 public:
  virtual ~PoseJournal() = default;

  /// Adds the marks that are kept to `hits`.
  virtual void restore(HitSet& hits) const = 0;
  /// Whether all of the poses were finished.
  virtual bool poses_finished(std::uint32_t first, std::uint32_t count) const = 0;

  // The functions that append are thread safe:
  virtual void append_marks(std::span<PoseMark> marks) = 0;  ///< may reorder the marks
  virtual void append_finished_poses(std::uint32_t first, std::uint32_t count) = 0;
};

/// The marks of one thread on their way to a journal, in a buffer of fixed size.
class PoseMarkLog {
 public:
  /// journal: null keeps nothing.
  explicit PoseMarkLog(PoseJournal* journal) : journal_(journal) {
    if (journal_ != nullptr) marks_.reserve(kMarks);
  }

  void add(std::uint64_t word, std::uint64_t bits, std::uint32_t pose) {
    if (journal_ == nullptr) return;
    marks_.push_back({word, bits, pose});
    if (marks_.size() == kMarks) flush();
  }
  void flush() {
    if (!marks_.empty()) journal_->append_marks(marks_);
    marks_.clear();
  }

 private:
  static constexpr std::size_t kMarks = 4096;

  PoseJournal* journal_;
  std::vector<PoseMark> marks_;
};

}  // namespace clearway
