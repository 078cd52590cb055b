#include "io/scans/las/las_reader.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/las/las_records.hpp"
#include "io/scans/laz/laz_reader.hpp"
#include "io/scans/text_copy.hpp"

namespace clearway {
namespace {

/// Whether the stream begins as a LAZ file does.
bool is_compressed(InputBuffer& stream) {
  constexpr std::size_t kFormatByte = 104;
  const auto head = stream.peek(kFormatByte + 1);
  return head.size() > kFormatByte && std::memcmp(head.data(), "LASF", 4) == 0 &&
         load<std::uint8_t>(head.data() + kFormatByte) >= 0x40;
}

/// Copies all bytes of the stream into a file without a name.
InputBuffer spool_bytes(InputBuffer stream, const std::filesystem::path& folder) {
  const File spooled = File::create_temporary(folder);
  for (auto bytes = stream.take_some(); !bytes.empty(); bytes = stream.take_some()) {
    spooled.write(bytes);
  }
  const int descriptor = ::dup(spooled.descriptor());
  if (descriptor < 0) throw ResourceError(stream.name() + ": cannot be spooled: no descriptor");
  return {File::adopt(descriptor, stream.name()), InputBuffer::Access::kSeek};
}

}  // namespace

std::unique_ptr<PointReader> open_las_stream(File stream,
                                             const std::filesystem::path& temporary_folder,
                                             const PointReadOptions& options) {
  InputBuffer input(std::move(stream), InputBuffer::Access::kStream);
  const auto head = input.peek(4);
  if (head.size() == 4 && std::memcmp(head.data(), "LASF", 4) != 0) {
    refuse_byte(
        input.name(), 0,
        "expected the signature LASF of LAS or LAZ, which alone are read from a pipe; write "
        "it into a file first");
  }
  if (is_compressed(input)) {
    return read_las(spool_bytes(std::move(input), temporary_folder), options.with_times);
  }
  return read_las(std::move(input), options.with_times);
}

namespace {

constexpr const char* kWhyMore =
    "Its writer crashed, or wrote into a pipe and could not go back to the header";

/// What the GPS times of a file with this header count.
GpsTimes gps_times_of(const LasPublicHeader& header) {
  constexpr std::uint16_t kIsAdjusted = 1;  // a bit of the global encoding
  if (!las_time_byte(header.point_format)) return GpsTimes::kNone;
  return (header.encoding & kIsAdjusted) != 0 ? GpsTimes::kAdjusted : GpsTimes::kWeekSeconds;
}

/// Reads uncompressed points.
class LasReader final : public PointReader {
 public:
  LasReader(InputBuffer input, const LasPublicHeader& header, LasCrs crs, bool with_times)
      : input_(std::move(input)), header_(header), crs_(std::move(crs)), points_(header.points) {
    if (with_times) time_byte_ = las_time_byte(header.point_format);
    info_.gps_times = gps_times_of(header);
    info_.date = header.date;
    first_point_ = input_.mark();
    if (input_.can_seek()) {
      read_las_tail(input_, header_, crs_);
      input_.return_to(first_point_);
      tail_read_ = true;
      refuse_surplus();
    } else if (header_.tail_count > 0) {
      points_ += surplus(header_.tail_offset);
      check_surplus(header_.tail_offset);
    }
    info_.quantisation = header_.quantisation;
    info_.declared_points = header_.points;
    info_.declared_box = header_.box;
    info_.set(crs_.stated());
  }

  const CloudInfo& info() const override { return info_; }
  bool can_rewind() const override { return input_.can_seek(); }

  bool read(PointBatch& batch) override {
    batch.clear();
    const std::size_t most = InputBuffer::kCapacity / header_.record_bytes;
    while (batch.quanta.size() < kBatchPoints) {
      const auto wanted =
          std::min<std::uint64_t>({most, kBatchPoints - batch.quanta.size(), points_ - next_});
      const auto bytes = wanted > 0 ? take_records(wanted) : take_more_records();
      if (bytes.empty()) break;
      if (!input_.can_seek()) feeds_.add(bytes);
      append(bytes, batch);
      next_ += wanted > 0 ? wanted : 1;
    }
    if (batch.quanta.empty()) finish();
    return !batch.quanta.empty();
  }

  std::size_t pieces() const override {
    return input_.can_seek() ? divide_up(header_.points, piece_points()) : 0;
  }

  std::uint64_t points_of_piece(std::size_t piece) const override {
    return std::min(piece_points(), header_.points - piece * piece_points());
  }

  void read_piece(std::size_t piece, PointBatch& batch, PieceBytes* bytes) override {
    PieceBytes read;
    read.first = header_.points_offset + piece * piece_points() * header_.record_bytes;
    read.count = points_of_piece(piece) * header_.record_bytes;
    read.bytes = std::make_unique_for_overwrite<std::byte[]>(read.count);
    input_.read_at(read.first, read.span());
    batch.clear();
    append(read.span(), batch);
    if (bytes) *bytes = std::move(read);
  }

  void rewind() override {
    input_.return_to(first_point_);
    next_ = 0;
  }

 private:
  static constexpr std::uint64_t kPieceBytes = std::uint64_t{2} << 20;

  std::uint64_t piece_points() const {
    return std::min<std::uint64_t>(kBatchPoints, kPieceBytes / header_.record_bytes);
  }

  /// Number of whole records between the last declared one and `end`.
  std::uint64_t surplus(std::uint64_t end) const {
    return (end - std::min(end, header_.points_end())) / header_.record_bytes;
  }

