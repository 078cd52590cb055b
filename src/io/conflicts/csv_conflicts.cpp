#include "io/conflicts/conflict_fields.hpp"
#include "io/conflicts/json_text.hpp"
#include "io/conflicts/text_conflicts.hpp"
#include "io/formats/text/csv_cell.hpp"
#include "io/formats/text/text_writer.hpp"

namespace clearway {
namespace {

std::string csv_value(const FieldValue& value) {
  if (std::holds_alternative<std::monostate>(value)) return "";
  const auto* word = std::get_if<std::string_view>(&value);
  return word != nullptr ? csv_cell(*word) : json_value(value);
}

}  // namespace

void write_csv(const ConflictFile& conflicts, const File& file) {
  const Conflicts& found = conflicts.conflicts;
  TextWriter out(file);
  for (const ConflictField& field : sample_fields(conflicts.header)) out << field.name << ",";
  out << "small_groups,small_points\n";
  const auto write_row = [&](const Conflict& conflict) {
    for (const ConflictField& field : fields_of(conflict, conflicts.header)) {
      out << csv_value(field.value) << ",";
    }
    out << found.small_groups << "," << found.small_points << "\n";
  };
  for (const Conflict& conflict : found.listed) write_row(conflict);
  for (const Conflict& group : small_groups_instead(found)) write_row(group);
  out.flush();
}

}  // namespace clearway
