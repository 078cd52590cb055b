#include "io/scans/las/las_writer.hpp"

#include <limits>
#include <stdexcept>

#include "io/files/bytes.hpp"
#include "io/scans/las/las_header.hpp"

/// Source: LAS specifications 1.2 and 1.4 R15 (ASPRS).
namespace clearway {
namespace {

constexpr std::uint16_t kHeaderSize12 = 227, kHeaderSize14 = 375;
constexpr std::uint16_t kRecordBytes0 = 20, kRecordBytes6 = 30;
constexpr std::uint32_t kVlrHeaderBytes = 54;
constexpr std::uint16_t kWktFlag = 1 << 4;
constexpr std::size_t kIdBytes = 32, kUserIdBytes = 16;
constexpr const char* kWktUser = "LASF_Projection";
constexpr std::uint16_t kWktRecord = 2112;
constexpr const char* kWktDescription = "OGC coordinate system WKT";

/// The layout of the file, which follows from the header.
struct Layout {
  bool version_14;
  bool wkt_vlr;  ///< whether the CRS is a record before the points
  /// Whether the CRS is a record after the points, because it is too long for one before.
  bool wkt_evlr;
  std::uint64_t wkt_bytes;
  std::uint16_t record_bytes;
  std::uint16_t extra_fields;
  std::uint32_t vlrs;
  std::uint32_t points_offset;
};

bool is_class(const PointField& field) { return field.type == PointField::Type::kClass; }

/// The fields that become extra bytes.
std::vector<PointField> extra_fields(const LasHeader& header) {
  std::vector<PointField> extra = header.fields;
  std::erase_if(extra, is_class);
  return extra;
}

Layout layout_of(const LasHeader& header) {
  Layout out{};
  out.version_14 = header.points > std::numeric_limits<std::uint32_t>::max() ||
                   !header.crs_wkt.empty() || !header.fields.empty();
  // Including its zero byte.
  out.wkt_bytes = header.crs_wkt.empty() ? 0 : header.crs_wkt.size() + 1;
  out.wkt_evlr = out.wkt_bytes > std::numeric_limits<std::uint16_t>::max();
  out.wkt_vlr = out.wkt_bytes > 0 && !out.wkt_evlr;
  const std::vector<PointField> extra = extra_fields(header);
  out.extra_fields = static_cast<std::uint16_t>(extra.size());
  out.record_bytes = out.version_14 ? kRecordBytes6 : kRecordBytes0;
  for (const PointField& field : extra) {
    out.record_bytes = static_cast<std::uint16_t>(out.record_bytes + field.bytes());
  }
  out.vlrs = (out.wkt_vlr ? 1 : 0) + (out.extra_fields > 0 ? 1 : 0);
  out.points_offset = out.version_14 ? kHeaderSize14 : kHeaderSize12;
  out.points_offset += out.vlrs * kVlrHeaderBytes;
  if (out.wkt_vlr) out.points_offset += static_cast<std::uint32_t>(out.wkt_bytes);
  out.points_offset += out.extra_fields * kLasExtraBytes;
  return out;
}

void put_start(ByteWriter& out, const Layout& layout) {
  out.put_text("LASF", 4);
  out.put(std::uint16_t{0});  // file source ID
  out.put(static_cast<std::uint16_t>(layout.version_14 ? kWktFlag : 0));
  out.put_text("", 16);  // project ID
  out.put(std::uint8_t{1});
  out.put(static_cast<std::uint8_t>(layout.version_14 ? 4 : 2));
  out.put_text("OTHER", kIdBytes);
  out.put_text("Clearway", kIdBytes);
  out.put(std::uint16_t{0});  // day and year of creation, so that equal contents give equal bytes
  out.put(std::uint16_t{0});
  out.put(layout.version_14 ? kHeaderSize14 : kHeaderSize12);
  out.put(layout.points_offset);
  out.put(layout.vlrs);
  out.put(static_cast<std::uint8_t>(layout.version_14 ? 6 : 0));
  out.put(layout.record_bytes);
}

/// Writes the 32-bit counts, which are zero for point format 6.
void put_short_counts(ByteWriter& out, const Layout& layout, std::uint64_t points) {
  const auto count = static_cast<std::uint32_t>(layout.version_14 ? 0 : points);
  out.put(count);
  out.put(count);  // number of first returns, then of the others
  for (int i = 1; i < 5; ++i) out.put(std::uint32_t{0});
}

void put_geometry(ByteWriter& out, const LasHeader& header) {
  out.put(header.quantisation.scale);
  out.put(header.quantisation.offset);
  for (int k = 0; k < 3; ++k) {
    const bool empty = header.points == 0;
    out.put(empty ? 0.0 : coordinate(header.quantisation, k, header.bounds.hi[k]));
    out.put(empty ? 0.0 : coordinate(header.quantisation, k, header.bounds.lo[k]));
  }
}

void put_long_counts(ByteWriter& out, const Layout& layout, std::uint64_t points) {
  out.put(std::uint64_t{0});  // start of waveform data
  out.put(layout.wkt_evlr ? layout.points_offset + points * layout.record_bytes : 0);
  out.put(static_cast<std::uint32_t>(layout.wkt_evlr ? 1 : 0));
  out.put(points);
  out.put(points);  // number of first returns, then of the others
  for (int i = 1; i < 15; ++i) out.put(std::uint64_t{0});
}

void put_record_header(ByteWriter& out, const char* user, std::uint16_t record, auto bytes,
                       const char* description) {
  out.put(std::uint16_t{0});
  out.put_text(user, kUserIdBytes);
  out.put(record);
  out.put(bytes);
  out.put_text(description, kIdBytes);
}

LasExtraType extra_type_of(PointField::Type type) {
  switch (type) {
    case PointField::Type::kUint32:
      return LasExtraType::kUint32;
    case PointField::Type::kDouble:
      return LasExtraType::kDouble;
    case PointField::Type::kUint64:
      return LasExtraType::kUint64;
    case PointField::Type::kClass:
      break;
  }
  return LasExtraType::kUndocumented;
}

void put_extra_bytes_vlr(ByteWriter& out, const LasHeader& header, const Layout& layout) {
  put_record_header(out, "LASF_Spec", 4,
                    static_cast<std::uint16_t>(layout.extra_fields * kLasExtraBytes),
                    "extra bytes");
  for (const PointField& field : extra_fields(header)) {
    out.put(las_extra_bytes(field.name, extra_type_of(field.type), field.description));
  }
}

}  // namespace

struct LasWriter::State {
  State(const File& file, const LasHeader& las_header)
      : out(file), header(las_header), layout(layout_of(las_header)) {}

