#include <fstream>
#include <regex>
#include <string>
#include <tuple>
#include <vector>

#include "core/describe/conflict.hpp"
#include "core/describe/shift.hpp"
#include "core/describe/stations.hpp"
#include "core/messages/message_table.hpp"
#include "core/messages/remedies.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/generated_text.hpp"

namespace clearway {
namespace {

using message_table::kMessageKinds;

std::string in_code(std::string_view text) { return "`" + std::string(text) + "`"; }

const char* kind_of(Severities severities) {
  return severities == Severities::kNote      ? "note"
         : severities == Severities::kWarning ? "warning"
                                              : "note or warning";
}

std::string table_of_doubts() {
  std::string text = "| what is in doubt | warnings |\n|---|---|\n";
  for (const auto& [doubt, words] :
       {std::pair(Doubt::kQuestion, "the whole query"),
        std::pair(Doubt::kStretch, "the stretches of the path that the warning names")}) {
    std::string codes;
    for (const MessageKind& kind : kMessageKinds) {
      if (kind.effect.doubt == doubt) codes += (codes.empty() ? "" : ", ") + in_code(kind.code);
    }
    text += std::string("| ") + words + " | " + codes + " |\n";
  }
  return text;
}

/// The words of the command line as a sentence of a table, with the amount in capitals.
std::string sentence_of(const RemedyKind& kind) {
  std::string words(kind.words_with_amount.empty() ? kind.words : kind.words_with_amount);
  words = words.substr(2);
  if (const std::size_t at = words.find("{}"); at != std::string::npos) {
    words.replace(at, 2, kind.amount == RemedyAmount::kBytes ? "BYTES" : "AMOUNT");
  }
  return words;
}

std::string table_of_remedies() {
  std::string text = "| remedy | what the program says |\n|---|---|\n";
  for (const RemedyKind& kind : remedy_table::kRemedies) {
    if (kind.remedy == Remedy::kNone) continue;
    text += "| " + in_code(kind.name) + " | " + sentence_of(kind) + " |\n";
  }
  return text;
}

/// The columns of a table of findings that its files have.
template <typename... Columns>
std::string table_of_columns(const std::tuple<Columns...>& columns) {
  std::string text = "| column | meaning |\n|---|---|\n";
  for_each_field(columns, [&](const auto& column) {
    if (column.use.is_in_files) text += "| " + in_code(column.key) + " | " + column.doc + " |\n";
  });
  return text;
}

}  // namespace

TEST_CASE("the guide says of each message once what it means and whether it is a warning") {
  std::vector<std::string> expected, found;
  for (const MessageKind& kind : kMessageKinds) {
    expected.push_back(in_code(kind.code) + " | " + kind_of(kind.severities));
  }
  std::ifstream page(CLEARWAY_GUIDE "/warnings.md");
  const std::regex row("\\| (`[a-z0-9-]+` \\| (note|warning|note or warning)) \\| .+[.] \\|");
  std::smatch parts;
  for (std::string line; std::getline(page, line);) {
    if (std::regex_match(line, parts, row)) found.push_back(parts[1]);
  }
  test::check_equal(found, expected);
}

TEST_CASE("the guide's table of doubts is what the table of messages says") {
  check_generated(CLEARWAY_GUIDE "/warnings.md", "table of doubts", table_of_doubts());
}

TEST_CASE("the guide's table of remedies is the table of remedies") {
  check_generated(CLEARWAY_GUIDE "/command-line.md", "table of remedies", table_of_remedies());
}

TEST_CASE("the guide's tables of findings are the lists of their columns") {
  const std::string page = CLEARWAY_GUIDE "/results.md";
  check_generated(page, "columns of a conflict", table_of_columns(kConflictColumns));
  check_generated(page, "columns of a shift", table_of_columns(kShiftColumns));
  check_generated(page, "columns of a stretch", table_of_columns(kStationColumns));
}

}  // namespace clearway
