#include "io/scans/las/geotiff_keys.hpp"

#include <proj_experimental.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

constexpr std::uint16_t kDirectory = 34735, kNumbers = 34736, kTexts = 34737;  // records
constexpr std::uint16_t kModelType = 1024, kCitation = 1026;
constexpr std::uint16_t kProjectedModel = 1, kGeographicModel = 2, kGeocentricModel = 3;
constexpr std::uint16_t kGeodeticSystem = 2048;
constexpr std::uint16_t kGeodeticLinearUnit = 2052, kGeodeticLinearSize = 2053;
constexpr std::uint16_t kAngularUnit = 2054;
constexpr std::uint16_t kEllipsoid = 2056, kSemiMajor = 2057, kSemiMinor = 2058;
constexpr std::uint16_t kInverseFlattening = 2059;
constexpr std::uint16_t kProjectedSystem = 3072, kProjectedCitation = 3073;
constexpr std::uint16_t kProjection = 3074, kProjectionMethod = 3075;
constexpr std::uint16_t kProjectedLinearUnit = 3076, kProjectedLinearSize = 3077;
constexpr std::uint16_t kVerticalSystem = 4096, kVerticalCitation = 4097, kVerticalUnit = 4099;
constexpr std::uint16_t kUserDefined = 32767;

/// A method of projection with its GeoTIFF code, and the parameters of PROJ with the keys that give
/// them, of which the first that is there counts.
struct Method {
  struct Parameter {
    std::string_view name;
    std::array<std::uint16_t, 3> keys;
    enum Kind { kAngle, kLength, kNumber } kind;
  };
  std::uint16_t code;
  std::string_view name;
  std::array<Parameter, 7> parameters;
};

using enum Method::Parameter::Kind;
constexpr Method::Parameter kLongitude{"lon_0", {3080, 3084, 3088}, kAngle};
constexpr Method::Parameter kLatitude{"lat_0", {3081, 3085, 3089}, kAngle};
constexpr Method::Parameter kFirstParallel{"lat_1", {3078}, kAngle};
constexpr Method::Parameter kSecondParallel{"lat_2", {3079}, kAngle};
constexpr Method::Parameter kScale{"k_0", {3092, 3093}, kNumber};
constexpr Method::Parameter kEasting{"x_0", {3082, 3086, 3090}, kLength};
constexpr Method::Parameter kNorthing{"y_0", {3083, 3087, 3091}, kLength};
constexpr std::array kMethods{
    Method{1, "tmerc", {{kLongitude, kLatitude, kScale, kEasting, kNorthing}}},
    Method{7, "merc", {{kLongitude, {"lat_ts", {3078}, kAngle}, kScale, kEasting, kNorthing}}},
    Method{
        8, "lcc", {{kLongitude, kLatitude, kFirstParallel, kSecondParallel, kEasting, kNorthing}}},
    Method{9,
           "lcc",
           {{kLongitude,
             kLatitude,
             {"lat_1", {3081, 3085, 3089}, kAngle},
             kScale,
             kEasting,
             kNorthing}}},
    Method{10, "laea", {{kLongitude, kLatitude, kEasting, kNorthing}}},
    Method{
        11, "aea", {{kLongitude, kLatitude, kFirstParallel, kSecondParallel, kEasting, kNorthing}}},
    Method{16, "sterea", {{kLongitude, kLatitude, kScale, kEasting, kNorthing}}}};

ProjObject from_database(PJ_CONTEXT* context, std::uint16_t code, PJ_CATEGORY category) {
  return ProjObject(proj_create_from_database(context, "EPSG", std::to_string(code).c_str(),
                                              category, 0, nullptr));
}

/// The unit with an EPSG code, in metres or radians; 0 where PROJ's database has no such unit.
/// category: "linear" or "angular".
double unit_of_code(PJ_CONTEXT* context, std::uint16_t code, std::string_view category) {
  double factor = 0;
  const char* of = nullptr;
  if (proj_uom_get_info_from_database(context, "EPSG", std::to_string(code).c_str(), nullptr,
                                      &factor, &of) != 0) {
    return of != nullptr && of == category && std::isfinite(factor) ? factor : 0;
  }
  if (category == "angular") return 0;
  // The units that have to be understood where PROJ's database is not installed.
  switch (code) {
    case 9001:
      return 1;
    case 9002:
      return kMetresPerFoot;
    case 9003:
      return kMetresPerUsSurveyFoot;
    default:
      return 0;
  }
}

