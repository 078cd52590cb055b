#include "io/paths/line/line_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/text_number.hpp"
#include "io/paths/text/pose_rows.hpp"
#include "io/paths/unread_columns.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

/// Coordinates beyond this many metres are on no planet.
constexpr double kFarthest = 1e9;
/// No track is canted by more metres than this.
constexpr double kMostCant = 0.3;

constexpr const char* kTransform =
    "; coordinates in the system of the scan are expected, so transform the line to it first, for "
    "example with ogr2ogr -t_srs or in a GIS";

constexpr std::vector<double> LineVertices::*kCoordinates[] = {&LineVertices::x, &LineVertices::y,
                                                               &LineVertices::z};

/// Sets the unit of the coordinates. texts: their units in a header, or empty.
void set_unit(std::span<const std::string> texts, const LineOptions& options,
              const std::string& name, LineVertices& out) {
  out.unit = unit_of_positions(texts, options.unit, name);
  out.metres_per_unit =
      out.unit.is_known() ? out.unit.metres_in(options.environment_unit) : options.environment_unit;
}

constexpr std::string_view kStation[] = {"station", "chainage"}, kCant[] = {"cant"};

/// A line in a table of text.
class LineTable {
 public:
  LineTable(InputBuffer input, const LineOptions& options)
      : table_(std::move(input)), options_(options) {}

  LineVertices read(Remarks& remarks) {
    bool started = false;
    while (table_.next()) {
      if (table_.is_comment()) {
        if (columns_.empty()) take_header(false);
      } else if (std::exchange(started, true) || table_.starts_with_number()) {
        add();
      } else {
        take_header(true);
      }
    }
    if (out_.x.empty()) refuse(table_.name(), "holds no vertex of a line; expected at least two");
    table_.remark_cut(remarks.remarks);
    if (!cant_has_unit_) check_cant();
    remark_unread_columns(table_.name(), unread_,
                          out_.z.empty() ? PathTable::kLine : PathTable::kRaisedLine, remarks);
    return std::move(out_);
  }

 private:
  /// A column, and the list that its numbers go to.
  struct Column {
    TextColumn of;
    std::vector<double> LineVertices::*list;
  };

  /// Takes the columns that a line names. sure: whether it can be nothing but the header.
  void take_header(bool sure) {
    const TableHeader& header = table_.take_header();
    const auto plan = plan_columns(header);
    if (!plan && sure) table_.refuse_here(excerpt(table_.line()) + objection_to(header));
    if (!plan) return;
    std::vector<std::string> units{header.units[plan->x], header.units[plan->y]};
    if (plan->z) units.push_back(header.units[*plan->z]);
    set_unit(units, options_, table_.name(), out_);
    const UnitFactor metres(out_.metres_per_unit);
    columns_ = {{{"x", plan->x, true, metres}, &LineVertices::x},
                {{"y", plan->y, true, metres}, &LineVertices::y}};
    if (plan->z) columns_.push_back({{"z", *plan->z, true, metres}, &LineVertices::z});
    const ColumnUnit lengths{out_.metres_per_unit, options_.environment_unit};
    const auto station = table_.column(kStation, lengths), cant = table_.column(kCant, lengths);
    if (station) columns_.push_back({*station, &LineVertices::station});
    if (cant) columns_.push_back({*cant, &LineVertices::cant});
    cant_has_unit_ = cant && cant->has_unit;
    std::vector<std::size_t> used;
    for (const Column& column : columns_) used.push_back(column.of.index);
    unread_ = other_columns(header, used);
  }

  std::string objection_to(const TableHeader& header) const {
    if (table_.line().starts_with('<')) {
      return ": is XML, which is not read as a line; clearway trajectory alignment reads LandXML, "
             "and a GIS writes CSV or GeoJSON";
    }
    const std::string other = other_table(header);
    if (other.starts_with("latitudes")) return ": the columns are " + other + kTransform;
    return ": expected a header that names the columns x and y once, and as it has them z, station "
           "and cant, for example x,y,z";
  }

  void add() {
    if (columns_.empty()) {
      table_.refuse_here(excerpt(table_.line()) +
                         ": expected a header before the first numbers, which names the columns, "
                         "for example x,y,z");
    }
    table_.take_row(kMostLineVertices, "vertices");
    for (const auto& [of, list] : columns_) (out_.*list).push_back(table_.number(of));
    out_.place.push_back(table_.input().line());
  }

  void check_cant() const {
    for (std::size_t i = 0; i < out_.cant.size(); ++i) {
      if (std::abs(out_.cant[i]) <= kMostCant) continue;
      refuse_line(table_.name(), out_.place[i],
                  "a cant of " + format_digits(out_.cant[i], 9) +
                      " m, if it is in the unit of the coordinates; expected its unit in the "
                      "header, as in cant [mm]");
    }
  }

  TextTable table_;
  const LineOptions& options_;
  std::vector<Column> columns_;  ///< none before the header
  bool cant_has_unit_ = false;
  std::vector<std::string> unread_;  ///< names of the other columns
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
      for (std::size_t k = 0; k < size; ++k) {
        (out_.*kCoordinates[k]).push_back(metres(position[k].template get<double>()));
      }
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

void check_coordinates(const std::string& name, const LineVertices& line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    for (const auto list : kCoordinates) {
      if ((line.*list).empty() || std::abs((line.*list)[i]) <= kFarthest) continue;
      refuse(name, line.place_of(i) + ": a coordinate of " + format_digits((line.*list)[i], 9) +
                       " m; expected one within 1e9 m");
    }
  }
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
  InputBuffer input = InputBuffer::open(path);
  const bool json = holds_json(input);
  if (json && *input.size() > kMostGeoJsonBytes) {
    refuse(path.string(), "has " + format_count(*input.size()) + " bytes; expected at most " +
                              format_count(kMostGeoJsonBytes) + " of a line in GeoJSON");
  }
  LineVertices line =
      json ? GeoJsonLine(path, options).read(out) : LineTable(std::move(input), options).read(out);
  check_coordinates(path.string(), line);
  drop_repeated(path.string(), line);
  if (line.size() < 2) {
    refuse(path.string(),
           "holds only one place; expected a line with at least two vertices at different places");
  }
  return line;
}

}  // namespace clearway
