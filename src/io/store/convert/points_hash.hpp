#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/geometry/quantisation.hpp"
#include "io/files/xxh64.hpp"
#include "io/store/convert/quanta_batch.hpp"

namespace clearway {

/// Hash that identifies the stored points: XXH64 over scale, offset, the integers of all points in
/// source order, the source indices of those that directly follow a dropped (non-finite) point, and
/// the number of input points. Independent of file format, batches, layout and cell size.
class PointsHash {
 public:
  explicit PointsHash(const Quantisation& quantisation) {
    quanta_.update(std::as_bytes(std::span(&quantisation, 1)));
  }

  void add(const QuantaBatch& batch) {
    quanta_.update(std::as_bytes(std::span(batch.quanta)));
    for (std::size_t i = 0; i < batch.offsets.size(); ++i) {
      const std::uint64_t source = batch.source(i);
      if (source != expected_) sources_.update(std::as_bytes(std::span(&source, 1)));
      expected_ = source + 1;
    }
    if (batch.offsets.empty()) {
      if (!batch.quanta.empty() && batch.first_source != expected_) {
        sources_.update(std::as_bytes(std::span(&batch.first_source, 1)));
      }
      expected_ = batch.first_source + batch.quanta.size();
    }
  }

  std::uint64_t digest(std::uint64_t input_points) const {
    const std::uint64_t parts[3] = {quanta_.digest(), sources_.digest(), input_points};
    return xxh64(std::as_bytes(std::span(parts)));
  }

 private:
  Xxh64Stream quanta_;
  Xxh64Stream sources_;
  std::uint64_t expected_ = 0;  ///< source index of the next point if none is dropped
};

/// Hash of the classes of the stored points: XXH64 of one byte per point, in source order.
class ClassesHash {
 public:
  void add(const QuantaBatch& batch) {
    if (batch.classes.empty()) {
      zeros_ += batch.quanta.size();  // hashed only once points with classes follow
      return;
    }
    add_zeros();
    hash_.update(std::as_bytes(std::span(batch.classes)));
  }

  std::uint64_t digest() {
    add_zeros();
    return hash_.digest();
  }

 private:
  void add_zeros() {
    static constexpr std::array<std::byte, 4096> kZeros{};
    for (; zeros_ > 0; zeros_ -= std::min<std::uint64_t>(zeros_, kZeros.size())) {
      hash_.update(std::span(kZeros).first(std::min<std::uint64_t>(zeros_, kZeros.size())));
    }
  }

  Xxh64Stream hash_;
  std::uint64_t zeros_ = 0;  ///< number of points of class 0 that are not hashed yet
};

}  // namespace clearway