/// What a citation names, the free text of a key.
struct Cited {
  std::string system = {};  ///< a system that PROJ reads
  CrsUnits units = {};      ///< of the system, or those that the text names without one
  std::string unread = {};  ///< a unit that is not certain, as a part of a sentence

  double plane() const { return metres_of(units.plane); }
};

std::string_view without_padding(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ') || text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

constexpr std::string_view kAndHeights = " + ";  // between the systems that a citation names

/// The system of an entry of a citation, where PROJ reads it and it names the wanted unit. The
/// name of a geographic system does not count, because a projected one may be cited by it.
bool read_system(std::string_view text, bool of_heights, Cited& out) {
  const ScanCrs system = scan_crs_of(std::string(text));
  if (!system.unread.empty()) return false;
  const LengthUnit plane = system.units.plane;
  const bool is_text = text.find('[') != std::string_view::npos;
  const bool is_wanted = of_heights ? system.units.heights > 0
                                    : metres_of(plane) > 0 || !system.units.trouble.empty() ||
                                          (plane == LengthUnit::kDegrees && is_text);
  if (!is_wanted) return false;
  out.system = text;
  out.units = system.units;
  return true;
}

/// Reads a citation: the name of a system, or entries such as "PCS Name = ..." between bars and
/// line breaks. "ESRI PE String" holds well-known text. of_heights: whether it cites a system of
/// heights, where it does not matter which foot is meant.
Cited read_citation(std::string_view text, bool of_heights) {
  Cited out;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find_first_of("|\n"), rest.size());
    std::string_view entry = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t equals = entry.substr(0, entry.find_first_of("[(")).find('=');
    if (equals != std::string_view::npos) entry.remove_prefix(equals + 1);
    entry = without_padding(entry);
    const std::string_view first = entry.substr(0, entry.find(kAndHeights));
    if (entry.empty()) continue;
    if (read_system(entry, of_heights, out) || read_system(first, of_heights, out)) return out;
  }
  const NamedUnit* const unit = find_unit_in_words(text.substr(0, text.find(kAndHeights)));
  if (unit == nullptr) return out;
  if (unit->any_foot && !of_heights) {
    out.unread =
        "its GeoTIFF citation " + excerpt(text) +
        " is in feet and does not say which, expected the name of a system that PROJ knows";
    return out;
  }
  out.units.plane = unit->environment;
  out.units.heights = unit->metres();
  return out;
}

/// Reads the keys of a file, with PROJ's database at hand.
class Reading {
 public:
  Reading(const GeotiffKeys& keys, PJ_CONTEXT* context) : keys_(keys), context_(context) {}

  GeotiffCrs read() {
    read_plane();
    read_heights();
    return std::move(out_);
  }

 private:
  bool is_code(std::uint16_t code) const { return code != 0 && code != kUserDefined; }

  void note_unread(std::uint16_t key, std::uint16_t code, const std::string& expected) {
    std::string& unread = key >= kVerticalSystem ? out_.unread_heights : out_.unread;
    if (!unread.empty()) return;
    unread = "its GeoTIFF key " + std::to_string(key) + " is " + std::to_string(code) +
             (code == kUserDefined ? " (user-defined)" : "") + ", expected " + expected;
  }

  /// What the citations of the plane name, the first that names something.
  Cited cited_plane() const {
    Cited out = read_citation(keys_.text(kProjectedCitation), false);
    const bool names = !out.system.empty() || out.plane() > 0 || !out.unread.empty();
    return names ? out : read_citation(keys_.text(kCitation), false);
  }

  /// The length that a key of a unit names, or the key of a user-defined unit's size; 0 where the
  /// keys name none.
  double length_of(std::uint16_t unit_key, std::uint16_t size_key) {
    const std::uint16_t code = keys_.code(unit_key);
    if (is_code(code)) {
      const double metres = unit_of_code(context_, code, "linear");
      if (!(metres > 0)) note_unread(unit_key, code, "the code of a unit of length");
      return metres;
    }
    const auto size = size_key != 0 ? keys_.number(size_key) : std::nullopt;
    if (size && std::isfinite(*size) && *size > 0) return *size;
    if (code == kUserDefined) {
      note_unread(unit_key, code, "the code of a unit, or its length in another key");
    }
    return 0;
  }

