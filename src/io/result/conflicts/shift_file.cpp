#include "io/result/conflicts/shift_file.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/error.hpp"
#include "core/describe/shift.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/text_writer.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/conflict_fields.hpp"

namespace clearway {
namespace {

constexpr const char* kWarnedOf = "warned_of";

/// The fields of a row, in which the side stands behind the shift.
std::vector<ConflictField> fields_of(const StretchShift& row) {
  std::vector<ConflictField> fields;
  add_fields(fields, kShiftColumns, row);
  const char* side = side_of(row);
  const auto behind = std::ranges::find(fields, "least_distance", &ConflictField::name);
  fields.insert(behind, {"side", *side != 0 ? FieldValue(std::string_view(side)) : FieldValue()});
  return fields;
}

void write_csv(const ShiftTable& table, const File& file) {
  TextWriter out(file);
  const auto write = [&](const StretchShift& row, auto text_of) {
    for (const ConflictField& field : fields_of(row)) out << text_of(field) << ",";
  };
  write({}, [](const ConflictField& field) { return field.name; });
  out << kWarnedOf << "\n";
  const auto value = [&](const StretchShift& row) {
    write(row, [](const ConflictField& field) { return csv_value(field); });
    const char* between = "";
    for (const std::string& code : row.warned_of) {
      out << between << code;
      between = " ";
    }
    out << "\n";
  };
  value(table.path);
  for (const StretchShift& row : table.conflicts) value(row);
  out.flush();
}

Json row_json(const StretchShift& row) {
  Json out = json_of(fields_of(row));
  out[kWarnedOf] = row.warned_of;
  return out;
}

/// A hash of everything that the shifts of a result depend on, besides their own options: what was
/// asked, of what, and which points collide.
std::uint64_t question_hash(const ResultReader& result) {
  const ResultHeader& header = result.header();
  std::string text = hash_text(header.environment_hash) + hash_text(header.model_hash) +
                     hash_text(header.trajectory_hash) +
                     hash_text(result.table_hash<Collisions>()) + json_number(header.radius) +
                     (header.between_poses ? " between" : " at") +
                     (header.ignores_points() ? ignored_text(header) : std::string()) +
                     (header.budget ? json_number(header.budget->clear()) : std::string());
  for (const auto& floor : header.body_floors) text += floor ? " " + json_number(*floor) : " none";
  if (header.floor) text += " floor " + json_number(*header.floor);
  for (const Box& box : header.ignore_boxes) text += line_text(box.lo) + line_text(box.hi);
  return xxh64(std::as_bytes(std::span(text)));
}

/// Reads the numbers of a table in JSON, and checks each.
class ShiftReader {
 public:
  ShiftReader(const std::filesystem::path& path, const ResultReader& result)
      : file_(KeyReader::parse(path, text_of_file(path))), result_(result) {}

  ShiftTable read() const {
    if (!file_.has("kind") || file_.value()["kind"] != "shifts") {
      file_.refuse("is no table of shifts; expected the JSON of clearway shift");
    }
    if (file_.at("question_hash").text() != hash_text(question_hash(result_))) {
      file_.refuse("holds the shifts of another result than " + result_.name());
    }
    ShiftTable table;
    table.lateral_from = *number(file_.at("lateral_from"));
    table.lateral_to = *number(file_.at("lateral_to"));
    table.step = *number(file_.at("step"));
    table.searches = count(file_.at("searches"), kMostSearches);
    table.path = row(file_.at("path"));
    const KeyReader list = file_.at("conflicts");
    if (!list.value().is_array()) list.refuse("expected a list, in brackets");
    if (list.value().empty()) return table;
    for (const KeyReader& entry : list.elements()) table.conflicts.push_back(row(entry));
    return table;
  }

 private:
  static constexpr std::uint64_t kMostSearches = std::uint64_t{1} << 53;

  StretchShift row(const KeyReader& of) const {
    StretchShift out;
    for_each_field(kShiftColumns, [&](const auto& column) {
      if (column.use.is_in_files) read(of.at(column.key), column.of(out));
    });
    const KeyReader codes = of.at(kWarnedOf);
    if (!codes.value().is_array()) codes.refuse("expected a list, in brackets");
    if (codes.value().empty()) return out;
    for (const KeyReader& code : codes.elements()) out.warned_of.push_back(code.text());
    return out;
  }

