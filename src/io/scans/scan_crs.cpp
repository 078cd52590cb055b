#include "io/scans/scan_crs.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/input_error.hpp"

namespace clearway {

ProjContext start_proj(PJ_LOG_FUNCTION log, void* kept) {
  ProjContext context(proj_context_create());
  if (!context) return context;
  proj_context_set_enable_network(context.get(), 0);
  proj_log_func(context.get(), kept, log);
  return context;
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

namespace {

constexpr std::size_t kRoot = static_cast<std::size_t>(-1);

/// A node KEYWORD[value, ..., child, ...] of well-known text. Nodes are in the order of the text.
struct Node {
  std::string keyword;  ///< upper case
  std::size_t parent;
  std::vector<std::string_view> values;  ///< bare words and numbers, without quoted strings
};

bool is_word(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '.' || c == '-' || c == '+';
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return result;
}

/// Parses well-known text, without recursion so that no text can exhaust the stack. Unbalanced
/// brackets end the parsing.
std::vector<Node> parse(std::string_view text) {
  std::vector<Node> nodes;
  std::size_t open = kRoot;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"') {
      const std::size_t close = text.find('"', at + 1);
      if (close == std::string_view::npos) break;
      at = close + 1;
    } else if (is_word(c)) {
      std::size_t end = at;
      while (end < text.size() && is_word(text[end])) ++end;
      const std::string_view word = text.substr(at, end - at);
      at = end;
      while (at < text.size() && text[at] == ' ') ++at;
      if (at < text.size() && (text[at] == '[' || text[at] == '(')) {
        nodes.push_back({upper(word), open, {}});
        open = nodes.size() - 1;
        ++at;
      } else if (open != kRoot) {
        nodes[open].values.push_back(word);
      }
    } else {
      if (c == ']' || c == ')') {
        if (open == kRoot) break;
        open = nodes[open].parent;
      }
      ++at;
    }
  }
  return nodes;
}

bool is_one_of(const Node& node, std::initializer_list<std::string_view> keywords) {
  return std::find(keywords.begin(), keywords.end(), node.keyword) != keywords.end();
}

std::optional<std::size_t> find(const std::vector<Node>& nodes,
                                std::initializer_list<std::string_view> keywords) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (is_one_of(nodes[i], keywords)) return i;
  }
  return std::nullopt;
}

StatedUnit unit_of(const Node& node) {
  if (node.values.empty()) return {};
  const std::string_view text = node.values.front();
  double metres = 0;
  std::from_chars(text.data(), text.data() + text.size(), metres);
  return unit_of_length(metres);
}

/// The unit given in the system itself, or else in its first axis that gives one.
StatedUnit unit_within(const std::vector<Node>& nodes, std::size_t system) {
  for (const Node& node : nodes) {
    if (node.parent == system && is_one_of(node, {"UNIT", "LENGTHUNIT"})) return unit_of(node);
  }
  for (const Node& node : nodes) {
    if (!is_one_of(node, {"UNIT", "LENGTHUNIT"}) || node.parent == kRoot) continue;
    const Node& axis = nodes[node.parent];
    if (axis.keyword == "AXIS" && axis.parent == system) return unit_of(node);
  }
  return {};
}

bool has_cartesian_axes(const std::vector<Node>& nodes, std::size_t system) {
  return std::any_of(nodes.begin(), nodes.end(), [&](const Node& node) {
    return node.keyword == "CS" && node.parent == system && !node.values.empty() &&
           upper(node.values.front()) == "CARTESIAN";
  });
}

StatedUnit horizontal(const std::vector<Node>& nodes) {
  const auto metric = find(nodes, {"PROJCS", "PROJCRS", "PROJECTEDCRS", "GEOCCS", "LOCAL_CS",
                                   "ENGCRS", "ENGINEERINGCRS"});
  if (metric) return unit_within(nodes, *metric);
  const auto geodetic = find(nodes, {"GEODCRS", "GEODETICCRS"});
  if (geodetic && has_cartesian_axes(nodes, *geodetic)) return unit_within(nodes, *geodetic);
  if (geodetic || find(nodes, {"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS"})) {
    return {LengthUnit::kDegrees, {}};
  }
  return {};
}

}  // namespace