  void set_plane(double metres) {
    out_.units.plane = unit_of_length(metres);
    if (out_.units.plane == LengthUnit::kUnknown) {
      out_.units.trouble = "its unit is " + name_of_length(metres);
    }
  }

  void read_plane() {
    const std::uint16_t model = keys_.code(kModelType);
    const std::uint16_t geodetic = keys_.code(kGeodeticSystem);
    const std::uint16_t projected = keys_.code(kProjectedSystem);
    const bool says_projected = projected != 0 || keys_.code(kProjectedLinearUnit) != 0 ||
                                keys_.number(kProjectedLinearSize).has_value();
    if (model == kGeocentricModel) {
      if (is_code(geodetic)) out_.crs = epsg(geodetic);
      const double metres = length_of(kGeodeticLinearUnit, kGeodeticLinearSize);
      if (metres > 0) set_plane(metres);
    } else if (model == kGeographicModel || (model == 0 && !says_projected && geodetic != 0)) {
      if (is_code(geodetic)) out_.crs = epsg(geodetic);
      out_.units.plane = LengthUnit::kDegrees;
    } else {
      read_projected(projected);
      if (model > kGeocentricModel && out_.crs.empty()) {
        note_unread(kModelType, model, "1 for projected, 2 for geographic or 3 for geocentric");
      }
    }
  }

  void read_projected(std::uint16_t code) {
    double unit = length_of(kProjectedLinearUnit, kProjectedLinearSize);
    double of_map = 0;
    if (is_code(code)) {
      const ProjObject map = plane_of(context_, from_database(context_, code, PJ_CATEGORY_CRS));
      if (map && proj_get_type(map.get()) == PJ_TYPE_PROJECTED_CRS) {
        out_.crs = epsg(code);
        of_map = unit_of_axis(context_, map.get(), 0);
      } else {
        note_unread(kProjectedSystem, code, "the code of a projected system that PROJ knows");
      }
    } else if (code == kUserDefined) {
      out_.crs = user_defined(unit);
    }
    if (out_.crs.empty() && (code != 0 || !(unit > 0))) of_map = take_citation();
    if (code == kUserDefined && out_.crs.empty() && out_.unread.empty()) {
      out_.unread = "its GeoTIFF keys define a projection of their own that is not read";
    }
    if (unit > 0 && of_map > 0 && unit_of_length(unit) != unit_of_length(of_map)) {
      out_.units.doubt =
          "its GeoTIFF keys contradict each other: they name the unit " + name_of_length(unit) +
          ", and " +
          (out_.crs.starts_with("EPSG:") ? out_.crs + ", whose unit is " : "a citation in ") +
          units_text(of_map) + ". It is taken to be in the named unit";
    }
    if (!(unit > 0)) unit = of_map;
    // Some writers name the unit of the plane in the key of geodetic systems.
    if (!(unit > 0) && !out_.unread.empty() && !is_in_some_foot_) {
      unit = unit_of_code(context_, keys_.code(kGeodeticLinearUnit), "linear");
    }
    if (unit > 0) set_plane(unit);
  }

  /// Takes the system of a citation, where no other key names one that is read. Returns the unit
  /// that the citation names, in metres, or 0.
  double take_citation() {
    Cited cited = cited_plane();
    if (cited.units.plane == LengthUnit::kDegrees) out_.units.plane = LengthUnit::kDegrees;
    if (!cited.units.trouble.empty()) out_.units.trouble = cited.units.trouble;
    if (!cited.system.empty()) out_.unread.clear();
    if (!cited.unread.empty()) {
      is_in_some_foot_ = true;
      out_.unread = std::move(cited.unread);
    }
    out_.crs = std::move(cited.system);
    return cited.plane();
  }

  /// The citation of heights, or what the citation of all says after that of the plane.
  std::string_view cited_heights() const {
    const std::string_view own = keys_.text(kVerticalCitation), all = keys_.text(kCitation);
    const std::size_t at = all.find(kAndHeights);
    if (!own.empty() || at == std::string_view::npos) return own;
    return all.substr(at + kAndHeights.size());
  }

