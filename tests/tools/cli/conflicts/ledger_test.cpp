// clearway conflicts and check with a ledger, through the built program.
#include <nlohmann/json.hpp>
#include <string>

#include "support/catch.hpp"
#include "tools/cli/conflicts/yard.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

const std::string kLedger =
    " --model box.off --env site.h5 --ledger yard.csv --min-points 3 --date 2026-06-01 ";

Outcome judged(const std::string& options) {
  return yard().conflicts(kLedger + options, "mesh.h5");
}

json ledger_of(const std::string& options) {
  const Outcome outcome = judged("--json " + options);
  require_success(outcome);
  return json::parse(outcome.out)["ledger"];
}

void replace_in_table(const std::string& from, const std::string& to) {
  std::string text = yard().bytes("yard.csv");
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  yard().put("yard.csv", text.replace(at, from.size(), to));
}

}  // namespace

TEST_CASE("a ledger is begun, edited and read, and what it accepts decides about the exit code") {
  check_refused(judged(""), 2, "--update makes it");
  check_outcome(judged("--fail-on-collision"), 2);
  check_outcome(judged("--update --fail-on-collision"), 1);
  CHECK(ledger_of("")["new"] == 1);
  check_outcome(judged("--fail-on-collision"), 1);

  replace_in_table("1,new", "1,accepted");
  const json accepted = ledger_of("");
  CHECK(accepted["accepted"] == 1);
  CHECK(accepted["accepted_conflicts"] == 1);
  CHECK(accepted["rows"][0]["conflicts"] == json::array({1}));
  CHECK(accepted["conflicts"][0]["key"] == "1");
  CHECK(accepted["outside"]["colliding_points"] == 0);
  const Outcome text = judged("--fail-on-collision");
  CHECK_THAT(text.out, Contains("ledger yard.csv: 1 accepted"));
  CHECK_THAT(text.out, Contains("The verdict stays conflict. The ledger accepts the conflict"));
  CHECK(text.exit_code == (accepted["outside"]["verdict"] == "clear" ? 0 : 6));

  const std::string table = yard().bytes("yard.csv");
  check_outcome(judged("--update"), 0);
  CHECK(yard().bytes("yard.csv") == table);

  replace_in_table("accepted,,,", "accepted,,,2026-05-31");
  const json expired = ledger_of("");
  CHECK(expired["expired"] == 1);
  CHECK_THAT(expired["rows"][0]["why"].get<std::string>(), Contains("until 2026-05-31"));
  check_outcome(judged("--fail-on-collision"), 1);

  replace_in_table("accepted", "acepted");
  check_refused(judged(""), 3, "expected new, open, accepted or resolved");
}

TEST_CASE(
    "files of conflicts have what the ledger says, and no text of a user is a formula or markup") {
  const std::string options =
      " --model box.off --env site.h5 --ledger books.csv --min-points 3 --date 2026-06-01 --force ";
  require_success(yard().conflicts(options + "--update", "mesh.h5"));
  std::string table = yard().bytes("books.csv");
  const std::string edit = "1,accepted,=1+1,\"<i>\"\"a, b\"\" & c\",2027-01-01,";
  yard().put("books.csv", table.replace(table.find("1,new,,,,"), 9, edit));
  require_success(
      yard().conflicts(options + "-o l.csv -o l.json -o l.geojson -o l.gpkg -o l.bcf", "mesh.h5"));
  const std::string csv = yard().bytes("l.csv");
  CHECK_THAT(csv,
             Contains(",ledger,ledger_key,ledger_why,ledger_owner,ledger_comment,ledger_until,"));
  CHECK_THAT(csv, Contains(",accepted,1,,\"'=1+1\",\"<i>\"\"a, b\"\" & c\",2027-01-01,"));
  for (const auto& member : {"l.json", "l.geojson"}) {
    const json file = json::parse(yard().bytes(member));
    const json row =
        file.contains("features") ? file["features"][0]["properties"] : file["conflicts"][0];
    CHECK(row["ledger"] == "accepted");
    CHECK(row["ledger_owner"] == "=1+1");
    CHECK(row["ledger_comment"] == "<i>\"a, b\" & c");
    CHECK(row["ledger_why"].is_null());
  }
  const std::string columns =
      run_program_at("/usr/bin/python3", yard().folder,
                     "-c \"import sqlite3; print(sqlite3.connect('l.gpkg').execute('select ledger, "
                     "ledger_key, "
                     "ledger_until from footprints').fetchall())\"")
          .out;
  CHECK(columns == "[('accepted', '1', '2027-01-01')]\n");
  require_success(run_program_at(CHECK_BCF, yard().folder, "l.bcf"));
  const Outcome markup = run_program_at(
      "/usr/bin/python3", yard().folder,
      "-c \"import zipfile; z = zipfile.ZipFile('l.bcf'); print(*[z.read(n).decode() for n in "
      "z.namelist() if n.endswith('markup.bcf')])\"");
  for (const char* words :
       {"TopicStatus=\"Closed\"", "<Labels>accepted</Labels>", "<AssignedTo>=1+1<",
        "By the ledger it is accepted; row 1, until 2027-01-01: &lt;i&gt;"}) {
    CHECK_THAT(markup.out, Contains(words));
  }
}

TEST_CASE("conflicts --fail-on-collision works without a ledger, and --update needs one") {
  check_outcome(yard().conflicts("--fail-on-collision --min-points 3", "plain.h5"), 1);
  check_outcome(yard().conflicts("--update", "plain.h5"), 2);
}
