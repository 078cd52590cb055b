#include "io/conflicts/conflict_fields.hpp"
#include "io/conflicts/json_text.hpp"
#include "io/conflicts/text_conflicts.hpp"
#include "io/formats/text/text_writer.hpp"

namespace clearway {
namespace {

/// The names of bodies may have commas and quotes (RFC 4180).
std::string csv_word(std::string_view word) {
  if (word.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(word);
  std::string quoted = "\"";
  for (const char c : word) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_value(const FieldValue& value) {
  if (std::holds_alternative<std::monostate>(value)) return "";
  const auto* word = std::get_if<std::string_view>(&value);
  return word != nullptr ? csv_word(*word) : json_value(value);
}

}  // namespace

void write_csv(const ConflictFile& conflicts, const File& file) {
  TextWriter out(file);
  const char* between = "";
  for (const ConflictField& field : sample_fields(conflicts.header)) {
    out << between << field.name;
    between = ",";
  }
  out << "\n";
  for (const Conflict& conflict : conflicts.conflicts.listed) {
    between = "";
    for (const ConflictField& field : fields_of(conflict, conflicts.header)) {
      out << between << csv_value(field.value);
      between = ",";
    }
    out << "\n";
  }
  out.flush();
}

}  // namespace clearway
