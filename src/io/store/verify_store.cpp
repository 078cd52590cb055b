#include "io/store/verify_store.hpp"

#include <algorithm>
#include <unordered_set>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {
namespace {

/// Source indices seen so far: one bit for each point of the input, or a set of indices where so
/// few points are stored that the bits would take more memory.
class SeenSources {
 public:
  explicit SeenSources(const StoreMetadata& metadata) : end_(metadata.input_points) {
    if (end_ / kIndexBits <= metadata.point_count) bits_.resize(end_, false);
  }

  /// Returns false where the index is out of range or was inserted before.
  bool insert(std::uint64_t source) {
    if (source >= end_) return false;
    if (bits_.empty()) return indices_.insert(source).second;
    if (bits_[source]) return false;
    bits_[source] = true;
    return true;
  }

 private:
  static constexpr std::uint64_t kIndexBits = 512;  // bits that an index takes in a set, roughly

  std::uint64_t end_;
  std::vector<bool> bits_;
  std::unordered_set<std::uint64_t> indices_;
};

class Verification {
 public:
  explicit Verification(const StoreReader& store) : store_(store), seen_(store.metadata()) {}

  /// Checks a cell. Throws InputError with its first fault.
  void check(std::uint32_t cell) {
    const auto coordinates = store_.coordinates(cell);
    for (std::size_t k = 0; k < 3; ++k) {
      values_[k].resize(store_.cell_points());
      coordinates[k].decode(0, values_[k]);
    }
    sources_.resize(store_.cell_points());
    store_.sources(cell).decode(0, sources_);
    check_boxes(cell);
    check_order(cell);
    if (store_.has_classes()) check_classes(cell);
    if (store_.has_origins()) check_origins(cell);
  }

  /// Called after all cells. Throws InputError where the numbers of points per class, or of points
  /// without an origin, are not those that the store states.
  void check_counts() const {
    if (store_.has_classes() && class_points_ != store_.metadata().classes->points) {
      throw InputError(store_.name() + ": its classes have other numbers of points than it says");
    }
    if (store_.has_origins() && without_origin_ != store_.metadata().origins->points_without) {
      throw InputError(store_.name() + ": " + std::to_string(without_origin_) +
                       " of its points have no origin, expected " +
                       std::to_string(store_.metadata().origins->points_without));
    }
  }

 private:
  [[noreturn]] void fail(std::uint32_t cell, const std::string& what) const {
    throw InputError(store_.name() + ": cell " + std::to_string(cell) + ": " + what);
  }

  QuantumBox box_of(std::uint32_t first, std::uint32_t end) const {
    QuantumBox box;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [lo, hi] =
          std::minmax_element(values_[k].begin() + first, values_[k].begin() + end);
      box.lo[k] = *lo;
      box.hi[k] = *hi;
    }
    return box;
  }

  void check_boxes(std::uint32_t cell) const {
    const Cell& known = store_.cells()[cell];
    if (!(box_of(0, known.count) == known.box)) fail(cell, "its box is not that of its points");
    const BlockBoxes blocks = store_.blocks(cell);
    for (std::uint32_t first = 0; first < known.count; first += kBlockPoints) {
      const std::uint32_t end = std::min(known.count, first + kBlockPoints);
      if (!(blocks[first / kBlockPoints] == encode_block_box(known.box, box_of(first, end)))) {
        fail(cell, "the box of block " + std::to_string(first / kBlockPoints) +
                       " is not that of its points");
      }
    }
  }

  void check_order(std::uint32_t cell) {
    const std::uint32_t count = store_.cells()[cell].count;
    for (std::uint32_t i = 0; i < store_.cell_points(); ++i) {
      const std::uint64_t source = sources_[i];
      if (i >= count) {
        if (source != sources_[count - 1]) fail(cell, "its padding is not its last point");
        continue;
      }
      if (!seen_.insert(source)) {
        fail(cell,
             "source index " + std::to_string(source) + " is out of range or twice in the store");
      }
      if (i % kBlockPoints != 0 && source <= sources_[i - 1]) {
        fail(cell, "a block is not in the order of its source indices");
      }
    }
  }

  void check_classes(std::uint32_t cell) {
    const std::uint32_t count = store_.cells()[cell].count;
    classes_.resize(store_.cell_points());
    store_.classes(cell).decode(0, classes_);
    for (std::uint32_t i = 0; i < count; ++i) ++class_points_[classes_[i]];
    const std::uint8_t last = classes_[count - 1];
    const auto repeats = [last](std::uint8_t value) { return value == last; };
    if (!std::all_of(classes_.begin() + count, classes_.end(), repeats)) {
      fail(cell, "the padding of its classes is not that of its last point");
    }
  }

  void check_origins(std::uint32_t cell) {
    const std::uint32_t count = store_.cells()[cell].count;
    const std::size_t known = store_.metadata().origins->quanta.size();
    origins_.resize(store_.cell_points());
    store_.origins(cell).decode(0, origins_);
    for (std::uint32_t i = 0; i < store_.cell_points(); ++i) {
      if (origins_[i] > known) {
        fail(cell, "origin " + std::to_string(origins_[i]) + " of " + std::to_string(known));
      }
      if (i < count) without_origin_ += origins_[i] == 0;
      if (i >= count && origins_[i] != origins_[count - 1]) {
        fail(cell, "the padding of its origins is not that of its last point");
      }
    }
  }

  const StoreReader& store_;
  SeenSources seen_;
  std::vector<std::uint8_t> classes_;
  std::array<std::uint64_t, 256> class_points_{};
  std::vector<std::uint32_t> origins_;
  std::uint64_t without_origin_ = 0;
  std::array<std::vector<std::int32_t>, 3> values_;
  std::vector<std::uint64_t> sources_;
};

}  // namespace

std::vector<std::string> verify_store(const StoreReader& store, Progress& progress,
                                      std::size_t most) {
  std::vector<std::string> faults;
  Verification verification(store);
  progress.begin("verify", store.point_count(), "points");
  for (std::uint32_t cell = 0; cell < store.cells().size() && faults.size() < most; ++cell) {
    try {
      verification.check(cell);
    } catch (const InputError& fault) {
      faults.emplace_back(fault.what());
    }
    progress.advance(store.cells()[cell].count);
  }
  if (faults.empty()) {
    try {
      verification.check_counts();
    } catch (const InputError& fault) {
      faults.emplace_back(fault.what());
    }
  }
  progress.end();
  return faults;
}

}  // namespace clearway
