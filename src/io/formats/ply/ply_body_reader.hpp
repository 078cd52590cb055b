#pragma once

#include <cstdint>
#include <utility>

#include "io/formats/input_buffer.hpp"
#include "io/formats/ply/ply_header.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// What the readers of both kinds of PLY file share: the way past the elements before and behind
/// the vertices.
class PlyBodyReader : public PointReader {
 public:
  const CloudInfo& info() const override { return info_; }

  void rewind() override {
    input_.return_to(first_vertex_);
    next_ = 0;
    finished_ = false;
  }

 protected:
  PlyBodyReader(InputBuffer input, PlyHeader header)
      : input_(std::move(input)), header_(std::move(header)) {
    info_.declared_points = header_.vertices().count;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "face") info_.faces += element.count;
    }
  }

  /// Consumes every row of an element.
  virtual void skip_element(const PlyElement& element) = 0;

  /// From behind the header to the first vertex.
  void begin() {
    for (std::size_t i = 0; i < header_.vertex; ++i) skip_element(header_.elements[i]);
    first_vertex_ = input_.mark();
  }

  /// From behind the last vertex to the end; the second time does nothing.
  void finish() {
    if (finished_) return;
    for (std::size_t i = header_.vertex + 1; i < header_.elements.size(); ++i) {
      skip_element(header_.elements[i]);
    }
    finished_ = true;
  }

  InputBuffer input_;
  PlyHeader header_;
  std::uint64_t next_ = 0;  ///< vertex to read next

 private:
  CloudInfo info_;
  InputBuffer::Mark first_vertex_;
  bool finished_ = false;
};

}  // namespace clearway
