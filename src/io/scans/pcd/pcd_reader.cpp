#include "io/scans/pcd/pcd_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/pcd/lzf_stream.hpp"
#include "io/scans/pcd/pcd_header.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/xyz_reader.hpp"
#include "io/scans/text_copy.hpp"

namespace clearway {
namespace {

/// The remark on a viewpoint; nullopt for the default, which is 0 0 0 and no rotation.
std::optional<Message> remark_on_viewpoint(const std::array<double, 7>& viewpoint,
                                           const std::string& name) {
  const double norm =
      std::hypot(std::hypot(viewpoint[3], viewpoint[4]), std::hypot(viewpoint[5], viewpoint[6]));
  const double cosine = norm > 0 ? std::min(1.0, std::abs(viewpoint[3]) / norm) : 1;
  const double degrees = 2 * std::acos(cosine) * 180 / std::numbers::pi;
  if (std::all_of(viewpoint.begin(), viewpoint.begin() + 3, [](double c) { return c == 0; }) &&
      degrees == 0) {
    return std::nullopt;
  }
  return warning(
      "pcd-viewpoint",
      fmt::format("{}: its VIEWPOINT lies at ({}, {}, {}), turned by {} degrees. It is not "
                  "applied: PCL defines it as the place of the sensor. If the points are in the "
                  "sensor's frame, apply it first, for example with pcl_transform_from_viewpoint",
                  name, format_digits(viewpoint[0], 9), format_digits(viewpoint[1], 9),
                  format_digits(viewpoint[2], 9), format_digits(degrees, 9)),
      {{"x", viewpoint[0]}, {"y", viewpoint[1]}, {"z", viewpoint[2]}, {"degrees", degrees}});
}

/// Base of the readers of the three kinds of PCD file.
class PcdBodyReader : public PointReader {
 public:
  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.clear();
    batch.positions.resize(std::min<std::uint64_t>(kBatchPoints, header_.points - next_));
    if (batch.positions.empty()) {
      if (!finished_) check_end();
      finished_ = true;
      return false;
    }
    read_points(batch.positions);
    next_ += batch.positions.size();
    if (header_.height > 1) mark_absent(batch);
    return true;
  }

  void rewind() override {
    input_.return_to(first_point_);
    next_ = 0;
  }

 protected:
  /// input: stands after the line DATA.
  PcdBodyReader(InputBuffer input, PcdHeader header)
      : input_(std::move(input)), header_(std::move(header)), first_point_(input_.mark()) {
    info_.declared_points = header_.points;
    if (!header_.viewpoint) return;
    if (auto remark = remark_on_viewpoint(*header_.viewpoint, input_.name())) {
      info_.remarks.push_back(std::move(*remark));
      const auto& [x, y, z, w, i, j, k] = *header_.viewpoint;
      info_.origins = {{0, Vec3{x, y, z}}};
      info_.origins_rest_on = "viewpoints of PCD";
    }
  }

  /// Reads the next points, in order; header_.points in all.
  virtual void read_points(std::span<Vec3> out) = 0;
  /// Called with the input after the last point. Throws InputError where the file does not end
  /// there. Of binary data it refuses anything but what PCL leaves there: up to a page of zeros, or
  /// a line break.
  virtual void check_end() {
    constexpr std::uint64_t kMostPadding = std::uint64_t{1} << 16;  // a page on any machine
    const std::uint64_t position = input_.position();
    const std::uint64_t left = *input_.size() - position;
    const auto bytes = left <= kMostPadding ? input_.take(left) : std::span<const std::byte>();
    const auto pads = [](std::byte b) {
      return b == std::byte{0} || b == std::byte{'\n'} || b == std::byte{'\r'};
    };
    if (left <= kMostPadding && std::all_of(bytes.begin(), bytes.end(), pads)) return;
    refuse_byte(input_.name(), position,
                format_count(left) + " bytes behind the last of " + format_count(header_.points) +
                    " points; expected the end of the file");
  }

  InputBuffer input_;
  PcdHeader header_;
  CloudInfo info_;
  InputBuffer::Mark first_point_;
  std::uint64_t next_ = 0;  ///< index of the point to read next

 private:
  static void mark_absent(PointBatch& batch) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    for (std::uint32_t i = 0; i < batch.positions.size(); ++i) {
      Vec3& p = batch.positions[i];
      if (!std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z)) continue;
      p = {kNaN, kNaN, kNaN};
      batch.absent.push_back(i);
    }
  }

  bool finished_ = false;
};

