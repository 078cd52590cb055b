#include "io/paths/line/line_vertices.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/text_number.hpp"
#include "io/paths/text/pose_rows.hpp"
#include "io/paths/unread_columns.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/table_header.hpp"

namespace clearway {
namespace {

/// Coordinates beyond this many metres are on no planet.
constexpr double kFarthest = 1e9;
/// No track is canted by more metres than this.
constexpr double kMostCant = 0.3;

constexpr const char* kTransform =
    "; coordinates in the system of the scan are expected, so transform the line to it first, for "
    "example with ogr2ogr -t_srs or in a GIS";

/// Sets the unit of the coordinates. texts: their units in a header, or empty.
void set_unit(std::span<const std::string> texts, const LineOptions& options,
              const std::string& name, LineVertices& out) {
  out.unit = unit_of_positions(texts, options.unit, name);
  out.metres_per_unit =
      out.unit.is_known() ? out.unit.metres_in(options.environment_unit) : options.environment_unit;
}

/// The columns of a table that describe a line.
struct LineColumns {
  char separator = ',';
  std::size_t fields = 0;
  PlanColumns plan{};
  std::optional<std::size_t> station{}, cant{};
  std::string station_unit{}, cant_unit{};
  std::vector<std::string> unread{};  ///< names of the other columns
};

constexpr std::string_view kStation[] = {"station", "chainage"}, kCant[] = {"cant"};

/// A line in a table of text.
class LineTable {
 public:
  LineTable(InputBuffer input, const LineOptions& options)
      : input_(std::move(input)), name_(input_.name()), options_(options) {}

  LineVertices read(Remarks& remarks) {
    input_.begin_text();
    std::string_view line;
    bool cut = false;
    while (input_.next_line(line)) {
      line = without_leading_blanks(line);
      if (line.empty()) continue;
      if (is_text_comment(line)) {
        if (!columns_) take_header(line, false);
      } else if (!started_ && !starts_with_number(line)) {
        take_header(line, true);
      } else {
        add(line);
        cut = !input_.line_terminated() && line.ends_with('.');
      }
      started_ = started_ || !is_text_comment(line);
    }
    if (out_.x.empty()) refuse(name_, "holds no vertex of a line; expected at least two");
    if (cut) {
      remarks.warn("cut-text",
                   name_ +
                       ": the file ends without a line break within a number, so it may be "
                       "cut",
                   {{"line", static_cast<double>(input_.line())}});
    }
    check_cant();
    remark_unread_columns(name_, columns_->unread,
                          columns_->plan.z ? PathTable::kRaisedLine : PathTable::kLine, remarks);
    return std::move(out_);
  }

 private:
  static bool starts_with_number(std::string_view line) {
    const char* at = line.data();
    double value = 0;
    return parse_number(at, at + line.size(), value);
  }

  [[noreturn]] void refuse_here(const std::string& what) const {
    refuse_line(name_, input_.line(), what);
  }

  /// Takes the columns that a line names. sure: whether it can be nothing but the header.
  void take_header(std::string_view line, bool sure) {
    const TableHeader header = parse_table_header(line);
    const auto plan = plan_columns(header);
    if (!plan) {
      if (sure) refuse_here(excerpt(line) + objection_to(header, line));
      return;
    }
    LineColumns found{.separator = header.separator, .fields = header.names.size(), .plan = *plan};
    found.station = optional_column(header, kStation, found.station_unit);
    found.cant = optional_column(header, kCant, found.cant_unit);
    for (std::size_t i = 0; i < header.names.size(); ++i) {
      const bool read =
          i == plan->x || i == plan->y || i == plan->z || i == found.station || i == found.cant;
      if (!read && !header.names[i].empty()) found.unread.push_back(header.written[i]);
    }
    std::vector<std::string> units{header.units[plan->x], header.units[plan->y]};
    if (plan->z) units.push_back(header.units[*plan->z]);
    set_unit(units, options_, name_, out_);
    const auto metres_of = [&](const std::string& text, const char* what) {
      if (text.empty()) return UnitFactor(out_.metres_per_unit);
      const auto unit = file_unit_of(text);
      if (!unit) {
        refuse_here("the header has the " + std::string(what) + " in " + excerpt(text) +
                    "; expected " + file_unit_list());
      }
      return UnitFactor(unit->metres_in(options_.environment_unit));
    };
    metres_ = UnitFactor(out_.metres_per_unit);
    station_metres_ = metres_of(found.station_unit, "station");
    cant_metres_ = metres_of(found.cant_unit, "cant");
    columns_ = std::move(found);
  }

