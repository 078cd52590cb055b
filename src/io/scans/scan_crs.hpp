#pragma once

#include <proj.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "io/scans/length_unit.hpp"
#include "io/scans/stated_crs.hpp"

/// Coordinate reference systems as PROJ reads them. Texts come from files of unknown origin, so
/// nothing here makes PROJ open a file that a text names (docs/design/security.md).
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
/// Starts PROJ without network and without messages. Null where PROJ cannot be started.
ProjContext start_proj();

/// Whether a text about a system names files, such as grids for heights.
bool names_files(std::string_view text);

/// The text of a record: up to its first zero, without white space around it, in UTF-8. UTF-16 is
/// recognised by its byte order mark or by its zeros.
std::string crs_text_of(std::span<const std::byte> bytes);

/// The system of a text from a file: well-known text of any kind, PROJJSON, a PROJ string, a code
/// such as "EPSG:25832", or the exact name of a system in PROJ's database. Well-known text may be
/// followed by that of a system of heights, and may have surplus brackets. Null where PROJ does not
/// read it.
ProjObject create_crs(PJ_CONTEXT* context, const std::string& text);

/// A system without what is around it: the source of a bound one and the first part of a compound
/// one, which have no axes themselves. Null for null.
ProjObject plane_of(PJ_CONTEXT* context, ProjObject crs);

/// Metres per unit of an axis, or radians where it is one of angles; 0 where there is no such axis.
double unit_of_axis(PJ_CONTEXT* context, const PJ* crs, int axis);

/// The unit of this many metres; kUnknown where it is none of an environment.
LengthUnit unit_of_length(double metres);
/// A unit of this many metres in words: "us-survey-foot" or "1000 m".
std::string name_of_length(double metres);

/// Difference of two units of length, as a share, up to which heights go with other coordinates. It
/// separates the metre from the foot, but not the two feet, which make 2 mm at 1,000 m.
inline constexpr double kSameHeights = 1e-4;

/// Why heights in units of `height_unit` metres do not go with other coordinates in `plane`, as in
/// "its heights are in us-survey-foot, its other coordinates in metre". Empty where they do, and
/// where one of the two is not known.
std::string heights_trouble(double height_unit, LengthUnit plane);

/// The units of length that a coordinate reference system states.
struct CrsUnits {
  LengthUnit plane = LengthUnit::kUnknown;
  double heights = 0;  ///< metres per unit of its heights; 0 where it has none
  /// Why coordinates cannot be used as they are, as in "its unit is 1000 m"; empty where they can.
  std::string trouble = {};
  /// What contradicts these units, as a sentence without its full stop; empty where nothing does.
  std::string doubt = {};
};

/// A coordinate reference system in the ways that files name it.
struct ScanCrs {
  std::string wkt;   ///< well-known text, version 1 where PROJ can express it, otherwise as found
  std::string name;  ///< name for messages
  std::int32_t epsg = 0;  ///< EPSG code; 0 where none is known
  /// EPSG code of the horizontal part where heights have a system of their own; otherwise the same
  /// as epsg.
  std::int32_t horizontal_epsg = 0;
  CrsUnits units = {};
  std::string unread = {};  ///< the part of the text that PROJ does not read, shortened
};

/// The system of a text, see create_crs(). The last text of each thread is cached.
ScanCrs scan_crs_of(const std::string& text);

/// What a text in a file says, see create_crs().
StatedCrs stated_crs_of(const std::string& text);

/// The unit of the plane of a system; kUnknown where the text does not name it.
LengthUnit unit_of_crs(const std::string& text);

}  // namespace clearway
