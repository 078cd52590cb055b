// The files of a ledger: what is read and kept of a table, and which pairs of files are refused.
#include "findings/ledger/ledger_table.hpp"

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "findings/ledger/ledger_date.hpp"
#include "findings/ledger/ledger_files.hpp"
#include "findings/ledger_scene.hpp"
#include "support/catch.hpp"
#include "support/change_header.hpp"
#include "support/compare.hpp"
#include "support/text_rows.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const std::string kHeader =
    "key,status,owner,comment,until,x,y,z,size_x,size_y,size_z,side,least,trim,first_seen,"
    "last_seen\n";

std::string with(std::string text, char from, char to) {
  for (char& c : text) c = c == from ? to : c;
  return text;
}

/// The names of files in a folder that `work` makes, writes into or replaces, without those under
/// which files are partial.
template <typename Work>
std::string names_changed(const std::filesystem::path& folder, const Work& work) {
  const int watch = ::inotify_init1(IN_NONBLOCK);
  REQUIRE(::inotify_add_watch(watch, folder.c_str(), IN_CREATE | IN_MODIFY | IN_MOVED_TO) >= 0);
  work();
  std::string out;
  alignas(inotify_event) std::array<char, 65536> events{};
  const ssize_t end = ::read(watch, events.data(), events.size());
  for (ssize_t at = 0; at < end;) {
    const auto* event = reinterpret_cast<const inotify_event*>(events.data() + at);
    const std::string name = event->name;
    if (!name.ends_with(".partial")) out += name + " ";
    at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
  }
  ::close(watch);
  return out;
}

RoadScan one_panel() { return road().add(panel(10, 0.95)); }
RoadScan two_panels() { return one_panel().add(panel(15, 0.95)); }

/// A ledger of one panel.
struct Begun : LedgerScene {
  Begun() { update(one_panel()); }
  Ledger update(const RoadScan& scan) { return run(scan, RoadQuestion()); }
};

void check_update_refused(Begun& scene, const std::string& words) {
  check_refused<InputError>([&] { scene.update(one_panel()); }, words);
}

}  // namespace

TEST_CASE("days are read in the forms of spreadsheets, and ambiguous ones as the earlier day") {
  for (const auto& row : text_rows(R"(
    2026-06-30 | 2026-06-30
    2026-6-3   | 2026-06-03
    2026-06-30T12:00:00Z | 2026-06-30
    2026/06/30 | 2026-06-30
    30.06.2026 | 2026-06-30
    3.6.26     | 2026-06-03
    30/06/2026 | 2026-06-30
    06/30/2026 | 2026-06-30
    07/06/2026 | 2026-06-07
    05/05/2026 | 2026-05-05
    30-06-2026 | 2026-06-30
    30-06-26   |
    2026.06.30 |
    31.06.2026 |
    13/13/2026 |
    2026-02-29 |
    soon       |
    46203      |
               |
  )")) {
    const RowName name(row[0]);
    for (const std::string& text : {row[0], " " + row[0] + " "}) {
      const auto read = day_of(text);
      check_equal(read ? text_of(read->day) : "", row[1]);
    }
  }
}

TEST_CASE("a table of a spreadsheet is kept byte for byte, except for the cells that change") {
  const std::string row =
      "1,open,\"Miller, Ann\",\"says \"\"no, never\"\", twice: "
      "\"\"no\"\"\",,1.0,2,3,0,0,0,left,,0.1,";
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const std::string& mark : {std::string(), std::string("\xEF\xBB\xBF")}) {
      std::string text;
      for (const char c : mark + kHeader + row + "2026-01-05,2026-01-06\n\n") {
        text += c == '\n' ? end : std::string(1, c);
      }
      LedgerTable table(text, "L.csv");
      REQUIRE(table.rows() == 1);
      CHECK(table.text() == text);
      CHECK(table.get(0, LedgerColumn::kOwner) == "Miller, Ann");
      CHECK(table.get(0, LedgerColumn::kComment) == "says \"no, never\", twice: \"no\"");
      table.set(0, LedgerColumn::kX, 1.0, 3);  // says the same
      CHECK(table.text() == text);
      table.set(0, LedgerColumn::kStatus, std::string("accepted"));
      std::string changed = text;
      changed.replace(changed.find("open"), 4, "accepted");
      CHECK(table.text() == changed);
    }
  }
}