  std::optional<std::size_t> optional_column(const TableHeader& header,
                                             std::span<const std::string_view> names,
                                             std::string& unit) const {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < header.names.size(); ++i) {
      if (std::ranges::find(names, header.names[i]) == names.end()) continue;
      if (found) refuse_here("the header names two columns of a " + std::string(names[0]));
      found = i;
      unit = header.units[i];
    }
    return found;
  }

  std::string objection_to(const TableHeader& header, std::string_view line) const {
    if (line.starts_with('<')) {
      return ": is XML, which is not read as a line; clearway trajectory alignment reads LandXML, "
             "and a GIS writes CSV or GeoJSON";
    }
    const std::string other = other_table(header);
    if (other.starts_with("latitudes")) return ": the columns are " + other + kTransform;
    return ": expected a header that names the columns x and y once, and as it has them z, station "
           "and cant, for example x,y,z";
  }

  void add(std::string_view line) {
    if (!columns_) {
      refuse_here(excerpt(line) +
                  ": expected a header before the first numbers, which names the columns, for "
                  "example x,y,z");
    }
    if (out_.size() == kMostLineVertices) {
      refuse_here("has more vertices than " + format_count(kMostLineVertices));
    }
    split_quoted_fields(line, columns_->separator, fields_);
    line_ = line;
    if (fields_.size() != columns_->fields) {
      refuse_decimal_commas();
      refuse_here(std::to_string(fields_.size()) + " columns; expected " +
                  std::to_string(columns_->fields) + " as in the header");
    }
    out_.x.push_back(coordinate(columns_->plan.x));
    out_.y.push_back(coordinate(columns_->plan.y));
    if (columns_->plan.z) out_.z.push_back(coordinate(*columns_->plan.z));
    if (columns_->station) {
      out_.station.push_back(station_metres_(number_in(*columns_->station, "station")));
    }
    if (columns_->cant) out_.cant.push_back(cant_metres_(number_in(*columns_->cant, "cant")));
    out_.place.push_back(input_.line());
  }

  void refuse_decimal_commas() const {
    const std::string commas = decimal_commas_in(line_);
    if (!commas.empty()) refuse_here(excerpt(line_) + commas + ", as in 0.25");
  }

  double coordinate(std::size_t column) const {
    const double metres = metres_(number_in(column, "coordinate"));
    if (!(std::abs(metres) <= kFarthest)) {
      refuse_here("a coordinate of " + format_digits(metres, 9) + " m; expected one within 1e9 m");
    }
    return metres;
  }

  double number_in(std::size_t column, const char* what) const {
    const std::string_view field = fields_[column];
    const auto number = parse_whole_number(field);
    if (!number || !std::isfinite(*number)) {
      refuse_decimal_commas();
      refuse_here(excerpt(field) + " in column " + std::to_string(column + 1) +
                  "; expected a finite number as " + what);
    }
    return *number;
  }

  void check_cant() const {
    if (out_.cant.empty() || !columns_->cant_unit.empty()) return;
    for (std::size_t i = 0; i < out_.size(); ++i) {
      if (std::abs(out_.cant[i]) <= kMostCant) continue;
      refuse_line(name_, out_.place[i],
                  "a cant of " + format_digits(out_.cant[i], 9) +
                      " m, if it is in the unit of the coordinates; expected its unit in the "
                      "header, as in cant [mm]");
    }
  }

