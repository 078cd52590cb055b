#include "io/trajectory/trajectory_writer.hpp"

#include "io/formats/text/text_writer.hpp"

namespace clearway {

void write_trajectory(std::span<const Pose> poses, const File& file, Progress& progress) {
  progress.begin("write", poses.size(), "poses");
  TextWriter out(file);
  for (const Pose& pose : poses) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) out << pose.rotation[3 * row + k] << " ";
      out << pose.translation[row] << " ";
    }
    out << "0 0 0 1\n";
    throw_if_stopped(progress);
    progress.advance(1);
  }
  out.flush();
  progress.end();
}

}  // namespace clearway
