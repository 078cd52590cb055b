#include "io/formats/las/las_record_writer.hpp"

#include <limits>
#include <stdexcept>
#include <string_view>

#include "io/formats/byte_load.hpp"

/// Source: LAS specification 1.4 R15 (ASPRS).
namespace clearway {
namespace {

constexpr std::uint16_t kHeaderBytes = 375;
constexpr std::uint32_t kVlrBytes = 54;
constexpr std::size_t kId = 32, kUser = 16;
constexpr std::uint16_t kGpsTimeBit = 1 << 0, kSyntheticReturnsBit = 1 << 3, kWktBit = 1 << 4;
constexpr std::uint64_t kMostInVlr = std::numeric_limits<std::uint16_t>::max();

template <typename Bytes>
void put_table_header(ByteWriter& out, std::string_view user, std::uint16_t id, Bytes bytes,
                      std::string_view description) {
  out.put(std::uint16_t{0});
  out.put_text(user, kUser);
  out.put(id);
  out.put(bytes);
  out.put_text(description, kId);
}

void put_table(ByteWriter& out, std::string_view user, std::uint16_t id,
               std::span<const std::byte> payload, std::string_view description) {
  put_table_header(out, user, id, static_cast<std::uint16_t>(payload.size()), description);
  out.put_bytes(payload);
}

/// The bytes of a text, including the zero byte that ends it.
std::span<const std::byte> text_bytes(const std::string& text) {
  return std::as_bytes(std::span(text.c_str(), text.size() + 1));
}

constexpr const char* kCrsUser = "LASF_Projection";
constexpr std::uint16_t kWktId = 2112;
constexpr const char* kWktText = "OGC coordinate system WKT";

}  // namespace

LasRecordWriter::LasRecordWriter(const File& file, LasRecordFormat format)
    : file_(file),
      format_(std::move(format)),
      wkt_behind_(format_.crs_wkt.size() + 1 > kMostInVlr),
      out_(file) {
  if (!format_.crs_wkt.empty()) format_.geotiff.clear();
  out_.put_text("", kHeaderBytes);
  put_tables(out_);
}

std::uint32_t LasRecordWriter::tables_bytes() const {
  std::size_t bytes = 0;
  if (!format_.crs_wkt.empty() && !wkt_behind_) bytes += kVlrBytes + format_.crs_wkt.size() + 1;
  for (const LasRecord& record : format_.geotiff) bytes += kVlrBytes + record.payload.size();
  if (!format_.extra_bytes.empty()) bytes += kVlrBytes + format_.extra_bytes.size();
  return static_cast<std::uint32_t>(bytes);
}

void LasRecordWriter::put_tables(ByteWriter& out) const {
  if (!format_.crs_wkt.empty() && !wkt_behind_) {
    put_table(out, kCrsUser, kWktId, text_bytes(format_.crs_wkt), kWktText);
  }
  for (const LasRecord& record : format_.geotiff) {
    put_table(out, record.user, record.id, record.payload, "GeoTIFF");
  }
  if (!format_.extra_bytes.empty()) {
    put_table(out, "LASF_Spec", 4, format_.extra_bytes, "extra bytes");
  }
}

void LasRecordWriter::write(std::span<const std::byte> record) {
  if (record.size() != format_.record_bytes) {
    throw std::logic_error("LasRecordWriter: a record of another size");
  }
  QuantumBox at{};
  for (unsigned k = 0; k < 3; ++k) {
    at.lo[k] = at.hi[k] = load<std::int32_t>(record.data() + 4 * k);
  }
  bounds_ = points_ == 0 ? at : bounds_.united(at);
  const unsigned number =
      load<std::uint8_t>(record.data() + 14) & (format_.point_format < 6 ? 0x07u : 0x0fu);
  if (number > 0) ++by_return_[number - 1];
  ++points_;
  out_.put_bytes(record);
}

bool LasRecordWriter::has_short_counts() const {
  return format_.point_format < 6 && points_ <= std::numeric_limits<std::uint32_t>::max();
}

void LasRecordWriter::put_header(ByteWriter& out) const {
  const bool wkt =
      !format_.crs_wkt.empty() || (format_.point_format >= 6 && format_.geotiff.empty());
  std::uint16_t kept = kGpsTimeBit | kSyntheticReturnsBit;
  if (!format_.geotiff.empty()) kept |= kWktBit;
  out.put_text("LASF", 4);
  out.put(std::uint16_t{0});  // file source ID
  out.put(static_cast<std::uint16_t>((format_.encoding & kept) | (wkt ? kWktBit : 0)));
  out.put_text("", 16);  // project ID
  out.put(std::uint8_t{1});
  out.put(std::uint8_t{4});
  out.put_text("EXTRACTION", kId);
  out.put_text("Clearway", kId);
  out.put(std::uint32_t{0});  // day and year of creation, so that equal contents give equal bytes
  out.put(kHeaderBytes);
  out.put(kHeaderBytes + tables_bytes());
  const std::size_t tables = (format_.crs_wkt.empty() || wkt_behind_ ? 0 : 1) +
                             format_.geotiff.size() + (format_.extra_bytes.empty() ? 0 : 1);
  out.put(static_cast<std::uint32_t>(tables));
  out.put(static_cast<std::uint8_t>(format_.point_format));
  out.put(format_.record_bytes);
  put_counts(out);
}

void LasRecordWriter::put_counts(ByteWriter& out) const {
  const bool is_short = has_short_counts();
  out.put(static_cast<std::uint32_t>(is_short ? points_ : 0));
  for (unsigned i = 0; i < 5; ++i) {
    out.put(static_cast<std::uint32_t>(is_short ? by_return_[i] : 0));
  }
  out.put(format_.quantisation.scale);
  out.put(format_.quantisation.offset);
  for (int k = 0; k < 3; ++k) {
    out.put(points_ == 0 ? 0.0 : coordinate(format_.quantisation, k, bounds_.hi[k]));
    out.put(points_ == 0 ? 0.0 : coordinate(format_.quantisation, k, bounds_.lo[k]));
  }
  const std::uint64_t points_end =
      kHeaderBytes + tables_bytes() + points_ * std::uint64_t{format_.record_bytes};
  out.put(std::uint64_t{0});  // start of waveform data
  out.put(wkt_behind_ ? points_end : 0);
  out.put(static_cast<std::uint32_t>(wkt_behind_ ? 1 : 0));
  out.put(points_);
  out.put(by_return_);
}

void LasRecordWriter::finish() {
  if (wkt_behind_) {
    const auto text = text_bytes(format_.crs_wkt);
    put_table_header(out_, kCrsUser, kWktId, std::uint64_t{text.size()}, kWktText);
    out_.put_bytes(text);
  }
  out_.flush();
  file_.rewind();
  ByteWriter header(file_);
  put_header(header);
  header.flush();
}

}  // namespace clearway
