#include "io/scans/las/las_writer.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "clearway/error.hpp"

/// Source: LAS specifications 1.2 and 1.4 R15 (ASPRS).
namespace clearway {
namespace {

constexpr std::size_t kMostInTable = std::numeric_limits<std::uint16_t>::max();
constexpr std::size_t kIdBytes = 32, kUserBytes = 16;
constexpr std::uint32_t kTableHeaderBytes = 54;

/// The bits of "global encoding" that are kept. Where there is no text for the CRS, its kind is
/// that of the GeoTIFF keys.
std::uint16_t encoding_of(const LasFormat& format) {
  constexpr std::uint16_t kGpsTimeBit = 1 << 0, kSyntheticReturnsBit = 1 << 3, kWktBit = 1 << 4;
  const bool has_keys = !format.geotiff.empty();
  const bool is_text = !format.crs_wkt.empty() || (format.point_format >= 6 && !has_keys);
  const int kept = kGpsTimeBit | kSyntheticReturnsBit | (has_keys ? kWktBit : 0);
  return static_cast<std::uint16_t>((format.encoding & kept) | (is_text ? kWktBit : 0));
}

}  // namespace

std::array<std::byte, kLasExtraBytes> las_extra_bytes(std::string_view name, std::uint8_t type,
                                                      std::uint8_t options,
                                                      std::string_view description) {
  constexpr std::size_t kType = 2, kOptions = 3, kName = 4, kText = 160;
  std::array<std::byte, kLasExtraBytes> out{};
  out[kType] = std::byte{type};
  out[kOptions] = std::byte{options};
  std::memcpy(&out[kName], name.data(), std::min(name.size(), kIdBytes));
  std::memcpy(&out[kText], description.data(), std::min(description.size(), kIdBytes));
  return out;
}

LasFormat LasFormat::of_points(const Quantisation& quantisation, std::uint64_t points,
                               std::string crs_wkt, const std::vector<PointField>& fields) {
  LasFormat out{.quantisation = quantisation, .crs_wkt = std::move(crs_wkt)};
  if (points <= std::numeric_limits<std::uint32_t>::max() && out.crs_wkt.empty() &&
      fields.empty()) {
    out.minor = 2;
    out.point_format = 0;
    out.record_bytes = 20;
  }
  for (const PointField& field : fields) out.add(field);
  return out;
}

void LasFormat::add(const PointField& field) {
  constexpr std::uint8_t kTypes[] = {5, 10, 7};  // in the order of PointField::Type
  constexpr std::size_t kNone = 40;
  fields.push_back(field);
  if (field.type == PointField::Type::kClass) return;
  if (record_bytes + field.bytes() > kMostInTable ||
      extra_bytes.size() + kLasExtraBytes > kMostInTable) {
    throw InputError(
        "the scans' records are too long to get another field; expected fewer than 65,524 bytes "
        "and 340 fields of extra bytes");
  }
  record_bytes = static_cast<std::uint16_t>(record_bytes + field.bytes());
  auto description = las_extra_bytes(field.name, kTypes[static_cast<std::size_t>(field.type)],
                                     field.none ? 1 : 0, field.description);
  if (field.none) std::memcpy(&description[kNone], &*field.none, sizeof *field.none);
  extra_bytes.insert(extra_bytes.end(), description.begin(), description.end());
}

LasWriter::LasWriter(const File& file, LasFormat format, std::optional<LasTotals> declared)
    : file_(file), format_(std::move(format)), declared_(declared), out_(file) {
  if (!format_.crs_wkt.empty()) {
    format_.geotiff.clear();
    const auto text = std::as_bytes(std::span(format_.crs_wkt.c_str(), format_.crs_wkt.size() + 1));
    Table table{{"LASF_Projection", 2112, {text.begin(), text.end()}}, "OGC coordinate system WKT"};
    if (text.size() > kMostInTable) {
      behind_ = std::move(table);
    } else {
      tables_.push_back(std::move(table));
    }
  }
  for (const LasRecord& record : format_.geotiff) tables_.push_back({record, "GeoTIFF"});
  if (!format_.extra_bytes.empty()) {
    tables_.push_back({{"LASF_Spec", 4, format_.extra_bytes}, "extra bytes"});
  }
  put_header(declared_.value_or(LasTotals{}));
  for (const Table& table : tables_) put_table<std::uint16_t>(table);
}

/// Bytes: the type of the payload's size in the table's header.
template <typename Bytes>
void LasWriter::put_table(const Table& table) {
  out_.put(std::uint16_t{0});
  out_.put_text(table.record.user, kUserBytes);
  out_.put(table.record.id);
  out_.put(static_cast<Bytes>(table.record.payload.size()));
  out_.put_text(table.description, kIdBytes);
  out_.put_bytes(table.record.payload);
}

void LasWriter::put_header(const LasTotals& totals) {
  const std::uint16_t header_bytes = format_.minor == 2 ? 227 : 375;
  std::size_t offset = header_bytes;
  for (const Table& table : tables_) offset += kTableHeaderBytes + table.record.payload.size();
  out_.put_text("LASF", 4);
  out_.put(std::uint16_t{0});  // file source ID
  out_.put(encoding_of(format_));
  out_.put_text("", 16);  // project ID
  out_.put(std::uint8_t{1});
  out_.put(static_cast<std::uint8_t>(format_.minor));
  out_.put_text(format_.system, kIdBytes);
  out_.put_text("Clearway", kIdBytes);
  out_.put(std::uint32_t{0});  // day and year of creation, so that equal contents give equal bytes
  out_.put(header_bytes);
  out_.put(static_cast<std::uint32_t>(offset));
  out_.put(static_cast<std::uint32_t>(tables_.size()));
  out_.put(static_cast<std::uint8_t>(format_.point_format));
  out_.put(format_.record_bytes);
  const bool is_short =  // whether the counts of 32 bits are those of the points; otherwise 0
      format_.point_format < 6 && totals.points <= std::numeric_limits<std::uint32_t>::max();
  const auto put_short = [&](std::uint64_t count) {
    out_.put(static_cast<std::uint32_t>(is_short ? count : 0));
  };
  put_short(totals.points);
  for (std::size_t i = 0; i < 5; ++i) put_short(totals.by_return[i]);
  out_.put(format_.quantisation.scale);
  out_.put(format_.quantisation.offset);
  for (int k = 0; k < 3; ++k) {
    for (const std::int32_t bound : {totals.bounds.hi[k], totals.bounds.lo[k]}) {
      out_.put(totals.points == 0 ? 0.0 : coordinate(format_.quantisation, k, bound));
    }
  }
  if (format_.minor == 2) return;
  out_.put(std::uint64_t{0});  // start of waveform data
  out_.put(behind_ ? offset + totals.points * format_.record_bytes : std::uint64_t{0});
  out_.put(std::uint32_t{behind_ ? 1u : 0u});
  out_.put(totals.points);
  out_.put(totals.by_return);
}

void LasWriter::write(std::span<const std::byte> record) {
  if (record.size() != format_.record_bytes) {
    throw std::logic_error("LasWriter: a record of another size");
  }
  const auto q = load<std::array<std::int32_t, 3>>(record.data());
  if (written_.points == 0) written_.bounds = {{q[0], q[1], q[2]}, {q[0], q[1], q[2]}};
  written_.bounds.extend(q.data());
  const unsigned number =
      load<std::uint8_t>(record.data() + 14) & (format_.point_format < 6 ? 0x07u : 0x0fu);
  if (number > 0) ++written_.by_return[number - 1];
  ++written_.points;
  out_.put_bytes(record);
}

void LasWriter::write(std::span<const std::array<std::int32_t, 3>> quanta,
                      std::span<const FieldValues> values) {
  constexpr std::size_t kReturns = 14, kClass = 16, kExtra = 30;
  check_fields(format_.fields, values, quanta.size());
  std::vector<std::byte> record(format_.record_bytes);
  record[kReturns] =
      format_.point_format < 6 ? std::byte{0x09} : std::byte{0x11};  // first return of one
  for (std::size_t i = 0; i < quanta.size(); ++i) {
    std::memcpy(record.data(), &quanta[i], sizeof quanta[i]);
    std::byte* extra = record.data() + std::min<std::size_t>(kExtra, record.size());
    for (const FieldValues& field : values) {
      std::visit(
          [&](const auto& of_points) {
            constexpr bool is_class = sizeof of_points[i] == 1;
            std::memcpy(is_class ? &record[kClass] : extra, &of_points[i], sizeof of_points[i]);
            if (!is_class) extra += sizeof of_points[i];
          },
          field);
    }
    write(record);
  }
}

void LasWriter::finish() {
  if (declared_ && declared_->points != written_.points) {
    throw std::logic_error("LasWriter: " + std::to_string(written_.points) + " points written, " +
                           std::to_string(declared_->points) + " declared");
  }
  if (behind_) put_table<std::uint64_t>(*behind_);
  out_.flush();
  if (declared_) return;
  file_.rewind();
  put_header(written_);
  out_.flush();
}

}  // namespace clearway