StatedUnit unit_of_length(double metres) {
  // The tolerance allows for files that give few digits; the two feet differ by 2e-6 of their
  // length.
  constexpr std::array kKnown{LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kUsSurveyFoot};
  const auto difference = [metres](LengthUnit unit) { return std::abs(metres - metres_of(unit)); };
  const LengthUnit nearest =
      *std::min_element(kKnown.begin(), kKnown.end(),
                        [&](LengthUnit a, LengthUnit b) { return difference(a) < difference(b); });
  if (difference(nearest) < 5e-6 * metres_of(nearest)) return {nearest, {}};
  return {LengthUnit::kUnknown, shown(metres) + " m"};
}

CrsUnits crs_units(const StatedUnit& plane, const StatedUnit& heights) {
  if (!plane.other.empty()) return {plane.unit, "its unit is " + plane.other};
  const bool stated = heights.unit != LengthUnit::kUnknown || !heights.other.empty();
  const bool comparable = plane.unit != LengthUnit::kUnknown && plane.unit != LengthUnit::kDegrees;
  if (stated && plane.unit == LengthUnit::kUnknown && heights.unit != LengthUnit::kMetre) {
    return {plane.unit,
            {},
            "its heights are in " +
                (heights.other.empty() ? to_string(heights.unit) : heights.other) +
                ", and no unit of its other coordinates is named. They are taken for metres; "
                "--unit names another unit"};
  }
  if (!stated || !comparable || heights.unit == plane.unit) return {plane.unit, {}};
  return {plane.unit, "its heights are in " +
                          (heights.other.empty() ? to_string(heights.unit) : heights.other) +
                          ", its other coordinates in " + to_string(plane.unit)};
}

CrsUnits units_of_wkt(std::string_view wkt) {
  const std::vector<Node> nodes = parse(wkt);
  const auto vertical = find(nodes, {"VERT_CS", "VERTCRS", "VERTICALCRS"});
  return crs_units(horizontal(nodes), vertical ? unit_within(nodes, *vertical) : StatedUnit());
}

namespace {

constexpr std::int32_t kGreatestCode = 99'999;  // EPSG codes are not greater

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

void log_nothing(void*, int, const char*) {}

}  // namespace

ScanCrs scan_crs_of(const std::string& wkt) {
  ScanCrs out{wkt, "the coordinate reference system of the scans"};
  if (wkt.empty() || wkt.find('\0') != std::string::npos) return out;
  const ProjContext context = start_proj(log_nothing, nullptr);
  if (!context) return out;
  const ProjObject crs(proj_create_from_wkt(context.get(), wkt.c_str(), nullptr, nullptr, nullptr));
  if (!crs || proj_is_crs(crs.get()) == 0) return out;
  if (const char* name = proj_get_name(crs.get())) out.name = name;
  const char* const options[] = {"MULTILINE=NO", nullptr};
  if (const char* text = proj_as_wkt(context.get(), crs.get(), PJ_WKT1_GDAL, options)) {
    out.wkt = text;
  }
  out.epsg = epsg_of(crs.get());
  out.horizontal_epsg = horizontal_epsg_of(context.get(), crs.get());
  return out;
}

ScanCrs scan_crs_of_epsg(std::uint16_t code) {
  ScanCrs out{"", "EPSG:" + std::to_string(code), code, code};
  const ProjContext context = start_proj(log_nothing, nullptr);
  if (!context) return out;
  const ProjObject crs(proj_create_from_database(
      context.get(), "EPSG", std::to_string(code).c_str(), PJ_CATEGORY_CRS, 0, nullptr));
  if (!crs) return out;
  if (const char* name = proj_get_name(crs.get())) out.name = name;
  out.horizontal_epsg = horizontal_epsg_of(context.get(), crs.get());
  return out;
}

}  // namespace clearway
