#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "core/messages/messages.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/ply/ply_header.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Base of the readers of both kinds of PLY file: skips the elements before the vertices and checks
/// the end after them. Elements after the vertices are not read and not checked.
class PlyBodyReader : public PointReader {
 public:
  const CloudInfo& info() const override { return info_; }

  void rewind() override {
    input_.return_to(first_vertex_);
    info_.remarks.clear();
    next_ = 0;
  }

 protected:
  PlyBodyReader(InputBuffer input, PlyHeader header)
      : input_(std::move(input)), header_(std::move(header)) {
    info_.declared_points = header_.vertices().count;
    info_.model_spacing = header_.model_spacing;
    if (header_.unit) {
      info_.unit = header_.unit->environment;
      info_.any_foot = header_.unit->any_foot;
    }
    info_.unplaced = header_.unplaced;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "face") info_.faces += element.count;
    }
  }

  /// Consumes every row of an element.
  virtual void skip_element(const PlyElement& element) = 0;

  /// Moves the input from after the header to the first vertex.
  void begin() {
    for (std::size_t i = 0; i < header_.vertex; ++i) skip_element(header_.elements[i]);
    first_vertex_ = input_.mark();
  }

  /// Whether the file should end with the vertices, because no element after them has a row.
  bool vertices_end_file() const {
    const auto behind = header_.elements.begin() + static_cast<std::ptrdiff_t>(header_.vertex) + 1;
    return std::all_of(behind, header_.elements.end(),
                       [](const PlyElement& element) { return element.count == 0; });
  }

  InputBuffer input_;
  PlyHeader header_;
  std::uint64_t next_ = 0;  ///< vertex to read next

 private:
  CloudInfo info_;
  InputBuffer::Mark first_vertex_;
};

/// Reads the vertices of a PLY file from its start. Elements before them are skipped; elements
/// after them are not read, and where there are none, the file must end with its last vertex.
/// Coordinates may have any scalar type; in an ASCII file they count as written, whatever their
/// type. The input must be able to seek.
std::unique_ptr<PointReader> read_ply(InputBuffer input);

/// Reads the vertices of a binary PLY file whose header has been read.
std::unique_ptr<PointReader> read_binary_ply(InputBuffer input, PlyHeader header);
std::unique_ptr<PointReader> read_ascii_ply(InputBuffer input, PlyHeader header);

}  // namespace clearway
