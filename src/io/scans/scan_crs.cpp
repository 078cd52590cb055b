#include "io/scans/scan_crs.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {

ProjContext start_proj(PJ_LOG_FUNCTION log, void* kept) {
  ProjContext context(proj_context_create());
  if (!context) return context;
  proj_context_set_enable_network(context.get(), 0);
  proj_log_func(context.get(), kept, log);
  return context;
}

ProjContext start_proj() {
  return start_proj([](void*, int, const char*) {}, nullptr);
}

namespace {

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

std::string upper(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](char c) { return upper(c); });
  return result;
}

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string_view without_white_space(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// The text in upper case without white space, as PROJ compares parts of its own strings.
std::string squeezed(std::string_view text) {
  std::string out = upper(text);
  std::erase_if(out, is_space);
  return out;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// Whether a text holds a PROJ string with a parameter whose value is the name of a file, which
/// PROJ may open as soon as it reads the text. text: squeezed.
bool has_file_parameter(std::string text) {
  constexpr std::string_view kNone = "NADGRIDS=@NULL";
  for (std::size_t at; (at = text.find(kNone)) != std::string::npos;) text.erase(at, kNone.size());
  return contains(text, "GRIDS=") || contains(text, "INIT=") || contains(text, "FILE=") ||
         contains(text, "MODEL=");
}

bool is_json(std::string_view text) { return text.starts_with('{'); }

}  // namespace

bool names_files(std::string_view text) {
  const std::string all = squeezed(text);
  if (has_file_parameter(all) || contains(all, "PARAMETERFILE") || contains(all, "PROJ4_GRIDS")) {
    return true;
  }
  // In PROJJSON the name of a parameter whose value is a file ends so, and any letter can be
  // written as a number.
  return is_json(all) && (contains(all, "FILE\"") || contains(all, "\\U"));
}

namespace {

/// Appends a character of Unicode as UTF-8.
void append_utf8(std::uint32_t code, std::string& out) {
  constexpr std::uint32_t kFirst[] = {0, 0xC0, 0xE0, 0xF0};
  unsigned more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // further bytes
  out += static_cast<char>(kFirst[more] | code >> 6 * more);
  while (more-- > 0) out += static_cast<char>(0x80 | (code >> 6 * more & 0x3F));
}

/// Decodes UTF-16 up to its first zero. big: whether the first byte of two is the higher one.
std::string from_utf16(std::string_view bytes, bool big) {
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const auto second = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<std::uint32_t>(big ? first << 8 | second : second << 8 | first);
  };
  std::string out;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code == 0) break;
    const bool leads = code >= 0xD800 && code < 0xDC00 && at + 3 < bytes.size();
    if (leads && unit(at + 2) >= 0xDC00 && unit(at + 2) < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (unit(at + 2) - 0xDC00);
      at += 2;
    }
    append_utf8(code, out);
  }
  return out;
}

}  // namespace

std::string crs_text_of(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string decoded;
  if (const auto order = byte_order_of_utf16(text)) {
    const bool is_marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
    decoded = from_utf16(text.substr(is_marked ? 2 : 0), order == std::endian::big);
  } else {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    decoded = text.substr(0, text.find('\0'));
  }
  return std::string(without_white_space(decoded));
}

