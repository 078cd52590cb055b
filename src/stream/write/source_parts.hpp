#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/store/store_reader.hpp"
#include "io/system/input_error.hpp"
#include "stream/write/set_cells.hpp"

namespace clearway {

/// The source indices in parts of 2^16. Because no two points have the same one, a part has at most
/// that many rows.
class SourceParts {
 public:
  static constexpr unsigned kBits = 16;
  static constexpr std::uint64_t kMostRows = std::uint64_t{1} << kBits;

  explicit SourceParts(std::uint64_t sources) : parts_((sources + kMostRows - 1) >> kBits) {}
  explicit SourceParts(const StoreReader& store) : SourceParts(store.metadata().input_points) {}

  std::size_t count() const { return parts_; }
  static std::size_t of(std::uint64_t source) { return source >> kBits; }

 private:
  std::size_t parts_;
};

/// One thread's view of a cell's entries in a set: those whose source indices are in some parts.
class CellRows {
 public:
  struct Row {
    std::uint64_t source;
    std::uint64_t entry;
  };

  explicit CellRows(const SourceParts& parts) : counts_(parts.count()) {}

  /// Memory of each thread, bytes.
  static std::uint64_t most_bytes(const StoreReader& store) {
    return SourceParts(store).count() * (sizeof(std::uint32_t) + sizeof(std::uint64_t)) +
           std::uint64_t{store.cell_entries()} * (sizeof(Row) + sizeof(std::size_t));
  }

  /// Replaces the rows by those of a cell. Throws InputError for a damaged cell.
  template <typename Set>
  void take(const StoreReader& store, const Set& set, std::uint32_t cell, std::size_t first_part,
            std::size_t end_part) {
    for (const std::size_t part : parts_) counts_[part] = 0;
    parts_.clear();
    rows_.clear();
    rows_.reserve(store.cell_entries());
    const PackedChunk<std::uint64_t> sources = store.sources(cell);
    if (SourceParts::of(sources.minimum()) >= end_part && end_part < counts_.size()) return;
    for_each_entry(store, set, cell, [&](std::uint64_t entry, std::uint32_t i) {
      const std::uint64_t source = sources[i];
      const std::size_t part = SourceParts::of(source);
      if (part < first_part || part >= end_part) {
        if (part >= counts_.size()) refuse_source(store, cell, source);
        return;
      }
      rows_.push_back({source, entry});
      if (counts_[part]++ == 0) parts_.push_back(part);
    });
  }

  const std::vector<Row>& rows() const { return rows_; }
  /// The parts that have rows, in no particular order.
  const std::vector<std::size_t>& parts() const { return parts_; }
  std::uint32_t rows_of(std::size_t part) const { return counts_[part]; }

 private:
  [[noreturn]] static void refuse_source(const StoreReader& store, std::uint32_t cell,
                                         std::uint64_t source) {
    refuse(store.name(), "cell " + std::to_string(cell) + ": source index " +
                             std::to_string(source) + ", expected one below " +
                             std::to_string(store.metadata().input_points));
  }

  std::vector<std::uint32_t> counts_;
  std::vector<std::size_t> parts_;
  std::vector<Row> rows_;
};

}  // namespace clearway