  /// point_class: written by version 1.4 alone, which files with classes have.
  void put_point(const std::array<std::int32_t, 3>& q, std::uint8_t point_class) {
    out.put(q);
    if (layout.version_14) {
      struct {
        std::uint16_t intensity = 0;
        std::uint8_t returns = 0x11;  // first return of one
        std::uint8_t flags = 0;
        std::uint8_t point_class = 0;
        std::uint8_t rest[13] = {};
      } const tail{.point_class = point_class};
      static_assert(sizeof tail == kRecordBytes6 - 12);
      out.put(tail);
    } else {
      struct {
        std::uint16_t intensity = 0;
        std::uint8_t returns = 0x09;
        std::uint8_t rest[5] = {};
      } const tail;
      static_assert(sizeof tail == kRecordBytes0 - 12);
      out.put(tail);
    }
  }

  ByteWriter out;
  LasHeader header;
  Layout layout;
  std::uint64_t written = 0;
};

LasWriter::LasWriter(const File& file, const LasHeader& header)
    : state_(std::make_unique<State>(file, header)) {
  ByteWriter& out = state_->out;
  const Layout& layout = state_->layout;
  put_start(out, layout);
  put_short_counts(out, layout, header.points);
  put_geometry(out, header);
  if (layout.version_14) put_long_counts(out, layout, header.points);
  if (layout.wkt_vlr) {
    put_record_header(out, kWktUser, kWktRecord, static_cast<std::uint16_t>(layout.wkt_bytes),
                      kWktDescription);
    out.put_text(header.crs_wkt, layout.wkt_bytes);
  }
  if (layout.extra_fields > 0) put_extra_bytes_vlr(out, header, layout);
}

LasWriter::~LasWriter() = default;

void LasWriter::write(std::span<const std::array<std::int32_t, 3>> quanta,
                      std::span<const FieldValues> values) {
  check_fields(state_->header.fields, values, quanta.size());
  std::span<const std::uint8_t> classes;
  std::vector<FieldValues> extra;
  for (const FieldValues& field : values) {
    if (const auto* of_points = std::get_if<std::span<const std::uint8_t>>(&field)) {
      classes = *of_points;
    } else {
      extra.push_back(field);
    }
  }
  for (std::size_t i = 0; i < quanta.size(); ++i) {
    state_->put_point(quanta[i], classes.empty() ? std::uint8_t{0} : classes[i]);
    for (const FieldValues& field : extra) {
      std::visit([&](const auto& of_points) { state_->out.put(of_points[i]); }, field);
    }
  }
  state_->written += quanta.size();
}

void LasWriter::finish() {
  const LasHeader& header = state_->header;
  if (state_->written != header.points) {
    throw std::logic_error("LasWriter: " + std::to_string(state_->written) + " points written, " +
                           std::to_string(header.points) + " declared");
  }
  if (state_->layout.wkt_evlr) {
    put_record_header(state_->out, kWktUser, kWktRecord, state_->layout.wkt_bytes, kWktDescription);
    state_->out.put_text(header.crs_wkt, state_->layout.wkt_bytes);
  }
  state_->out.flush();
}

}  // namespace clearway