namespace {

constexpr std::size_t kDeepest = 64;       // levels of brackets in a text that PROJ is given
constexpr std::size_t kLongestName = 200;  // bytes of a name that PROJ's database is asked for
constexpr std::size_t kLongestText = std::size_t{1} << 18;  // bytes of a text that PROJ is given
constexpr std::size_t kMostSystems = 4;         // systems after one another that PROJ is given
constexpr std::int32_t kGreatestCode = 99'999;  // EPSG codes are not greater

bool is_word(char c) {
  return (upper(c) >= 'A' && upper(c) <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Whether a text begins like well-known text. Names in PROJ's database have round brackets too, as
/// in "NAD83(HARN)".
bool is_wkt(std::string_view text) {
  const auto word_end = std::ranges::find_if_not(text, is_word);
  if (word_end == text.begin()) return false;
  text = without_white_space({word_end, text.end()});
  return text.starts_with('[') ||
         (text.starts_with('(') && without_white_space(text.substr(1)).starts_with('"'));
}

/// The systems in a well-known text, by its brackets outside of quoted names alone.
struct WktSystems {
  /// The texts of the systems that stand one after another, and of those of heights within a system
  /// that has no place for them, which PROJ leaves out. They are parts of the text.
  std::vector<std::string_view> texts;
  bool names_unit = false;  ///< whether some keyword is that of a unit
};

bool is_of_heights(std::string_view keyword) {
  return keyword == "VERT_CS" || keyword == "VERTCS" || keyword == "VERTCRS" ||
         keyword == "VERTICALCRS";
}

bool is_compound(std::string_view keyword) {
  return keyword == "COMPD_CS" || keyword == "COMPOUNDCRS";
}

/// Whether a node has whole systems as its parts.
bool is_of_systems(std::string_view keyword) {
  return is_compound(keyword) || keyword == "SOURCECRS" || keyword == "TARGETCRS" ||
         keyword == "INTERPOLATIONCRS";
}

WktSystems systems_of(std::string_view text) {
  constexpr std::size_t kNone = std::string_view::npos;
  struct Open {
    std::size_t begin;
    std::string keyword;  ///< in upper case
    std::size_t parts = 0;
    std::string_view last_part = {};  ///< the last whole system within
  };
  WktSystems out;
  std::vector<Open> open;
  std::vector<std::string_view> within;  // systems of heights within the current system
  std::size_t begin = kNone;             // where the current system begins
  std::size_t word = 0, word_end = 0;
  bool quoted = false;
  const auto end_system = [&](std::string_view system) {
    out.texts.push_back(without_white_space(system));
    out.texts.insert(out.texts.end(), within.begin(), within.end());
    within.clear();
    begin = kNone;
  };
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    const bool closes = !quoted && (c == ']' || c == ')');
    if (begin == kNone && !closes && !is_space(c) && c != ',' && c != ';') begin = at;
    if (c == '"') quoted = !quoted;
    if (quoted || is_space(c)) continue;
    if (is_word(c)) {
      if (word_end != at) word = at;
      word_end = at + 1;
    } else if (c == '[' || c == '(') {
      open.push_back({word, upper(text.substr(word, word_end - word))});
      out.names_unit = out.names_unit || open.back().keyword.ends_with("UNIT");
      word = word_end = at + 1;  // a bracket after this one has no keyword
    } else if (closes && open.empty()) {
      if (begin != kNone) end_system(text.substr(begin, at - begin));
    } else if (closes) {
      const Open closed = std::move(open.back());
      open.pop_back();
      const bool is_part = closed.keyword.ends_with("CS") || closed.keyword.ends_with("CRS");
      if (is_part && !open.empty()) {
        ++open.back().parts;
        open.back().last_part = text.substr(closed.begin, at + 1 - closed.begin);
      }
      if (open.empty()) {
        // A compound may be closed before its second part, which then follows it.
        const bool is_lone = is_compound(closed.keyword) && closed.parts == 1;
        end_system(is_lone ? closed.last_part : text.substr(begin, at + 1 - begin));
      } else if (is_of_heights(closed.keyword) && !is_of_systems(open.back().keyword)) {
        within.push_back(text.substr(closed.begin, at + 1 - closed.begin));
      }
    }
  }
  if (begin != kNone) end_system(text.substr(begin));
  return out;
}

/// The number of levels of brackets of any kind, those in quoted names too.
std::size_t depth_of(std::string_view text) {
  std::size_t depth = 0, deepest = 0;
  for (const char c : text) {
    if (c == '[' || c == '(' || c == '{') deepest = std::max(deepest, ++depth);
    if ((c == ']' || c == ')' || c == '}') && depth > 0) --depth;
  }
  return deepest;
}

/// Whether a text is a code such as "EPSG:25832" or "EPSG:25832+5783", or the address of one.
bool is_code(std::string_view text) {
  const std::string all = upper(text);
  for (const std::string_view begin :
       {"URN:OGC:DEF:CRS", "HTTP://WWW.OPENGIS.NET/DEF/CRS", "HTTPS://WWW.OPENGIS.NET/DEF/CRS"}) {
    if (all.starts_with(begin)) return true;
  }
  const std::size_t colon = all.find(':');
  return colon != std::string::npos && colon > 0 && colon + 1 < all.size() &&
         std::ranges::all_of(all.substr(0, colon), is_word) &&
         std::ranges::all_of(all.substr(colon + 1),
                             [](char c) { return is_word(c) || c == '+' || c == ':'; });
}

/// The system of one text that PROJ reads as a whole.
ProjObject create_one(PJ_CONTEXT* context, const std::string& text) {
  if (text.empty() || contains(text, std::string_view("\0", 1)) ||
      has_file_parameter(squeezed(text))) {
    return nullptr;
  }
  ProjObject found;
  if (is_wkt(text)) {
    found.reset(proj_create_from_wkt(context, text.c_str(), nullptr, nullptr, nullptr));
  } else if (contains(text, "+proj=")) {
    const bool typed = contains(text, "+type=crs");
    found.reset(proj_create(context, (typed ? text : text + " +type=crs").c_str()));
  } else if (is_json(text) || is_code(text)) {
    found.reset(proj_create(context, text.c_str()));
  } else if (text.size() <= kLongestName) {
    // PROJ also finds names that only contain the text: "hall" in "Marshall Islands 1960".
    found.reset(proj_create(context, text.c_str()));
    const char* const name = found ? proj_get_name(found.get()) : nullptr;
    if (name == nullptr || upper(name) != upper(text)) found.reset();
  }
  if (found && proj_is_crs(found.get()) == 0) found.reset();
  return found;
}

bool is_system_of_heights(PJ_CONTEXT* context, const PJ* crs) {
  if (proj_get_type(crs) == PJ_TYPE_BOUND_CRS) {
    const ProjObject source(proj_get_source_crs(context, crs));
    return source && is_system_of_heights(context, source.get());
  }
  return proj_get_type(crs) == PJ_TYPE_VERTICAL_CRS;
}

/// The systems that a text holds: of the plane, of heights, or of both.
struct ReadSystems {
  ProjObject plane, heights;
  std::string plane_text, heights_text;
  bool names_unit = true;  ///< false where PROJ assumes a unit that the text does not name
  std::string unread;      ///< what PROJ does not read
};

ReadSystems read_systems(PJ_CONTEXT* context, std::string_view text) {
  ReadSystems out;
  WktSystems systems;
  text = without_white_space(text);
  if (text.size() > kLongestText || depth_of(text) > kDeepest) {
    out.unread = text;
    return out;
  }
  if (is_wkt(text)) {
    systems = systems_of(text);
    out.names_unit = systems.names_unit;
  } else if (!text.empty()) {
    systems.texts.push_back(text);
  }
  for (std::size_t i = 0; i < systems.texts.size() && out.unread.empty(); ++i) {
    const std::string one_text(systems.texts[i]);
    ProjObject one = i < kMostSystems ? create_one(context, one_text) : nullptr;
    const bool of_heights = one && is_system_of_heights(context, one.get());
    ProjObject& place = of_heights ? out.heights : out.plane;
    // A text may repeat a system, which is then read once.
    const bool again = one && place && one_text == (of_heights ? out.heights_text : out.plane_text);
    if (again) continue;
    if (!one || place) {
      out.unread = one_text;
      continue;
    }
    place = std::move(one);
    (of_heights ? out.heights_text : out.plane_text) = one_text;
  }
  return out;
}

}  // namespace

ProjObject create_crs(PJ_CONTEXT* context, const std::string& text) {
  ReadSystems read = read_systems(context, text);
  if (!read.unread.empty()) return nullptr;
  if (!read.plane) return std::move(read.heights);
  if (!read.heights || proj_get_type(read.plane.get()) == PJ_TYPE_COMPOUND_CRS) {
    return std::move(read.plane);
  }
  const std::string both =
      "COMPD_CS[\"" + std::string(without_white_space(proj_get_name(read.plane.get()))) + " + " +
      std::string(without_white_space(proj_get_name(read.heights.get()))) + "\"," +
      read.plane_text + "," + read.heights_text + "]";
  ProjObject compound(proj_create_from_wkt(context, both.c_str(), nullptr, nullptr, nullptr));
  return compound ? std::move(compound) : std::move(read.plane);
}

ProjObject plane_of(PJ_CONTEXT* context, ProjObject crs) {
  while (crs) {
    const PJ_TYPE type = proj_get_type(crs.get());
    if (type == PJ_TYPE_BOUND_CRS) {
      crs.reset(proj_get_source_crs(context, crs.get()));
    } else if (type == PJ_TYPE_COMPOUND_CRS) {
      crs.reset(proj_crs_get_sub_crs(context, crs.get(), 0));
    } else {
      break;
    }
  }
  return crs;
}

double unit_of_axis(PJ_CONTEXT* context, const PJ* crs, int axis) {
  const ProjObject system(proj_crs_get_coordinate_system(context, crs));
  double metres = 0;
  if (!system || proj_cs_get_axis_info(context, system.get(), axis, nullptr, nullptr, nullptr,
                                       &metres, nullptr, nullptr, nullptr) == 0) {
    return 0;
  }
  return metres;
}

LengthUnit unit_of_length(double metres) {
  // The tolerance allows for files that give few digits; the two feet differ by 2e-6 of their
  // length.
  constexpr std::array kKnown{LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kUsSurveyFoot};
  const auto difference = [metres](LengthUnit unit) { return std::abs(metres - metres_of(unit)); };
  const LengthUnit nearest =
      *std::min_element(kKnown.begin(), kKnown.end(),
                        [&](LengthUnit a, LengthUnit b) { return difference(a) < difference(b); });
  return difference(nearest) < 5e-6 * metres_of(nearest) ? nearest : LengthUnit::kUnknown;
}

std::string name_of_length(double metres) {
  const LengthUnit unit = unit_of_length(metres);
  return unit == LengthUnit::kUnknown ? format_number(metres) + " m" : to_string(unit);
}

namespace {

bool are_alike(double metres, double other) {
  return std::abs(metres - other) <= kSameHeights * other;
}

}  // namespace

std::string heights_trouble(double height_unit, LengthUnit plane) {
  const double metres = metres_of(plane);
  if (height_unit == 0 || metres == 0 || are_alike(height_unit, metres)) return {};
  return "its heights are in " + name_of_length(height_unit) + ", its other coordinates in " +
         to_string(plane);
}

namespace {

/// An axis of a coordinate system.
struct Axis {
  double unit = 0;  ///< metres, or radians; 0 where there is no such axis
  /// Metres of the known unit whose name the axis's unit has; 0 where none has it.
  double named_unit = 0;
  std::string unit_name, direction;

