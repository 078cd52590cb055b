#include "io/formats/ply/ply_writer.hpp"

#include <stdexcept>
#include <string>

namespace clearway {
namespace {

std::string header_text(const PlyOutput& header) {
  const std::string type =
      header.coordinates == PlyCoordinates::kFloat32 ? "property float " : "property double ";
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (!header.comment.empty()) text += "comment " + header.comment + "\n";
  text += "element vertex " + std::to_string(header.points) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += type + axis + "\n";
  if (header.first_pose) text += "property uint first_pose\n";
  if (header.distance) text += "property double distance\nproperty uint pose\n";
  if (header.body) text += "property uint body\n";
  return text + "end_header\n";
}

}  // namespace

PlyWriter::PlyWriter(const File& file, const PlyOutput& header) : out_(file), header_(header) {
  const std::string text = header_text(header);
  out_.put_text(text, text.size());
}

void PlyWriter::write(std::span<const Vec3> points, const PlyExtras& extras) {
  const std::size_t distances = header_.distance ? points.size() : 0;
  if (extras.first_pose.size() != (header_.first_pose ? points.size() : 0) ||
      extras.distance.size() != distances || extras.pose.size() != distances ||
      extras.body.size() != (header_.body ? points.size() : 0)) {
    throw std::logic_error("PlyWriter: properties do not match the header");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (header_.coordinates == PlyCoordinates::kFloat32) {
        out_.put(static_cast<float>(points[i][k]));
      } else {
        out_.put(points[i][k]);
      }
    }
    if (header_.first_pose) out_.put(extras.first_pose[i]);
    if (header_.distance) {
      out_.put(extras.distance[i]);
      out_.put(extras.pose[i]);
    }
    if (header_.body) out_.put(extras.body[i]);
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