  InputBuffer input_;
  std::string name_;
  const LineOptions& options_;
  std::optional<LineColumns> columns_;
  bool started_ = false;  ///< whether a line that is not a comment was read
  UnitFactor metres_{1}, station_metres_{1}, cant_metres_{1};
  std::string_view line_;                 ///< the line that is read
  std::vector<std::string_view> fields_;  ///< its fields
  LineVertices out_;
};

/// Sizes beyond which a file of GeoJSON is no line that anyone drew.
constexpr std::uint64_t kMostGeoJsonBytes = std::uint64_t{1} << 27;
constexpr std::size_t kMostFeatures = 100'000;

/// A line in GeoJSON (RFC 7946).
class GeoJsonLine {
 public:
  GeoJsonLine(const std::filesystem::path& path, const LineOptions& options)
      : name_(path.string()), options_(options), root_(KeyReader::parse(path, text_of(path))) {}

  LineVertices read(Remarks& remarks) {
    out_.format = "geojson";
    set_unit({}, options_, name_, out_);
    take_crs();
    look_at(root_);
    if (lines_.size() != 1) {
      refuse(name_, "holds " + (lines_.empty() ? "no" : format_count(lines_.size())) +
                        " LineStrings" + others_text() + "; expected exactly one");
    }
    if (!others_.empty()) {
      remarks.note("line-others", name_ + ": beside the LineString it holds" +
                                      others_text().substr(std::string_view(" but").size()) +
                                      ", which were left out");
    }
    take_vertices(lines_.front());
    return std::move(out_);
  }

 private:
  static std::string text_of(const std::filesystem::path& path) {
    std::string text = text_of_file(path);
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    return text;
  }

  /// What the file holds besides lines: " but 3 Points and 1 Polygon".
  std::string others_text() const {
    std::string text;
    for (const auto& [type, count] : others_) {
      text += (text.empty() ? " but " : ", ") + counted(count, type.c_str());
    }
    return text;
  }

  /// Takes the reference system that files of before 2016, and those of some programs, still name.
  void take_crs() {
    if (!root_.has("crs") || !root_.at("crs").has("properties")) return;
    const KeyReader properties = root_.at("crs").at("properties");
    if (!properties.has("name") || !properties.at("name").value().is_string()) return;
    const std::string name = properties.at("name").text();
    if (name.ends_with("CRS84") || name.ends_with(":4326")) {
      refuse(name_, "crs: the coordinates are longitude and latitude (" + excerpt(name) + ")" +
                        kTransform);
    }
    const std::size_t colon = name.rfind(':');
    if (name.find("EPSG") == std::string::npos || colon == std::string::npos) return;
    const auto code = parse_count(std::string_view(name).substr(colon + 1));
    if (code && *code <= 99'999'999) out_.epsg = static_cast<long>(*code);
  }

  void look_at(const KeyReader& object) {
    const std::string type = object.at("type").text();
    if (type == "FeatureCollection") {
      for (const KeyReader& feature : object.at("features").elements(kMostFeatures)) {
        look_at(feature);
      }
    } else if (type == "Feature") {
      const KeyReader geometry = object.at("geometry");
      if (!geometry.value().is_null()) look_at(geometry);
    } else if (type == "GeometryCollection") {
      for (const KeyReader& part : object.at("geometries").elements(kMostFeatures)) look_at(part);
    } else if (type == "LineString") {
      lines_.push_back(object.at("coordinates"));
    } else if (type == "MultiLineString") {
      const KeyReader parts = object.at("coordinates");
      for (const KeyReader& part : parts.elements(kMostFeatures)) lines_.push_back(part);
    } else if (type == "Point" || type == "MultiPoint" || type == "Polygon" ||
               type == "MultiPolygon") {
      ++others_[type];
    } else {
      object.at("type").refuse(excerpt(type) + " is no type of GeoJSON (RFC 7946)");
    }
  }

