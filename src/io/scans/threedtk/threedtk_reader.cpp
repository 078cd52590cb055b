#include "io/scans/threedtk/threedtk_reader.hpp"

#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "core/geometry/predicate.hpp"
#include "core/messages/messages.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/xyz_reader.hpp"
#include "io/scans/threedtk/threedtk_frame.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr int kMostHeaderLines = 10;  // lines that are no points, as 3DTK's own readers allow

/// Which other files of 3DTK the folder of a scan holds.
struct Neighbours {
  bool scans = false, poses = false, frames = false;
};

Neighbours neighbours_of(const fs::path& scan) {
  Neighbours found;
  std::error_code error;
  const fs::path folder = folder_of(scan);
  const fs::directory_iterator end;
  for (fs::directory_iterator at(folder, error); !error && at != end; at.increment(error)) {
    const fs::path name = at->path().filename();
    if (name == scan.filename()) continue;
    found.scans |= name.extension() == ".3d";
    found.poses |= name.extension() == ".pose";
    found.frames |= name.extension() == ".frames";
  }
  if (error) throw ResourceError(folder.string() + ": cannot list the folder: " + error.message());
  return found;
}

/// Finds the pose of a scan and adds remarks about it.
Pose find_pose(const fs::path& scan, std::vector<Message>& remarks) {
  constexpr const char* kFrame =
      ". 3DTK's left-handed centimetres became right-handed metres, x forward, y left, z up";
  const Neighbours neighbours = neighbours_of(scan);
  const auto file = threedtk_pose_file(scan);
  if (!file) {
    if (neighbours.scans || neighbours.poses || neighbours.frames) {
      refuse(scan.string(), "has no pose; expected " + scan.stem().string() + ".frames or " +
                                scan.stem().string() + ".pose beside it");
    }
    remarks.push_back(warning("scan-without-pose",
                              scan.string() + ": has neither a .frames nor a .pose file, so it "
                                              "stays where its scanner was the origin"));
    remarks.push_back(note("scan-placed", scan.string() + ": one scan" + kFrame));
    return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  }
  const bool framed = file->extension() == ".frames";
  remarks.push_back(note("scan-placed", scan.string() + ": placed by " +
                                            (framed ? "the last line of " : "") +
                                            file->filename().string() + kFrame));
  if (!framed && neighbours.frames) {
    remarks.push_back(warning("scan-not-registered",
                              scan.string() + ": has a .pose file only, while other scans of the "
                                              "folder have .frames. It may not be registered"));
  }
  TextTable table(InputBuffer::open_regular(*file));
  return framed ? read_threedtk_frames(table) : read_threedtk_pose(table);
}

/// Skips lines before the first point that are no points, such as counts or what the scanner
/// recorded.
void skip_header(InputBuffer& input) {
  input.begin_text();
  InputBuffer::Mark start = input.mark();
  std::string_view line;
  for (int lines = 0; next_data_line(input, line); ++lines, start = input.mark()) {
    Vec3 point{};
    if (parse_point(line, point)) break;
    if (lines == kMostHeaderLines) {
      refuse_line(input.name(), input.line(),
                  excerpt(line) + "; expected points x y z after ten other lines at most");
    }
  }
  input.return_to(start);
}

/// Places the points of a scan by its pose.
class ThreedtkReader final : public PointReader {
 public:
  ThreedtkReader(InputBuffer input, const fs::path& path) {
    XyzPrologue known{.refuses_cut = true};
    pose_ = find_pose(path, known.info.remarks);
    known.info.unit = LengthUnit::kMetre;
    known.info.origins = {{0, pose_.position()}};
    known.info.origins_rest_on = "poses of 3DTK";
    skip_header(input);
    points_ = read_xyz(std::move(input), std::move(known));
  }

  const CloudInfo& info() const override { return points_->info(); }

  bool read(PointBatch& batch) override {
    const bool more = points_->read(batch);
    for (Vec3& point : batch.positions) point = transform(pose_, from_threedtk(point));
    batch.turn = turn_of(pose_);
    return more;
  }

  void rewind() override { points_->rewind(); }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    return points_->lines_of(points);
  }

 private:
  Pose pose_{};
  std::unique_ptr<PointReader> points_;  ///< in the frame of 3DTK
};

}  // namespace

std::optional<fs::path> threedtk_pose_file(const fs::path& scan) {
  for (const char* ending : {".frames", ".pose"}) {
    fs::path file = scan;
    file.replace_extension(ending);
    std::error_code error;
    if (fs::exists(file, error)) return file;
  }
  return std::nullopt;
}

std::unique_ptr<PointReader> read_threedtk(InputBuffer input, const fs::path& path) {
  return std::make_unique<ThreedtkReader>(std::move(input), path);
}

}  // namespace clearway
