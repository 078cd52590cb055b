#include "io/scans/ply/ply_reader.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "io/scans/formatted_message.hpp"
#include "io/scans/ply/ply_body.hpp"
#include "io/scans/text/point_blocks.hpp"

namespace clearway {
namespace {

class PlyReader final : public PointReader {
 public:
  explicit PlyReader(InputBuffer input) : body_(std::move(input)) {
    const PlyHeader& header = body_.header();
    info_.declared_points = count_;
    info_.model_spacing = header.model_spacing;
    if (header.unit) {
      info_.unit = header.unit->environment;
      info_.any_foot = header.unit->any_foot;
    }
    info_.unplaced = header.unplaced;
    for (const PlyElement& element : header.elements) {
      if (element.name == "face") info_.faces += element.count;
    }
    if (!body_.is_text()) check_size();
    for (const PlyElement& element : before()) body_.skip(element);
    first_vertex_ = body_.input().mark();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.clear();
    const std::uint64_t size = std::min<std::uint64_t>(kBatchPoints, count_ - next_);
    for (std::size_t taken = 0; taken < size; taken = batch.positions.size()) {
      if (!take_block(batch.positions, size)) {
        body_.read_row(body_.vertices(), next_);
        if (body_.ends_open()) check_open_end();
        batch.positions.push_back(body_.vertex());
      }
      next_ += batch.positions.size() - taken;
    }
    if (size == 0 && vertices_end_file()) body_.check_end();
    return size > 0;
  }

  void rewind() override {
    body_.input().return_to(first_vertex_);
    info_.remarks.clear();
    next_ = 0;
    blocks_.clear();
    in_turn_ = 0;
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    if (!body_.is_text()) return PointReader::lines_of(points);
    rewind();
    return lines_of_points(points, body_.input(), [this] {
      if (next_ == count_) return false;
      body_.begin_row(body_.vertices(), next_++);
      return true;
    });
  }

 private:
  std::span<const PlyElement> before() const {
    return std::span(body_.header().elements).first(body_.header().vertex);
  }

  /// Throws InputError where the file is smaller than the elements up to the vertices would be with
  /// empty lists.
  void check_size() {
    const std::uint64_t end = *body_.input().size();
    std::uint64_t room = end - body_.input().position();
    for (std::size_t i = 0; i <= body_.header().vertex; ++i) {
      const PlyElement& element = body_.header().elements[i];
      const std::size_t bytes = element.least_bytes();
      if (bytes > 0 && element.count > room / bytes) {
        refuse(body_.input().name(),
               "ends at byte {}; expected {} of element {} with {} bytes or more each", end,
               element.count, excerpt(element.name), bytes);
      }
      room -= element.count * bytes;
    }
  }

  /// Appends vertices that are read many at once, until there are `size`; returns false where the
  /// next one must be read alone.
  bool take_block(std::vector<Vec3>& out, std::size_t size) {
    if (!body_.is_text()) return body_.take_vertices(next_, size - out.size(), out);
    return blocks_.take(out, size) > 0 || (read_blocks() && blocks_.take(out, size) > 0);
  }

  /// Reads blocks of vertices ahead, except for vertices with lists and for a while after that has
  /// failed.
  bool read_blocks() {
    if (in_turn_ > 0) {
      --in_turn_;
      return false;
    }
    const auto parse = PointLineBlocks::of_lines([this](std::string_view line, Vec3& point) {
      if (without_leading_blanks(line).empty()) return PointLineBlocks::Line::kNothing;
      return body_.parse_vertex(line, point) ? PointLineBlocks::Line::kPoint
                                             : PointLineBlocks::Line::kOther;
    });
    if (blocks_.read(body_.input(), parse, count_ - next_)) return true;
    in_turn_ = kBatchPoints;
    return false;
  }

  /// Whether the file should end with the vertices, because no element after them has a row.
  bool vertices_end_file() const {
    return std::ranges::all_of(
        std::span(body_.header().elements).subspan(body_.header().vertex + 1),
        [](const PlyElement& element) { return element.count == 0; });
  }

  /// Refuses a vertex whose line ends the file without a line break, unless the file should end
  /// there and all its values are present.
  void check_open_end() {
    const InputBuffer& input = body_.input();
    const std::string what = "the file ends without a line break";
    if (!vertices_end_file()) {
      refuse_line(input.name(), input.line(),
                  what + " in the last vertex, so it is cut; expected more lines");
    }
    if (body_.last_char() == '.') {
      refuse_line(input.name(), input.line(), what + " within a number; expected all of it");
    }
  }

  PlyBody body_;
  const std::uint64_t count_ = body_.vertices().count;
  std::uint64_t next_ = 0;  ///< vertex to read next
  CloudInfo info_;
  InputBuffer::Mark first_vertex_;
  PointLineBlocks blocks_;
  std::size_t in_turn_ = 0;  ///< number of lines to read one by one before reading ahead
};

}  // namespace

std::unique_ptr<PointReader> read_ply(InputBuffer input) {
  return std::make_unique<PlyReader>(std::move(input));
}

}  // namespace clearway