  /// Whether name and length of the unit contradict each other, as in UNIT["US survey foot",1].
  bool contradicts() const { return named_unit > 0 && !are_alike(unit, named_unit); }
};

Axis axis_of(PJ_CONTEXT* context, const PJ* system, int number) {
  Axis out;
  const char *direction = nullptr, *unit = nullptr;
  if (proj_cs_get_axis_info(context, system, number, nullptr, nullptr, &direction, &out.unit, &unit,
                            nullptr, nullptr) == 0) {
    return {};
  }
  if (direction != nullptr) out.direction = direction;
  if (unit != nullptr) out.unit_name = unit;
  const NamedUnit* const named = find_unit(lower_case(out.unit_name));
  if (named != nullptr) out.named_unit = named->metres();
  return out;
}

/// Takes the unit of heights from their axis.
void take_heights(const Axis& axis, CrsUnits& units) {
  if (axis.direction == "down") {
    units.trouble = "its heights count downwards";
    return;
  }
  double metres = axis.unit;
  if (axis.contradicts()) {
    // A length of 1 stands where a writer knew the name alone.
    metres = axis.named_unit;
    units.doubt = "the unit of its heights is named " + excerpt(axis.unit_name) + " and has " +
                  format_number(axis.unit) + " m. It is taken by its name";
  }
  if (units.heights != 0 && !are_alike(metres, units.heights)) {
    units.trouble = "it names two systems of heights, in " + name_of_length(units.heights) +
                    " and in " + name_of_length(metres);
    return;
  }
  units.heights = metres;
}

/// Takes the units of a system that is neither compound nor bound.
void take_single(PJ_CONTEXT* context, const PJ* crs, CrsUnits& units, std::string& unread) {
  const ProjObject system(proj_crs_get_coordinate_system(context, crs));
  const PJ_COORDINATE_SYSTEM_TYPE type =
      system ? proj_cs_get_type(context, system.get()) : PJ_CS_TYPE_UNKNOWN;
  if (type == PJ_CS_TYPE_VERTICAL) {
    take_heights(axis_of(context, system.get(), 0), units);
    return;
  }
  if (type != PJ_CS_TYPE_CARTESIAN && type != PJ_CS_TYPE_ELLIPSOIDAL &&
      type != PJ_CS_TYPE_SPHERICAL) {
    const char* const name = proj_get_name(crs);
    unread = name != nullptr ? name : "a system without axes";
    return;
  }
  if (proj_cs_get_axis_count(context, system.get()) > 2) {
    take_heights(axis_of(context, system.get(), 2), units);
  }
  if (type != PJ_CS_TYPE_CARTESIAN) {
    units.plane = LengthUnit::kDegrees;
    return;
  }
  const Axis x = axis_of(context, system.get(), 0), y = axis_of(context, system.get(), 1);
  units.plane = unit_of_length(x.unit);
  if (!are_alike(y.unit, x.unit)) {
    units.trouble = "its first coordinates are in " + name_of_length(x.unit) + ", its second in " +
                    name_of_length(y.unit);
  } else if (x.contradicts()) {
    units.trouble =
        "its unit is named " + excerpt(x.unit_name) + " and has " + format_number(x.unit) + " m";
  } else if (units.plane == LengthUnit::kUnknown) {
    units.trouble = "its unit is " + format_number(x.unit) + " m";
  }
}

void take_units(PJ_CONTEXT* context, const PJ* crs, CrsUnits& units, std::string& unread) {
  const PJ_TYPE type = proj_get_type(crs);
  if (type == PJ_TYPE_BOUND_CRS) {
    const ProjObject source(proj_get_source_crs(context, crs));
    if (source) take_units(context, source.get(), units, unread);
  } else if (type == PJ_TYPE_COMPOUND_CRS) {
    for (int i = 0;; ++i) {
      const ProjObject part(proj_crs_get_sub_crs(context, crs, i));
      if (!part) break;
      take_units(context, part.get(), units, unread);
    }
  } else {
    take_single(context, crs, units, unread);
  }
}

std::int32_t epsg_of(const PJ* crs) {
  const char* authority = proj_get_id_auth_name(crs, 0);
  const char* code = proj_get_id_code(crs, 0);
  if (authority == nullptr || code == nullptr || std::string_view(authority) != "EPSG") return 0;
  const std::string_view text = code;
  std::int32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number > 0 && number <= kGreatestCode ? number : 0;
}

std::int32_t horizontal_epsg_of(PJ_CONTEXT* context, const PJ* crs) {
  if (proj_get_type(crs) != PJ_TYPE_COMPOUND_CRS) return epsg_of(crs);
  const ProjObject horizontal(proj_crs_get_sub_crs(context, crs, 0));
  return horizontal ? epsg_of(horizontal.get()) : 0;
}

ScanCrs read_crs(const std::string& text) {
  ScanCrs out{.wkt = text, .name = "the coordinate reference system of the scans"};
  const ProjContext context = start_proj();
  if (!context) {
    out.unread = text;
    return out;
  }
  const ReadSystems read = read_systems(context.get(), text);
  out.unread = read.unread;
  for (const PJ* part : {read.plane.get(), read.heights.get()}) {
    if (part != nullptr) take_units(context.get(), part, out.units, out.unread);
  }
  // PROJ takes a local system without a unit for one in metres.
  if (!read.names_unit && out.units.plane != LengthUnit::kDegrees) out.units = {};
  const ProjObject crs = create_crs(context.get(), text);
  if (!crs) return out;
  if (const char* name = proj_get_name(crs.get())) out.name = name;
  const char* const options[] = {"MULTILINE=NO", nullptr};
  if (const char* wkt = proj_as_wkt(context.get(), crs.get(), PJ_WKT1_GDAL, options)) out.wkt = wkt;
  out.epsg = epsg_of(crs.get());
  out.horizontal_epsg = horizontal_epsg_of(context.get(), crs.get());
  return out;
}

}  // namespace

ScanCrs scan_crs_of(const std::string& text) {
  thread_local std::string last;
  thread_local ScanCrs crs{.wkt = {}, .name = "the coordinate reference system of the scans"};
  if (text == last) return crs;
  crs = read_crs(text);
  last = text;
  return crs;
}

StatedCrs stated_crs_of(const std::string& text) {
  const ScanCrs crs = scan_crs_of(text);
  StatedCrs out{.crs_wkt = text, .crs = text};
  if (!crs.unread.empty()) {
    out.crs_unread = "its coordinate reference system " + excerpt(crs.unread);
    out.crs.clear();
  }
  out.unit = crs.units.plane;
  out.height_unit = crs.units.heights;
  out.unit_trouble = crs.units.trouble;
  out.unit_doubt = crs.units.doubt;
  return out;
}

LengthUnit unit_of_crs(const std::string& text) { return scan_crs_of(text).units.plane; }

}  // namespace clearway
