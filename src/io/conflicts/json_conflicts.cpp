#include <algorithm>
#include <array>
#include <string_view>

#include "io/conflicts/conflict_fields.hpp"
#include "io/conflicts/conflict_summary.hpp"
#include "io/conflicts/json_text.hpp"
#include "io/conflicts/text_conflicts.hpp"
#include "io/formats/text/text_writer.hpp"

namespace clearway {
namespace {

/// A conflict as a JSON object. Corners and centroid are arrays, which replace the fields of their
/// three coordinates.
std::string conflict_json(const Conflict& conflict, const ResultHeader& header) {
  std::string out;
  for (const ConflictField& field : fields_of(conflict, header)) {
    if (field.name.ends_with("_y") || field.name.ends_with("_z")) continue;
    std::string_view name = field.name;
    std::string value = json_value(field.value);
    if (name.ends_with("_x")) {
      name.remove_suffix(2);
      value = json_vector(name == "lo"   ? conflict.box.lo
                          : name == "hi" ? conflict.box.hi
                                         : conflict.centroid);
    }
    out += (out.empty() ? "" : ", ") + json_string(name) + ": " + value;
  }
  return "{" + out + "}";
}

}  // namespace

void write_json(const ConflictFile& conflicts, const File& file) {
  TextWriter out(file);
  out << "{\n" << summary_json(conflicts) << ",\n  \"conflicts\": [";
  const char* between = "\n    ";
  for (const Conflict& conflict : conflicts.conflicts.listed) {
    out << between << conflict_json(conflict, conflicts.header);
    between = ",\n    ";
  }
  out << (conflicts.conflicts.listed.empty() ? "]\n}\n" : "\n  ]\n}\n");
  out.flush();
}

}  // namespace clearway