  void read_heights() {
    const std::uint16_t code = keys_.code(kVerticalSystem);
    const double named = length_of(kVerticalUnit, 0);
    double of_system = 0;
    if (is_code(code)) {
      const ProjObject system = from_database(context_, code, PJ_CATEGORY_CRS);
      const PJ_TYPE type = system ? proj_get_type(system.get()) : PJ_TYPE_UNKNOWN;
      if (type == PJ_TYPE_VERTICAL_CRS) {
        of_system = unit_of_axis(context_, system.get(), 0);
        const CrsUnits read = scan_crs_of(epsg(code)).units;
        if (!read.trouble.empty()) out_.units.trouble = read.trouble;
        if (out_.crs.starts_with("EPSG:")) out_.crs += "+" + std::to_string(code);
      } else if (type == PJ_TYPE_GEOGRAPHIC_3D_CRS) {
        of_system = unit_of_axis(context_, system.get(), 2);
      } else if (named == 0) {
        note_unread(kVerticalSystem, code, "the code of a system of heights that PROJ knows");
      }
    } else if (named == 0) {
      of_system = read_citation(cited_heights(), true).units.heights;
      if (of_system == 0 && code == kUserDefined) {
        note_unread(kVerticalSystem, code,
                    "a system of heights, or the unit of heights in key 4099");
      }
    }
    if (of_system == 0 && code == 0 && !out_.crs.empty()) {
      of_system = scan_crs_of(out_.crs).units.heights;
    }
    out_.units.heights = named > 0 ? named : of_system;
    const bool differ =
        named > 0 && of_system > 0 && std::abs(named - of_system) > kSameHeights * of_system;
    if (differ && out_.units.doubt.empty()) {
      out_.units.doubt = "its GeoTIFF keys contradict each other: they name " +
                         name_of_length(named) + " for heights, and a system with heights in " +
                         name_of_length(of_system) + ". They are taken to be in the named unit";
    }
  }

  static std::string epsg(std::uint16_t code) { return "EPSG:" + std::to_string(code); }

  /// The system that the keys define themselves, as a text for PROJ; empty where it is not read.
  /// unit: of its plane, metres; 0 where it is not known.
  std::string user_defined(double unit) {
    const std::uint16_t projection = keys_.code(kProjection);
    if (is_code(projection)) return of_projection(projection, unit);
    const std::uint16_t code = keys_.code(kProjectionMethod);
    const auto* const method = std::ranges::find(kMethods, code, &Method::code);
    if (method == kMethods.end() || !(unit > 0)) return {};
    std::string text = "+proj=" + std::string(method->name);
    for (const Method::Parameter& parameter : method->parameters) {
      const auto value = value_of(parameter, unit);
      if (value) text += " +" + std::string(parameter.name) + "=" + format_number(*value);
    }
    return text + ellipsoid() + " +to_meter=" + format_number(unit) + " +no_defs";
  }

  std::optional<double> value_of(const Method::Parameter& parameter, double unit) {
    for (const std::uint16_t key : parameter.keys) {
      const auto value = key != 0 ? keys_.number(key) : std::nullopt;
      if (!value || !std::isfinite(*value)) continue;
      if (parameter.kind == kAngle) return *value * degrees();
      return parameter.kind == kLength ? *value * unit : *value;
    }
    return std::nullopt;
  }

  /// Degrees of the unit of angles.
  double degrees() const {
    const std::uint16_t code = keys_.code(kAngularUnit);
    const double radians = is_code(code) ? unit_of_code(context_, code, "angular") : 0;
    return radians > 0 ? radians * 180 / std::numbers::pi : 1;
  }

  /// The ellipsoid as parameters of PROJ. That of WGS 84 stands for one that is not known, which
  /// changes a scale by less than a ten-thousandth.
  std::string ellipsoid() const {
    const std::uint16_t system = keys_.code(kGeodeticSystem), code = keys_.code(kEllipsoid);
    ProjObject found;
    if (is_code(system)) {
      const ProjObject crs = from_database(context_, system, PJ_CATEGORY_CRS);
      if (crs) found.reset(proj_get_ellipsoid(context_, crs.get()));
    }
    if (!found && is_code(code)) found = from_database(context_, code, PJ_CATEGORY_ELLIPSOID);
    double major = 0, minor = 0;
    if (found) {
      proj_ellipsoid_get_parameters(context_, found.get(), &major, &minor, nullptr, nullptr);
    } else if (const auto stated = keys_.number(kSemiMajor)) {
      const auto flattening = keys_.number(kInverseFlattening);
      major = *stated;
      minor = flattening && *flattening > 0 ? major * (1 - 1 / *flattening)
                                            : keys_.number(kSemiMinor).value_or(major);
    }
    if (!(major > 0) || !(minor > 0) || !std::isfinite(major) || minor > major) {
      return " +ellps=WGS84";
    }
    return " +a=" + format_number(major) + " +b=" + format_number(minor);
  }

