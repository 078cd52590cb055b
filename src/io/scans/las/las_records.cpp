#include "io/scans/las/las_records.hpp"

#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

/// Reads a user id or another string of fixed length, padded with zeros.
std::string_view padded_text(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.substr(0, text.find('\0'));
}

constexpr unsigned kWkt = 2112, kGeoKeys = 34735, kGeoTexts = 34737;
constexpr unsigned kMathTransform = 2111, kPtxHeader = 2001;

/// What a record says that places the points, see StatedCrs::unplaced; empty for other records and
/// where it leaves the points where they are.
std::string placement_in(std::string_view user, unsigned id, std::span<const std::byte> payload) {
  const std::string name = "its record " + std::string(user) + " " + std::to_string(id);
  if (user == "LAStools" && id == kPtxHeader) {
    // LASlib writes the header of a scan in PTX, whether it has applied the matrix or not.
    constexpr std::size_t kMatrix = 144, kEntries = 16;
    constexpr double kNoise = 1e-9;
    if (payload.size() < kMatrix + kEntries * sizeof(double)) return {};
    bool moves = false;
    for (std::size_t i = 0; i < kEntries; ++i) {
      const auto number = load<double>(payload.data() + kMatrix + i * sizeof(double));
      moves = moves || !(std::abs(number - (i % 5 == 0 ? 1 : 0)) <= kNoise);
    }
    return moves ? name +
                       " holds the matrix of a scanner and does not say whether it has been applied"
                 : "";
  }
  if (user == "LASF_Projection" && id == kMathTransform) {
    const bool transforms = crs_text_of(payload).find("_MT[") != std::string::npos;
    return transforms ? name + " holds a transformation of the points that is not read" : "";
  }
  return {};
}

/// Takes the CRS from a record. payload: the whole record after its header.
void note_record(std::string_view user, unsigned id, std::span<const std::byte> payload,
                 LasCrs& crs) {
  if (user == "LASF_Projection" && id >= kGeoKeys && id <= kGeoTexts) {
    crs.geotiff.take(id, payload);
  }
  if (crs.unplaced.empty()) crs.unplaced = placement_in(user, id, payload);
  if (id != kWkt) return;
  std::string* wkt = user == "LASF_Projection" ? &crs.wkt
                     : user == "liblas"        ? &crs.foreign_wkt
                                               : nullptr;
  if (wkt && wkt->empty()) *wkt = crs_text_of(payload);
}

/// Keeps the first record of each kind that copies of points need.
void keep_record(const std::string& user, unsigned id, std::span<const std::byte> payload,
                 LasRecords& records) {
  constexpr unsigned kExtraBytes = 4;
  if (user == "LASF_Spec" && id == kExtraBytes && records.extra_bytes.empty()) {
    records.extra_bytes.assign(payload.begin(), payload.end());
  }
  if (user == "copc" && id == 1) records.copc.assign(payload.begin(), payload.end());
  if (user != "LASF_Projection" || id < kGeoKeys || id > kGeoTexts) return;
  for (const LasRecord& kept : records.geotiff) {
    if (kept.id == id) return;
  }
  records.geotiff.push_back(
      {user, static_cast<std::uint16_t>(id), {payload.begin(), payload.end()}});
}

bool is_about_crs(std::string_view user, unsigned id) {
  if (user == "LAStools") return id == kPtxHeader;
  return (user == "LASF_Projection" || user == "liblas") &&
         (id == kWkt || id == kMathTransform || (id >= kGeoKeys && id <= kGeoTexts));
}

}  // namespace

