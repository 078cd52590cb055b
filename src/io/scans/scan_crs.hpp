#pragma once

#include <proj.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "io/scans/length_unit.hpp"

namespace clearway {

struct DestroyProj {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, DestroyProj>;
using ProjObject = std::unique_ptr<PJ, DestroyProj>;

/// Starts PROJ without network and silently: messages go to `log`, together with `kept`. Null where
/// PROJ cannot be started.
ProjContext start_proj(PJ_LOG_FUNCTION log, void* kept);

/// Metres per unit of an axis; 0 where there is no such axis.
double unit_of_axis(PJ_CONTEXT* context, const PJ* crs, int axis);

/// A unit as a file names it.
struct StatedUnit {
  LengthUnit unit = LengthUnit::kUnknown;
  std::string other;  ///< name of a unit that is not a LengthUnit; otherwise empty
};

/// The unit of this many metres.
StatedUnit unit_of_length(double metres);

/// The units of length that a coordinate reference system states.
struct CrsUnits {
  LengthUnit horizontal = LengthUnit::kUnknown;
  /// Why coordinates cannot be used as they are, as in "its unit is 1000 m"; empty where they can.
  std::string trouble;
  /// What in the file contradicts `horizontal`, as a sentence without its full stop; empty where
  /// nothing does.
  std::string doubt = {};
};

/// The units of a coordinate reference system in well-known text 1 or 2; unknown where the text
/// does not state them or cannot be parsed. Source: OGC 01-009 and OGC 18-010.
CrsUnits units_of_wkt(std::string_view wkt);

/// Judges a system whose plane and heights have these units.
CrsUnits crs_units(const StatedUnit& plane, const StatedUnit& heights);

/// A coordinate reference system in the ways that files name it.
struct ScanCrs {
  std::string wkt;   ///< well-known text, version 1 where PROJ can express it, otherwise as found
  std::string name;  ///< name for messages
  std::int32_t epsg = 0;  ///< EPSG code; 0 where none is known
  /// EPSG code of the horizontal part where heights have a system of their own; otherwise the same
  /// as epsg.
  std::int32_t horizontal_epsg = 0;
};

/// The reference system of a well-known text, which PROJ need not understand.
ScanCrs scan_crs_of(const std::string& wkt);

/// The reference system of an EPSG code, as GeoTIFF keys give it. Its wkt is empty and its name is
/// the code alone where PROJ's database is not installed or lacks the code.
ScanCrs scan_crs_of_epsg(std::uint16_t code);

}  // namespace clearway