/// Reads ASCII data with one point per line. Numbers are read as written, even where TYPE promises
/// fewer digits.
class AsciiPcdReader final : public PcdBodyReader {
 public:
  AsciiPcdReader(InputBuffer input, PcdHeader header)
      : PcdBodyReader(std::move(input), std::move(header)) {
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (header_.coordinates[axis] == i) words_[axis] = words_of_point_;
      }
      words_of_point_ += header_.fields[i].count;
    }
    check_room();
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    std::string_view line;
    return lines_of_points(points, input_, [&] { return next_line(line); });
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  /// Throws InputError where the file is too small. Each number takes at least two bytes including
  /// its separator, which the last one of the file may lack.
  void check_room() const {
    const std::uint64_t room = *input_.size() - input_.position() + 1;
    if (header_.points <= room / (2 * words_of_point_)) return;
    refuse(input_.name(), "ends at byte {}; expected {} points of {} numbers", *input_.size(),
           header_.points, words_of_point_);
  }

  void read_points(std::span<Vec3> out) override {
    if (next_ == 0) open_end_ = OpenEnd();
    std::string_view line;
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!next_line(line)) {
        refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                  std::to_string(next_ + i) + " points; expected " +
                                  std::to_string(header_.points) + " as the header declares");
      }
      parse(line, out[i]);
      open_end_.see(input_, line);
    }
  }

  void check_end() override {
    std::string_view line;
    if (next_line(line)) {
      fail("more than the " + std::to_string(header_.points) + " points that the header declares");
    }
    open_end_.append_to(info_.remarks, input_.name());
  }

  /// Reads the next line that is not blank; returns false at the end.
  bool next_line(std::string_view& line) {
    do {
      if (!input_.next_line(line)) return false;
    } while (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size());
    return true;
  }

  void parse(std::string_view line, Vec3& point) const {
    const char* const end = line.data() + line.size();
    const char* at = skip_blanks(line.data(), end);
    std::uint64_t words = 0;
    for (char separator = ' '; at != end && separator != 0; ++words) {
      double value = 0;
      if (words == words_of_point_ || !parse_number(at, end, value)) break;
      for (int axis = 0; axis < 3; ++axis) {
        if (words_[static_cast<std::size_t>(axis)] == words) point[axis] = value;
      }
      separator = skip_separator(at, end);
      if (at == end && separator != ' ' && separator != 0) break;
    }
    if (at != end || words != words_of_point_) {
      fail(excerpt(line) + "; expected " + std::to_string(words_of_point_) +
           " numbers, as FIELDS and COUNT declare");
    }
  }

  std::uint64_t words_of_point_ = 0;
  std::array<std::uint64_t, 3> words_{};  // indices of the words x, y and z in a line
  OpenEnd open_end_;
};

/// Reads binary data, in which the fields of a point are adjacent.
class BinaryPcdReader final : public PcdBodyReader {
 public:
  BinaryPcdReader(InputBuffer input, PcdHeader header)
      : PcdBodyReader(std::move(input), std::move(header)), stride_(header_.point_bytes(true)) {
    refuse_if_copied_as_text(input_);
    refuse_seven_bits(input_);
    const std::uint64_t room = *input_.size() - input_.position();
    if (header_.points > room / stride_) {
      refuse(input_.name(), "ends at byte {}, within point {} of {}; expected {} bytes for each",
             *input_.size(), room / stride_, header_.points, stride_);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t field = header_.coordinates[axis];
      for (std::size_t i = 0; i < field; ++i) offsets_[axis] += header_.fields[i].bytes();
      loads_[axis] = load_of(header_.fields[field]);
    }
  }

 private:
  void read_points(std::span<Vec3> out) override {
    const std::size_t most = InputBuffer::kCapacity / stride_;
    while (!out.empty()) {
      const std::size_t count = std::min(most, out.size());
      const auto bytes = input_.take(count * stride_);
      if (bytes.empty()) refuse(input_.name(), "changed while it was read");
      for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const std::byte* at = bytes.data() + offsets_[k];
        for (std::size_t i = 0; i < count; ++i, at += stride_) out[i][axis] = loads_[k](at);
      }
      out = out.subspan(count);
    }
  }

  std::size_t stride_;
  std::array<std::size_t, 3> offsets_{};
  std::array<PcdLoad, 3> loads_{};
};