  /// Throws InputError where bytes between the last declared point and `end`, where the points end,
  /// are no whole records. Before extended records, a gap of less than a record is accepted.
  void check_surplus(std::uint64_t end) const {
    const std::uint64_t bytes = end - std::min(end, header_.points_end());
    if (bytes % header_.record_bytes == 0) return;
    if (header_.tail_count > 0 && bytes < header_.record_bytes) return;
    refuse(input_.name(),
           "has {} more behind its {} points, which end at byte {}; expected whole records of {} "
           "bytes or none. The file is damaged: copy or export it again",
           counted(bytes, "byte"), header_.points, header_.points_end(), header_.record_bytes);
  }

  void refuse_surplus() const {
    const std::uint64_t end = header_.tail_count > 0 ? header_.tail_offset : *input_.size();
    check_surplus(end);
    const std::uint64_t more = surplus(end);
    if (more == 0) return;
    refuse(input_.name(), Remedy::kStandardInput,
           "declares {} points, but holds {} records of {} bytes before byte {}; expected as many "
           "as declared. {}. As standard input all of them are read",
           header_.points, header_.points + more, header_.record_bytes, end, kWhyMore);
  }

  std::span<const std::byte> take_records(std::size_t records) {
    const auto bytes = input_.take(records * header_.record_bytes);
    if (!bytes.empty()) return bytes;
    const std::uint64_t end = input_.end_position();
    refuse(input_.name(), "ends at byte {}, within point {} of {}; expected {} bytes", end,
           (end - header_.points_offset) / header_.record_bytes, points_, header_.points_end());
  }

  /// Takes records of a stream after the last one that its header declares.
  std::span<const std::byte> take_more_records() {
    if (input_.can_seek() || header_.tail_count > 0) return {};
    const std::size_t record = header_.record_bytes;
    const auto bytes = input_.take(record);
    if (bytes.empty()) check_surplus(input_.end_position());
    if (!bytes.empty()) ++points_;
    return bytes;
  }

  void append(std::span<const std::byte> bytes, PointBatch& out) const {
    const std::size_t stride = header_.record_bytes;
    const std::size_t records = bytes.size() / stride;
    out.quanta.resize(out.quanta.size() + records);
    out.classes.resize(out.quanta.size());
    auto* point = &out.quanta[out.quanta.size() - records];
    auto* of_point = &out.classes[out.classes.size() - records];
    const LasClassField field = las_class_field(header_.point_format);
    const std::byte* record = bytes.data();
    const std::byte* const end = record + bytes.size();
    for (; record != end; record += stride) {
      std::memcpy(point++, record, sizeof *point);
      *of_point++ = field.of(record);
    }
    if (header_.has_flags) {
      for (record = bytes.data(); record != end; record += stride) {
        out.flags.push_back(las_flags_of(record, header_.point_format));
      }
    }
    if (!time_byte_) return;
    for (record = bytes.data(); record != end; record += stride) {
      out.times.push_back(load<double>(record + *time_byte_));
    }
  }

  void finish() {
    if (tail_read_) return;
    read_las_tail(input_, header_, crs_);
    info_.set(crs_.stated());
    tail_read_ = true;
    if (points_ == header_.points) return;
    if (feeds_.are_all_pairs()) refuse_text_copy(input_.name());
    info_.remarks.push_back(warning(
        "las-count", {{"declared", header_.points}, {"read", points_}},
        "{}: its header declares {} points, but {} came before its end. {}. All of them were read",
        input_.name(), header_.points, points_, kWhyMore));
  }

  InputBuffer input_;
  LasPublicHeader header_;
  LasCrs crs_;
  CloudInfo info_;
  InputBuffer::Mark first_point_;
  /// Number of points; in a stream it may grow beyond what the header declares.
  std::uint64_t points_;
  std::uint64_t next_ = 0;  ///< point to read next
  LineFeeds feeds_;         ///< in the points of a stream
  bool tail_read_ = false;
  /// Where the GPS time is in a record; nullopt unless times are wanted and exist.
  std::optional<std::size_t> time_byte_;
};

std::unique_ptr<PointReader> read_compressed(InputBuffer input, const LasPublicHeader& header,
                                             LasRecords& records, bool with_times) {
  const std::string name = input.name();
  if (records.laz.empty()) {
    refuse_byte(name, 104,
                "the points are compressed (LAZ); expected a record of user `laszip "
                "encoded` that says how");
  }
  laz::Scheme scheme =
      laz::read_scheme(name, records.laz, header.point_format, header.record_bytes);
  scheme.with_times = with_times && scheme.has_times();
  scheme.with_flags = header.has_flags;
  read_las_tail(input, header, records.crs);
  CloudInfo info;
  info.quantisation = header.quantisation;
  info.declared_points = header.points;
  info.declared_box = header.box;
  info.gps_times = scheme.has_times() ? gps_times_of(header) : GpsTimes::kNone;
  info.set(records.crs.stated());
  info.date = header.date;
  const std::uint64_t end = header.tail_count > 0 ? header.tail_offset : *input.size();
  return read_laz_points(std::move(input), scheme, {header.points_offset, end, header.points},
                         records.copc, std::move(info));
}

}  // namespace

std::unique_ptr<PointReader> read_las(InputBuffer input, bool with_times) {
  refuse_seven_bits(input);
  const LasPublicHeader header = read_las_header(input);
  LasRecords records;
  read_las_vlrs(input, header, records);
  if (header.compressed) return read_compressed(std::move(input), header, records, with_times);
  if (!records.laz.empty()) {
    refuse_byte(input.name(), 104,
                "the points are not compressed, but a record of user `laszip encoded` says how; "
                "expected bit 7 to be set in a LAZ file, or no such record");
  }
  return std::make_unique<LasReader>(std::move(input), header, std::move(records.crs), with_times);
}

}  // namespace clearway