  void take_vertices(const KeyReader& list) {
    if (!list.value().is_array()) list.refuse("expected a list of positions");
    if (list.value().size() > kMostLineVertices) {
      list.refuse("has " + format_count(list.value().size()) + " vertices; expected at most " +
                  format_count(kMostLineVertices));
    }
    out_.list = list.key();
    const UnitFactor metres(out_.metres_per_unit);
    std::size_t dimension = 0;
    for (const auto& position : list.value()) {
      const std::size_t i = out_.size();
      const auto refuse_position = [&](const std::string& what) {
        refuse(name_, out_.list + "[" + std::to_string(i) + "]: " + what);
      };
      const std::size_t size = position.is_array() ? position.size() : 0;
      if (size < 2 || size > 3 ||
          !std::ranges::all_of(position, [](const auto& value) { return value.is_number(); })) {
        refuse_position("expected two or three numbers, x, y and the height");
      }
      if (i == 0) dimension = size;
      if (size != dimension) {
        refuse_position("has " + std::to_string(size) + " numbers; expected " +
                        std::to_string(dimension) + " as at the first vertex");
      }
      std::array<double, 3> numbers{};
      for (std::size_t k = 0; k < size; ++k) {
        numbers[k] = metres(position[k].template get<double>());
        if (!(std::abs(numbers[k]) <= kFarthest)) {
          refuse_position("a coordinate of " + format_digits(numbers[k], 9) +
                          " m; expected one within 1e9 m");
        }
      }
      out_.x.push_back(numbers[0]);
      out_.y.push_back(numbers[1]);
      if (dimension == 3) out_.z.push_back(numbers[2]);
      out_.place.push_back(i);
    }
  }

  std::string name_;
  const LineOptions& options_;
  KeyReader root_;
  std::vector<KeyReader> lines_;
  std::map<std::string, std::size_t> others_;
  LineVertices out_;
};

/// Whether the first byte that is no blank opens an object of JSON.
bool holds_json(InputBuffer& input) {
  if (!input.can_seek()) return false;
  const InputBuffer::Mark start = input.mark();
  input.begin_text();
  constexpr std::size_t kEnough = 4096;
  const auto bytes = input.peek(kEnough);
  const auto first = std::ranges::find_if(bytes, [](std::byte byte) {
    const auto c = static_cast<char>(byte);
    return c != ' ' && c != '\t' && c != '\r' && c != '\n';
  });
  const bool found = first != bytes.end() && *first == std::byte{'{'};
  input.return_to(start);
  return found;
}

/// Leaves out vertices that stand twice in a row.
void drop_repeated(const std::string& name, LineVertices& line) {
  std::size_t kept = 0;
  const auto each_list = [&](const auto& change) {
    for (auto* list : {&line.x, &line.y, &line.z, &line.station, &line.cant}) {
      if (!list->empty()) change(*list);
    }
    change(line.place);
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool same = kept > 0 && line.x[i] == line.x[kept - 1] && line.y[i] == line.y[kept - 1];
    const auto differs = [&](const std::vector<double>& list) {
      return same && !list.empty() && list[i] != list[kept - 1];
    };
    using Named = std::pair<const std::vector<double>*, const char*>;
    for (const auto& [list, what] :
         {Named{&line.z, "height"}, Named{&line.station, "station"}, Named{&line.cant, "cant"}}) {
      if (!differs(*list)) continue;
      refuse(name, line.place_of(i) + ": the vertex is at the same place as the one before it, " +
                       "but its " + what + " differs by " +
                       format_digits((*list)[i] - (*list)[kept - 1], 9) + " m");
    }
    if (same) continue;
    each_list([&](auto& list) { list[kept] = list[i]; });
    ++kept;
  }
  each_list([&](auto& list) { list.resize(kept); });
}

}  // namespace

std::string LineVertices::place_of(std::size_t vertex) const {
  const std::string number = std::to_string(place[vertex]);
  return list.empty() ? "line " + number : list + "[" + number + "]";
}

LineVertices read_line_vertices(const std::filesystem::path& path, const LineOptions& options,
                                Remarks& out) {
  File file = File::open_for_reading(path);
  const auto access = file.is_regular() ? InputBuffer::Access::kSeek : InputBuffer::Access::kStream;
  InputBuffer input(std::move(file), access);
  const bool json = holds_json(input);
  if (json && *input.size() > kMostGeoJsonBytes) {
    refuse(path.string(), "has " + format_count(*input.size()) + " bytes; expected at most " +
                              format_count(kMostGeoJsonBytes) + " of a line in GeoJSON");
  }
  LineVertices line =
      json ? GeoJsonLine(path, options).read(out) : LineTable(std::move(input), options).read(out);
  drop_repeated(path.string(), line);
  if (line.size() < 2) {
    refuse(path.string(),
           "holds only one place; expected a line with at least two vertices at different places");
  }
  return line;
}

}  // namespace clearway
