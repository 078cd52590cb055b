#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/scans/scan_crs.hpp"

namespace clearway {

/// What GeoTIFF keys say of a coordinate reference system.
struct GeotiffCrs {
  CrsUnits units = {};
  /// The system in a form that scan_crs_of() reads, such as "EPSG:25832"; empty where the keys name
  /// none, or one that is not known.
  std::string crs = {};
  /// What the keys say of the plane or of heights that is not read, as a sentence without its full
  /// stop; otherwise empty.
  std::string unread = {}, unread_heights = {};
};

/// GeoTIFF keys, as LAS keeps them in the records 34735 to 34737. Codes are those of EPSG and are
/// looked up in PROJ's database. Source: OGC GeoTIFF 1.1, LAS 1.4 R15 section 3.3.
class GeotiffKeys {
 public:
  /// Takes the contents of one of the three records, by its number. The first of each counts.
  void take(unsigned record, std::span<const std::byte> payload);

  /// What the keys say. A directory that is cut off is read as far as it goes. The last keys of
  /// each thread are cached.
  GeotiffCrs crs() const;

  /// The value of a key that holds one short; 0 where it is missing.
  std::uint16_t code(std::uint16_t key) const;
  /// The value of a key that holds a number; nullopt where it is missing.
  std::optional<double> number(std::uint16_t key) const;
  /// The value of a key that holds a text, without the bar that ends it; empty where it is missing.
  std::string_view text(std::uint16_t key) const;

  friend bool operator==(const GeotiffKeys&, const GeotiffKeys&) = default;

 private:
  std::vector<std::byte> directory_, numbers_, texts_;
};

}  // namespace clearway
