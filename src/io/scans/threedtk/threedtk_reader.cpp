#include "io/scans/threedtk/threedtk_reader.hpp"

#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
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
  InputBuffer input = InputBuffer::open_regular(*file);
  return framed ? read_threedtk_frames(input) : read_threedtk_pose(input);
}

class ThreedtkReader final : public PointReader {
 public:
  ThreedtkReader(InputBuffer input, const fs::path& path) : input_(std::move(input)) {
    pose_ = find_pose(path, info_.remarks);
    info_.unit = LengthUnit::kMetre;
    const double* t = pose_.translation;
    info_.origins = {{0, Vec3{t[0], t[1], t[2]}}};
    info_.origins_rest_on = "poses of 3DTK";
    skip_header();
    first_point_ = input_.mark();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.absent.clear();
    batch.positions.resize(kBatchPoints);
    std::size_t count = 0;
    std::string_view line;
    while (count < kBatchPoints && next_data_line(input_, line)) {
      Vec3 point{};
      if (!parse_point(line, point)) {
        refuse_line(input_.name(), input_.line(),
                    excerpt(line) + "; expected three numbers, the coordinates x y z");
      }
      open_end_.see(input_, line);
      batch.positions[count++] = place(from_threedtk(point));
    }
    batch.positions.resize(count);
    batch.turn = turn_of(pose_);
    if (count == 0) finish();
    return count > 0;
  }

  void rewind() override {
    input_.return_to(first_point_);
    open_end_ = OpenEnd();
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    std::string_view line;
    return lines_of_points(points, input_, [&] { return next_data_line(input_, line); });
  }

 private:
  Vec3 place(const Vec3& p) const {
    const double* r = pose_.rotation;
    const double* t = pose_.translation;
    return {r[0] * p.x + r[1] * p.y + r[2] * p.z + t[0],
            r[3] * p.x + r[4] * p.y + r[5] * p.z + t[1],
            r[6] * p.x + r[7] * p.y + r[8] * p.z + t[2]};
  }

  /// Skips lines before the first point that are no points, such as counts or what the scanner
  /// recorded.
  void skip_header() {
    input_.begin_text();
    InputBuffer::Mark start = input_.mark();
    std::string_view line;
    for (int lines = 0; next_data_line(input_, line); ++lines, start = input_.mark()) {
      Vec3 point{};
      if (parse_point(line, point)) break;
      if (lines == kMostHeaderLines) {
        refuse_line(input_.name(), input_.line(),
                    excerpt(line) + "; expected points x y z after ten other lines at most");
      }
    }
    input_.return_to(start);
  }

  void finish() {
    if (finished_) return;
    finished_ = true;
    open_end_.append_to(info_.remarks, input_.name());
  }

  InputBuffer input_;
  CloudInfo info_;
  Pose pose_{};
  InputBuffer::Mark first_point_;
  OpenEnd open_end_;
  bool finished_ = false;
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
