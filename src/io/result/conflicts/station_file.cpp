#include "io/result/conflicts/station_file.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/describe/stations.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/file.hpp"
#include "io/files/text_writer.hpp"
#include "io/result/conflicts/conflict_fields.hpp"

namespace clearway {
namespace {

/// An overthrow to a tenth of a micrometre, which is finer than any path is known. Without this,
/// roundings would show where it is 0.
FieldValue overthrow_value(const std::optional<double>& metres) {
  constexpr double kDigits = 1e7;
  if (!metres) return {};
  return std::round(*metres * kDigits) / kDigits + 0.0;  // the sum makes 0 of -0
}

/// The fields of a row, with the same names in the same order for every row of a table.
std::vector<ConflictField> fields_of(const StationRow& row,
                                     const std::vector<std::string>& bodies) {
  std::vector<ConflictField> fields;
  add_fields(fields, kStationColumns, row);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string prefix = bodies[b].empty() ? "" : bodies[b] + "_";
    const Overthrow& overthrow = row.overthrow.at(b);
    fields.push_back({prefix + "overthrow_end", overthrow_value(overthrow.end), true});
    fields.push_back({prefix + "overthrow_middle", overthrow_value(overthrow.middle), true});
  }
  return fields;
}

void write_csv(const StationFile& stations, const File& file) {
  TextWriter out(file);
  const auto write = [&](const StationRow& row, const std::string& doubts, auto text_of) {
    for (const ConflictField& field : fields_of(row, stations.table.bodies)) {
      out << text_of(field) << ",";
    }
    out << doubts << "\n";
  };
  StationRow header;
  header.overthrow.resize(stations.table.bodies.size());
  write(header, "doubts", [](const ConflictField& field) { return csv_cell(field.name); });
  for (const StationRow& row : stations.table.rows) {
    std::string doubts;  // codes have no blanks
    for (const std::string& code : row.doubts) doubts += (doubts.empty() ? "" : " ") + code;
    write(row, doubts, [](const ConflictField& field) { return csv_value(field); });
  }
  out.flush();
}

Json row_json(const StationRow& row, const std::vector<std::string>& bodies) {
  Json out = json_of(fields_of(row, bodies));
  out["reasons"] = json_of_fact(row.reasons);
  out["doubts"] = row.doubts;
  out["searched"] = row.is_searched;
  return out;
}

void write_json(const StationFile& stations, const File& file) {
  TextWriter out(file);
  out << "{\n" << member_lines(summary_of(stations)) << ",\n  \"stations\": [";
  const char* between = "\n    ";
  for (const StationRow& row : stations.table.rows) {
    out << between << line_text(row_json(row, stations.table.bodies));
    between = ",\n    ";
  }
  out << (stations.table.rows.empty() ? "]\n}\n" : "\n  ]\n}\n");
  out.flush();
}

}  // namespace

StationFormat station_format_of(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".csv") return StationFormat::kCsv;
  if (ending == ".json") return StationFormat::kJson;
  throw UsageError(output.string() + ": unknown output format; the name must end in .csv or .json");
}

Json summary_of(const StationFile& file) {
  const ResultHeader& header = file.header;
  Json out{{"kind", "stations"},
           {"unit", symbol_of(unit_of(header))},
           {"radius", header.radius},
           {"clearance", header.clearance},
           {"between_poses", header.between_poses},
           {"verdict", name_of(file.answer.verdict())},
           {"doubts", file.answer.doubts()},
           {"every", file.options.every},
           {"chainage_start", file.options.chainage_start},
           {"station_count", file.table.rows.size()},
           {"poses", header.poses}};
  if (!header.bodies.empty()) out["bodies"] = header.bodies;
  add_hashes(out, header);
  std::vector<Message> warnings = file.answer.warnings;
  warnings.insert(warnings.end(), file.table.warnings.begin(), file.table.warnings.end());
  out["warnings"] = warnings;
  return out;
}

void write_stations(const StationFile& stations, StationFormat format,
                    const std::filesystem::path& path) {
  const File file = File::create(path);
  if (format == StationFormat::kCsv) return write_csv(stations, file);
  write_json(stations, file);
}

}  // namespace clearway
