#include "io/formats/las/las_records.hpp"

#include <span>
#include <string>
#include <string_view>

#include "io/formats/byte_load.hpp"
#include "io/formats/las/geotiff_keys.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// Reads a user id or another text of fixed length, padded with zeros.
std::string_view padded_text(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.substr(0, text.find('\0'));
}

/// Takes the CRS from a record. payload: the whole record behind its header.
void note_record(std::string_view user, unsigned id, std::span<const std::byte> payload,
                 LasCrs& crs) {
  constexpr unsigned kWkt = 2112;
  constexpr unsigned kGeoKeys = 34735;
  if (user == "LASF_Projection" && id == kGeoKeys) {
    crs.geotiff = units_of_geotiff(payload);
    crs.geotiff_epsg = epsg_of_geotiff(payload);
  }
  if (id != kWkt) return;
  std::string* wkt = user == "LASF_Projection" ? &crs.wkt
                     : user == "liblas"        ? &crs.foreign_wkt
                                               : nullptr;
  if (wkt && wkt->empty()) *wkt = padded_text(payload);
}

/// Keeps the first record of each kind that copies of points need.
void keep_record(const std::string& user, unsigned id, std::span<const std::byte> payload,
                 LasRecords& records) {
  constexpr unsigned kExtraBytes = 4, kGeoKeys = 34735, kGeoTexts = 34737;
  if (user == "LASF_Spec" && id == kExtraBytes && records.extra_bytes.empty()) {
    records.extra_bytes.assign(payload.begin(), payload.end());
  }
  if (user != "LASF_Projection" || id < kGeoKeys || id > kGeoTexts) return;
  for (const LasRecord& kept : records.geotiff) {
    if (kept.id == id) return;
  }
  records.geotiff.push_back(
      {user, static_cast<std::uint16_t>(id), {payload.begin(), payload.end()}});
}

bool is_about_crs(std::string_view user, unsigned id) {
  return (user == "LASF_Projection" || user == "liblas") && (id == 2112 || id == 34735);
}

}  // namespace

void LasCrs::describe(CloudInfo& info) const {
  info.crs_wkt = wkt.empty() ? foreign_wkt : wkt;
  if (info.crs_wkt.empty()) info.crs_epsg = geotiff_epsg;
  CrsUnits units = units_of_wkt(info.crs_wkt);
  const bool keys_count = units.horizontal == LengthUnit::kUnknown && units.trouble.empty();
  if (keys_count) {
    units = geotiff;
  } else if (geotiff.horizontal != LengthUnit::kUnknown && units.horizontal != geotiff.horizontal) {
    units.doubt = "its well-known text names the unit " + to_string(units.horizontal) +
                  ", its GeoTIFF keys " + to_string(geotiff.horizontal) +
                  ". It is taken to be in that of the text";
  }
  info.unit = units.horizontal;
  info.unit_doubt = units.doubt;
  info.unit_trouble = units.trouble;
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
                  which + " has " + std::to_string(length) +
                      " bytes; expected it to end before the " + "points at byte " +
                      std::to_string(header.points_offset));
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
    const std::string which = "extended variable length record " + std::to_string(i + 1) + " of " +
                              std::to_string(header.tail_count) + " from byte " +
                              std::to_string(start);
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