TEST_CASE("semicolons, decimal commas and the form of days are kept, and further columns stay") {
  const std::string header = with(kHeader, ',', ';');
  const std::string text = "Link;" + header.substr(0, header.size() - 1) + ";Foto\n" +
                           "a;1;open;;;;1,5;2,25;3;0;0;0;left;;0,1;05.01.2026;06.01.2026;x.jpg\n";
  LedgerTable table(text, "L.csv");
  CHECK(table.text() == text);
  CHECK(table.number(0, LedgerColumn::kY) == std::optional(2.25));
  CHECK(table.day(0, LedgerColumn::kLastSeen) == std::optional(Day{2026, 1, 6}));
  table.set(0, LedgerColumn::kLastSeen, Day{2026, 6, 30});
  const std::size_t row = table.add_row();
  table.set(row, LedgerColumn::kStatus, std::string("new"));
  table.set(row, LedgerColumn::kX, 7.125, 3);
  CHECK(table.text() == "Link;" + header.substr(0, header.size() - 1) + ";Foto\n" +
                            "a;1;open;;;;1,5;2,25;3;0;0;0;left;;0,1;05.01.2026;30.06.2026;x.jpg\n"
                            ";2;new;;;;7,125;;;;;;;;;;;\n");
}

TEST_CASE("a table that is none of a ledger is refused with line and column") {
  const std::string cells = ",,,,1,2,3,0,0,0,left,,0.1,2026-01-05,2026-01-06\n";
  const std::pair<std::string, const char*> rows[] = {
      {"", "is empty"},
      {"a,b\n", "line 1: lacks the column key"},
      {with(kHeader, 'z', 'x'), "line 1: "},
      {kHeader + "1,acepted" + cells, "line 2: status \"acepted\": expected new, open, accepted"},
      {kHeader + "1," + cells, "line 2: status \"\""},
      {kHeader + "1,open" + cells + "1,open" + cells, "line 3: key \"1\": another row"},
      {kHeader + "1,open,,,soon,1,2,3,0,0,0,left,,,,\n", "line 2: until \"soon\""},
      {kHeader + "1,open" + cells.substr(0, cells.size() - 1) + ",more\n", "line 2: has 17 cells"},
      {kHeader + "1,open,\"cut", "a quote is not closed"},
      {"\xFF\xFEk", "UTF-16"},
      {"PK\x03\x04", "spreadsheets"}};
  for (const auto& [text, words] : rows) {
    check_refused<InputError>([&] { LedgerTable(text, "L.csv"); }, words);
  }
}

TEST_CASE("a ledger without its places accepts nothing") {
  Begun scene;
  scene.set("status", "accepted");
  std::filesystem::remove(scene.places());
  const Ledger ledger = scene.run(one_panel(), RoadQuestion(), false);
  CHECK(counts_of(ledger) == "new 1, not-searched 1");
  CHECK(ledger.outside.verdict == Verdict::kConflict);
}

TEST_CASE("a row that somebody wrote by hand accepts nothing, and stays") {
  Begun scene;
  scene.set("status", "open");
  scene.write(scene.text() + "by hand,accepted,me,the pole at the gate,,,,,,,,,,,,\n");
  const Ledger ledger = scene.update(one_panel());
  CHECK(counts_of(ledger) == "open 1, not-searched 1");
  CHECK_THAT(scene.text(), Contains("by hand,accepted,me,the pole at the gate"));
}

TEST_CASE("table and places of different runs are refused, and nothing is changed") {
  Begun scene;
  const std::string first = scene.text();
  const auto kept = scene.folder / "kept.h5";
  std::filesystem::copy_file(scene.places(), kept);
  scene.update(two_panels());
  const std::string second = scene.text();

  SECTION("the table of the run before") { scene.write(first); }
  SECTION("the places of the run before") {
    std::filesystem::remove(scene.places());
    std::filesystem::copy_file(kept, scene.places());
  }
  SECTION("a row was deleted") {
    scene.write(second.substr(0, second.rfind('\n', second.size() - 2) + 1));
  }
  SECTION("a place was changed") { scene.set("x", "11.5", 0); }
  const std::string before = scene.text();
  check_update_refused(scene, "are of different runs");
  CHECK(scene.text() == before);
}