StatedCrs LasCrs::stated() const {
  const GeotiffCrs keys = geotiff.crs();
  StatedCrs out = stated_crs_of(wkt.empty() ? foreign_wkt : wkt);
  out.unplaced = unplaced;
  const bool is_read = !out.crs.empty() && out.crs_unread.empty();
  if (is_read) {
    const bool plane_by_keys = out.unit == LengthUnit::kUnknown && out.unit_trouble.empty();
    if (plane_by_keys) {
      out.unit = keys.units.plane;
      out.unit_trouble = keys.units.trouble;
      if (out.unit == LengthUnit::kUnknown) out.unit_unread = keys.unread;
    } else if (keys.units.plane != LengthUnit::kUnknown && keys.units.plane != out.unit) {
      out.unit_doubt = "its well-known text names the unit " + to_string(out.unit) +
                       ", its GeoTIFF keys " + to_string(keys.units.plane) +
                       ". It is taken to be in that of the text";
    }
    const double of_keys = keys.units.heights;
    if (out.height_unit == 0) {
      out.height_unit = of_keys;
      out.crs_doubt = keys.unread_heights;
    } else if (of_keys > 0 && out.unit_doubt.empty() &&
               std::abs(of_keys - out.height_unit) > kSameHeights * of_keys) {
      out.unit_doubt = "its well-known text names " + name_of_length(out.height_unit) +
                       " for heights, its GeoTIFF keys " + name_of_length(of_keys) +
                       ". They are taken to be in that of the text";
    }
    return out;
  }
  if (!out.crs_unread.empty() && keys.units.plane == LengthUnit::kUnknown) return out;
  const bool has_unit = keys.units.plane != LengthUnit::kUnknown;
  if (!has_unit) out.unit_unread = keys.unread;
  out.crs_doubt = has_unit && !keys.unread.empty() ? keys.unread : keys.unread_heights;
  if (!out.crs_unread.empty()) {
    out.crs_doubt = std::exchange(out.crs_unread, {}) + " is not read, so its GeoTIFF keys count";
  }
  out.crs = keys.crs;
  out.unit = keys.units.plane;
  out.height_unit = keys.units.heights;
  out.unit_trouble = keys.units.trouble;
  out.unit_doubt = keys.units.doubt;
  return out;
}

void read_las_vlrs(InputBuffer& input, const LasPublicHeader& header, LasRecords& records) {
  constexpr std::size_t kVlrHeaderBytes = 54;
  for (std::uint32_t i = 0; i < header.vlr_count; ++i) {
    const std::uint64_t start = input.position();
    const std::string which = "variable length record " + std::to_string(i + 1) + " of " +
                              std::to_string(header.vlr_count);
    const std::uint64_t room = header.points_offset - start;
    if (room < kVlrHeaderBytes) {
      refuse_byte(input.name(), start,
                  which + " does not fit before the points at byte " +
                      std::to_string(header.points_offset) + "; expected 54 bytes for its header");
    }
    const auto head = input.take(kVlrHeaderBytes);
    if (head.empty()) refuse_cut_las(input, which);
    const std::string user(padded_text(head.subspan(2, 16)));
    const unsigned id = load<std::uint16_t>(head.data() + 18);
    const std::size_t length = load<std::uint16_t>(head.data() + 20);
    if (length > room - kVlrHeaderBytes) {
      refuse_byte(input.name(), start,
                  "{} has {} bytes; expected it to end before the points at byte {}", which, length,
                  header.points_offset);
    }
    const auto payload = input.take(length);
    if (payload.size() != length) refuse_cut_las(input, which);
    if (user == "laszip encoded") records.laz.assign(payload.begin(), payload.end());
    keep_record(user, id, payload, records);
    note_record(user, id, payload, records.crs);
  }
  if (!input.skip(header.points_offset - input.position())) {
    refuse_cut_las(input, "points from byte " + std::to_string(header.points_offset));
  }
}

void read_las_tail(InputBuffer& input, const LasPublicHeader& header, LasCrs& crs) {
  constexpr std::size_t kEvlrHeaderBytes = 60;
  if (header.tail_count == 0) return;
  if (!input.skip(header.tail_offset - input.position())) {
    refuse_cut_las(
        input, "extended variable length records from byte " + std::to_string(header.tail_offset));
  }
  for (std::uint32_t i = 0; i < header.tail_count; ++i) {
    const std::uint64_t start = input.position();
    const std::string which = fmt::format("extended variable length record {} of {} from byte {}",
                                          i + 1, header.tail_count, start);
    const auto head = input.take(kEvlrHeaderBytes);
    if (head.empty()) refuse_cut_las(input, which);
    const std::string user(padded_text(head.subspan(2, 16)));
    const unsigned id = load<std::uint16_t>(head.data() + 18);
    const auto length = load<std::uint64_t>(head.data() + 20);
    std::span<const std::byte> payload;
    if (is_about_crs(user, id)) {
      if (length > InputBuffer::kCapacity) {
        refuse_byte(input.name(), start + 20,
                    "a coordinate reference system of " + std::to_string(length) +
                        " bytes; expected at most " + std::to_string(InputBuffer::kCapacity));
      }
      payload = input.take(length);
      if (payload.size() != length)
        refuse_cut_las(input, which + " with its " + std::to_string(length) + " bytes");
      note_record(user, id, payload, crs);
    } else if (!input.skip(length)) {
      refuse_cut_las(input, which + " with its " + std::to_string(length) + " bytes");
    }
  }
}

}  // namespace clearway