  /// The map of a projection in EPSG's database, such as 16032 for that of UTM zone 32 north.
  std::string of_projection(std::uint16_t code, double unit) {
    const std::uint16_t system = keys_.code(kGeodeticSystem);
    const ProjObject conversion = from_database(context_, code, PJ_CATEGORY_COORDINATE_OPERATION);
    const ProjObject base =
        from_database(context_, is_code(system) ? system : std::uint16_t{4326}, PJ_CATEGORY_CRS);
    const ProjObject axes(proj_create_cartesian_2D_cs(context_, PJ_CART2D_EASTING_NORTHING, "unit",
                                                      unit > 0 ? unit : 1));
    if (!conversion || !base || !axes) return {};
    const ProjObject map(proj_create_projected_crs(context_, "map of GeoTIFF keys", base.get(),
                                                   conversion.get(), axes.get()));
    const char* const options[] = {"MULTILINE=NO", nullptr};
    const char* const text =
        map ? proj_as_wkt(context_, map.get(), PJ_WKT2_2019, options) : nullptr;
    return text != nullptr ? text : "";
  }

  const GeotiffKeys& keys_;
  PJ_CONTEXT* context_;
  GeotiffCrs out_;
  bool is_in_some_foot_ = false;  ///< whether a citation names a foot and not which
};

}  // namespace

void GeotiffKeys::take(unsigned record, std::span<const std::byte> payload) {
  std::vector<std::byte>& kept = record == kDirectory ? directory_
                                 : record == kNumbers ? numbers_
                                                      : texts_;
  if (kept.empty()) kept.assign(payload.begin(), payload.end());
}

namespace {

/// The entry of a key in a directory, 8 bytes; empty where it is missing.
std::span<const std::byte> entry_of(std::span<const std::byte> directory, std::uint16_t key) {
  if (directory.size() < 8) return {};
  const std::size_t declared = load<std::uint16_t>(directory.data() + 6);
  const std::size_t keys = std::min(declared, directory.size() / 8 - 1);
  for (std::size_t i = 1; i <= keys; ++i) {
    const auto entry = directory.subspan(8 * i, 8);
    if (load<std::uint16_t>(entry.data()) == key) return entry;
  }
  return {};
}

}  // namespace

std::uint16_t GeotiffKeys::code(std::uint16_t key) const {
  const auto entry = entry_of(directory_, key);
  const bool is_short = !entry.empty() && load<std::uint16_t>(entry.data() + 2) == 0;
  return is_short ? load<std::uint16_t>(entry.data() + 6) : std::uint16_t{0};
}

std::optional<double> GeotiffKeys::number(std::uint16_t key) const {
  const auto entry = entry_of(directory_, key);
  if (entry.empty()) return std::nullopt;
  const auto where = load<std::uint16_t>(entry.data() + 2);
  const std::size_t at = load<std::uint16_t>(entry.data() + 6);
  if (where == 0) return static_cast<double>(at);
  if (where != kNumbers || 8 * (at + 1) > numbers_.size()) return std::nullopt;
  return load<double>(numbers_.data() + 8 * at);
}

std::string_view GeotiffKeys::text(std::uint16_t key) const {
  const auto entry = entry_of(directory_, key);
  if (entry.empty() || load<std::uint16_t>(entry.data() + 2) != kTexts) return {};
  const std::size_t at = load<std::uint16_t>(entry.data() + 6);
  if (at >= texts_.size()) return {};
  const std::string_view all(reinterpret_cast<const char*>(texts_.data()), texts_.size());
  std::string_view text = all.substr(at, load<std::uint16_t>(entry.data() + 4));
  text = text.substr(0, text.find('\0'));
  while (text.ends_with('|')) text.remove_suffix(1);
  return text;
}

GeotiffCrs GeotiffKeys::crs() const {
  // Files of one scan have the same keys.
  thread_local GeotiffKeys last;
  thread_local GeotiffCrs crs;
  if (*this == last) return crs;
  const ProjContext context = start_proj();
  crs = context ? Reading(*this, context.get()).read()
                : GeotiffCrs{.unread = "PROJ cannot be started"};
  last = *this;
  return crs;
}

}  // namespace clearway