TEST_CASE("sorted rows and changed cells of people are no other run") {
  Begun scene;
  scene.update(two_panels());
  scene.set("owner", "me");
  scene.set("status", "accepted", 0);
  std::string text = scene.text();
  const std::size_t line = text.find('\n') + 1, next = text.find('\n', line) + 1;
  text = text.substr(0, line) + text.substr(next) + text.substr(line, next - line);
  scene.write(text);
  CHECK(counts_of(scene.update(two_panels())) == "new 1, accepted 1");
  CHECK(scene.text() == text);
}

TEST_CASE("an update replaces the places, then the table, and between them it can be completed") {
  Begun scene;
  const std::string old_table = scene.text();
  scene.update(two_panels());
  const LedgerFiles files = read_ledger(scene.table(), "m");
  check_equal(names_changed(scene.folder.folder(),
                            [&] { LedgerUpdate(scene.table()).publish(files, "m"); }),
              "L.places.h5 L.csv ");
  for (const bool is_first : {false, true}) {
    std::filesystem::rename(scene.table(), scene.folder / "L.csv.partial");
    if (!is_first) scene.write(old_table);
    check_update_refused(scene, "an update was interrupted ... L.csv.partial: rename it to L.csv");
    std::filesystem::rename(scene.folder / "L.csv.partial", scene.table());
    check_equal(read_ledger(scene.table(), "m").places.size(), 2);
  }
}

TEST_CASE("a table whose places are left alone is not begun anew") {
  Begun scene;
  std::filesystem::remove(scene.table());
  check_update_refused(scene, "is missing, and its places are there");
}

TEST_CASE("a link to a table is the table itself, with the places beside it") {
  Begun scene;
  scene.set("status", "accepted");
  const auto real = scene.folder / "kept.csv";
  std::filesystem::rename(scene.table(), real);
  std::filesystem::rename(scene.places(), scene.folder / "kept.places.h5");
  std::filesystem::create_symlink(real, scene.table());
  CHECK(counts_of(scene.update(one_panel())) == "accepted 1");
  CHECK(std::filesystem::is_symlink(scene.table()));
  CHECK_FALSE(std::filesystem::exists(scene.places()));
}

TEST_CASE("an update waits for that of another process, and says so where it takes too long") {
  Begun scene;
  std::optional<LedgerUpdate> other(std::in_place, scene.table());
  constexpr std::chrono::milliseconds kBrief(60);
  CHECK_THROWS_WITH(LedgerUpdate(scene.table(), nullptr, kBrief),
                    Contains("L.csv: another process is updating this ledger"));
  std::thread ending([&] {
    std::this_thread::sleep_for(kBrief);
    other.reset();
  });
  scene.update(one_panel());
  ending.join();
  CHECK_FALSE(std::filesystem::exists(scene.folder / "L.csv.partial"));
  CHECK_FALSE(std::filesystem::exists(scene.folder / "L.places.h5.partial"));
}

TEST_CASE("damaged places are refused") {
  Begun scene;
  std::string bytes = text_of_file(scene.places());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(scene.places(), bytes);
  CHECK_THROWS_AS(scene.update(one_panel()), InputError);
}

TEST_CASE("places whose columns contradict each other are refused, though their hashes are right") {
  Begun scene;
  const std::string bytes = text_of_file(scene.places());
  for (const char* column : {"keys", "key_bytes", "numbers", "counts", "places"}) {
    INFO(column);
    write_text(scene.places(), bytes);
    const std::string values = OpenDataset(open_to_change(scene.places()), column).bytes();
    const std::size_t row = OpenDataset(open_to_change(scene.places()), column).row_bytes();
    change_column(scene.places(), column, values.substr(row));
    check_update_refused(scene, "the sizes of its columns contradict each other");
  }
}