  static void read(const KeyReader& of, double& value) { value = *number(of); }
  static void read(const KeyReader& of, std::optional<double>& value) {
    if (!of.value().is_null()) value = number(of);
  }
  static void read(const KeyReader& of, std::uint64_t& value) { value = count(of, kMostSearches); }
  static void read(const KeyReader& of, std::uint32_t& value) {
    value = static_cast<std::uint32_t>(count(of, std::numeric_limits<std::uint32_t>::max()));
  }
  static void read(const KeyReader&, std::vector<std::string>&) {}  // in files behind the columns
  static std::optional<double> number(const KeyReader& of) {
    if (!of.value().is_number()) of.refuse("expected a number");
    return of.value().get<double>();
  }
  static std::uint64_t count(const KeyReader& of, std::uint64_t most) {
    if (of.value().is_number_unsigned() && of.value().get<std::uint64_t>() <= most) {
      return of.value().get<std::uint64_t>();
    }
    of.refuse("expected a whole number, 0 or above");
  }

  KeyReader file_;
  const ResultReader& result_;
};

}  // namespace

ShiftFormat shift_format_of(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".csv") return ShiftFormat::kCsv;
  if (ending == ".json") return ShiftFormat::kJson;
  throw UsageError(output.string() + ": unknown output format; the name must end in .csv or .json");
}

const char* side_of(const StretchShift& stretch) {
  if (!stretch.shift || *stretch.shift == 0) return "";
  return *stretch.shift > 0 ? "left" : "right";
}

std::string json_of(const ShiftFile& file) {
  const ResultHeader& header = file.result.header();
  Json out{{"kind", "shifts"},
           {"unit", file.unit},
           {"radius", header.radius},
           {"between_poses", header.between_poses},
           {"lateral_from", file.table.lateral_from},
           {"lateral_to", file.table.lateral_to},
           {"step", file.table.step},
           {"gap", file.conflicts.gap},
           {"min_points", file.conflicts.min_points},
           {"split", file.options.split},
           {"small_groups", file.conflicts.small_groups},
           {"small_points", file.conflicts.small_points},
           {"poses", header.poses},
           {"searches", file.table.searches}};
  if (!header.bodies.empty()) out["bodies"] = header.bodies;
  add_hashes(out, header);
  out["question_hash"] = hash_text(question_hash(file.result));
  out["path"] = row_json(file.table.path);
  std::string rows;
  for (const StretchShift& row : file.table.conflicts) {
    rows += (rows.empty() ? "\n    " : ",\n    ") + line_text(row_json(row));
  }
  return "{\n" + member_lines(out) + ",\n  \"conflicts\": [" + rows +
         (rows.empty() ? "]" : "\n  ]") + ",\n" +
         member_lines({{"warnings", file.result.findings().warnings}}) + "\n}\n";
}

void write_shifts(const ShiftFile& shifts, ShiftFormat format, const std::filesystem::path& path) {
  const File file = File::create(path);
  if (format == ShiftFormat::kCsv) return write_csv(shifts.table, file);
  TextWriter out(file);
  out << json_of(shifts);
  out.flush();
}

ShiftTable read_shifts(const std::filesystem::path& path, const ResultReader& result) {
  return ShiftReader(path, result).read();
}

void check_shifts(const ShiftTable& table, const Conflicts& conflicts, const ResultReader& result) {
  const auto is_of = [](const StretchShift& shift, const Conflict& conflict) {
    return shift.conflict == conflict.id && shift.first_pose == conflict.first_pose &&
           shift.last_pose == conflict.last_pose;
  };
  if (std::ranges::equal(table.conflicts, conflicts.listed, is_of)) return;
  refuse(result.name(), "its " + counted(conflicts.listed.size(), "conflict") +
                            " are not those of the table of shifts, which has " +
                            format_count(table.conflicts.size()) +
                            "; expected shifts that were found with the same gap, least points "
                            "and longest stretch of conflicts");
}

}  // namespace clearway