// Bytes of a column that are decoded at a time.
constexpr std::size_t kColumnBytes = std::size_t{1} << 16;

/// Reads compressed data, in which each field is stored for all points before the next field. Three
/// decoders stand in the columns of x, y and z at the same time, so that memory is constant.
class CompressedPcdReader final : public PcdBodyReader {
 public:
  CompressedPcdReader(InputBuffer input, PcdHeader header)
      : PcdBodyReader(std::move(input), std::move(header)) {
    refuse_if_copied_as_text(input_);
    refuse_seven_bits(input_);
    const auto sizes = input_.take(2 * sizeof(std::uint32_t));
    if (sizes.empty()) {
      refuse(input_.name(), "ends at byte " + std::to_string(input_.end_position()) +
                                "; expected the sizes of the compressed data, 8 bytes");
    }
    const auto compressed = load<std::uint32_t>(sizes.data());
    decoded_bytes_ = load<std::uint32_t>(sizes.data() + sizeof(std::uint32_t));
    begin_ = input_.position();
    end_ = begin_ + compressed;
    if (end_ > *input_.size()) {
      refuse(input_.name(), "ends at byte " + std::to_string(*input_.size()) +
                                "; expected compressed data up to byte " + std::to_string(end_));
    }
    const std::uint64_t bytes = header_.point_bytes(false);
    if (decoded_bytes_ % bytes != 0 || decoded_bytes_ / bytes != header_.points) {
      refuse(input_.name(), "compressed data of {} bytes for {} points; expected {} bytes for each",
             decoded_bytes_, header_.points, bytes);
    }
    first_point_ = input_.mark();
  }

 private:
  void read_points(std::span<Vec3> out) override {
    if (!starts_[0]) find_columns();
    if (next_ == 0) columns_ = starts_;
    for (std::size_t axis = 0; axis < 3; ++axis) read_column(axis, out);
  }

  void check_end() override {
    if (!starts_[0]) find_columns();
    input_.skip(end_ - begin_);
    PcdBodyReader::check_end();
  }

  /// Decodes everything once, to find where x, y and z start and to check that the data is sound.
  void find_columns() {
    std::array<std::uint64_t, 3> begins{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < header_.coordinates[axis]; ++i) {
        const PcdField& field = header_.fields[i];
        if (!field.padding()) begins[axis] += field.bytes() * header_.points;
      }
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return begins[a] < begins[b]; });
    LzfStream stream(input_.file(), begin_, end_, decoded_bytes_);
    for (const std::size_t axis : order) {
      stream.skip(begins[axis] - stream.position());
      starts_[axis] = stream;
    }
    stream.skip(decoded_bytes_ - stream.position());
    stream.check_end();
  }

  void read_column(std::size_t axis, std::span<Vec3> out) {
    const PcdField& field = header_.fields[header_.coordinates[axis]];
    const PcdLoad load = load_of(field);
    const std::size_t most = kColumnBytes / field.bytes();
    while (!out.empty()) {
      const std::size_t count = std::min(most, out.size());
      bytes_.resize(count * field.bytes());
      columns_[axis]->read(bytes_);
      for (std::size_t i = 0; i < count; ++i) {
        out[i][static_cast<int>(axis)] = load(bytes_.data() + i * field.bytes());
      }
      out = out.subspan(count);
    }
  }

  std::uint64_t begin_ = 0;  // position of the compressed bytes in the file
  std::uint64_t end_ = 0;
  std::uint64_t decoded_bytes_ = 0;
  std::array<std::optional<LzfStream>, 3> starts_;   // decoders at the first point
  std::array<std::optional<LzfStream>, 3> columns_;  // decoders at the next point
  std::vector<std::byte> bytes_;
};

}  // namespace

std::unique_ptr<PointReader> read_pcd(InputBuffer input) {
  PcdHeader header = read_pcd_header(input);
  switch (header.data) {
    case PcdData::kAscii:
      return std::make_unique<AsciiPcdReader>(std::move(input), std::move(header));
    case PcdData::kBinary:
      return std::make_unique<BinaryPcdReader>(std::move(input), std::move(header));
    case PcdData::kCompressed:
      break;
  }
  return std::make_unique<CompressedPcdReader>(std::move(input), std::move(header));
}

}  // namespace clearway
