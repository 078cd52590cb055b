#include "io/scans/ply/ply_writer.hpp"

#include <stdexcept>
#include <string>

namespace clearway {
namespace {

std::string header_text(const PlyOutput& header) {
  const std::string type =
      header.coordinates == PlyCoordinates::kFloat32 ? "property float " : "property double ";
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : header.comments) text += "comment " + comment + "\n";
  text += "element vertex " + std::to_string(header.points) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += type + axis + "\n";
  for (const PointField& field : header.fields) {
    text += field.type == PointField::Type::kUint32  ? "property uint "
            : field.type == PointField::Type::kClass ? "property uchar "
                                                     : "property double ";
    text += field.name + "\n";
  }
  return text + "end_header\n";
}

template <typename Number>
void put_property(ByteWriter& out, Number value) {
  out.put(value);
}
/// PLY has no integers of 64 bits. Below 2^53 a double is the same number.
void put_property(ByteWriter& out, std::uint64_t value) { out.put(static_cast<double>(value)); }

}  // namespace

PlyWriter::PlyWriter(const File& file, const PlyOutput& header) : out_(file), header_(header) {
  const std::string text = header_text(header);
  out_.put_text(text, text.size());
}

void PlyWriter::write(std::span<const Vec3> points, std::span<const FieldValues> values) {
  check_fields(header_.fields, values, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (header_.coordinates == PlyCoordinates::kFloat32) {
        out_.put(static_cast<float>(points[i][k]));
      } else {
        out_.put(points[i][k]);
      }
    }
    for (const FieldValues& field : values) {
      std::visit([&](const auto& of_points) { put_property(out_, of_points[i]); }, field);
    }
  }
  written_ += points.size();
}

void PlyWriter::finish() {
  if (written_ != header_.points) {
    throw std::logic_error("PlyWriter: " + std::to_string(written_) + " points written, " +
                           std::to_string(header_.points) + " declared");
  }
  out_.flush();
}

}  // namespace clearway
