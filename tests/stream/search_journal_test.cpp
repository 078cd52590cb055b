#include "stream/search_journal.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>

#include "clearway/error.hpp"
#include "cpu/sweep_engine.hpp"
#include "planned_scene.hpp"
#include "stream/run_pages.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/answer_sets.hpp"
#include "support/file_size_limit.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const JournalIdentity kIdentity{{"query", "a test"}};
constexpr double kNever = 1e9;  // seconds

/// Asks to stop after a given number of calls of advance().
class StoppingProgress final : public Progress {
 public:
  explicit StoppingProgress(std::uint64_t most) : most_(most) {}
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override { ++calls; }
  void end() override {}
  bool stop_requested() const override { return calls >= most_; }

  std::atomic<std::uint64_t> calls{0};

 private:
  std::uint64_t most_;
};

constexpr auto kNoStop = std::numeric_limits<std::uint64_t>::max();

/// One query, answered with a journal from run to run.
class JournalledScene {
 public:
  JournalledScene(bool first_pose, double clearance, double profile = 0)
      : scene({64, 0}, 9000, 150, first_pose, clearance, profile) {}

  /// Runs the sweep, from the journal where there is one, until the progress asks to stop or the
  /// search is done.
  std::optional<SearchResult> sweep(std::uint64_t most_pages) {
    std::optional<JournalReader> read;
    if (is_journal(path)) read.emplace(path);
    SearchJournal journal = opened(read ? &*read : nullptr);
    StoppingProgress progress(most_pages);
    ProfileSet profile = empty_result(scene.cloud, scene.query).profile;
    if (scene.query.profile > 0) journal.restore(profile);
    std::optional<SearchResult> answer;
    try {
      run_journalled(journal, profile, progress);
      answer = result_of(journal.rows(), scene.cloud, std::move(profile));
    } catch (const Interrupted&) {
    }
    begun += progress.calls;
    return answer;
  }

  SearchJournal opened(const JournalReader* read = nullptr) const {
    return {path, kIdentity, read, scene.cloud, scene.query, kNever};
  }

  /// Searches the cells that the journal does not have.
  void run_journalled(SearchJournal& journal, ProfileSet& profile, Progress& progress) const {
    std::vector<PlannedCell> cells = scene.cells;
    std::erase_if(cells, [&](const PlannedCell& cell) {
      return journal.rows().answered(cell.cell, PointQuestion::kHits);
    });
    const SlotLayout layout{3, smallest_page_bytes(scene.cloud, scene.cells), 1};
    SweepEngine engine(scene.cloud, scene.filter, layout);
    PageEngine* const engines[] = {&engine};
    StageTimes times;
    const auto pages = paginate(scene.cloud, cells, layout.page_bytes, 1);
    run_pages(scene.cloud, cells, pages, engines, {.threads = 2},
              keep_answer(scene.cloud, journal.rows(), profile, &journal), progress, times);
  }

  PlannedScene scene;
  ScratchFolder folder;
  std::filesystem::path path = folder / "a.journal";
  std::uint64_t begun = 0;  ///< calls of advance() over all runs
};

/// The cells whose colliding points a journal holds.
std::uint64_t hits_in(const std::filesystem::path& path) {
  return answered_cells(JournalReader(path))[index_of(PointQuestion::kHits)];
}

/// Writes a journal with one record of these bytes, and opens it for the scene.
void open_with(const JournalledScene& s, const std::string& bytes) {
  std::filesystem::remove(s.path);
  {
    JournalWriter writer = JournalWriter::create(s.path, kIdentity, kNever);
    JournalRecord record;
    for (const char byte : bytes) record.put(byte);
    writer.append(record);
  }
  const JournalReader read(s.path);
  s.opened(&read);
}

}  // namespace

TEST_CASE("a sweep stopped again and again gives the answer of one that was not") {
  for (const bool first_pose : {false, true}) {
    for (const double clearance : {0.0, 0.3}) {
      const double profile = first_pose ? 0 : 0.5 - clearance;
      CAPTURE(first_pose, clearance, profile);
      JournalledScene s(first_pose, clearance, profile);
      REQUIRE(s.scene.expected.colliding() > 100);
      std::optional<SearchResult> answer;
      int runs = 0;
      while (!answer) {
        answer = s.sweep(5);
        REQUIRE(++runs < 200);
      }
      CHECK(runs > 5);
      CHECK(s.begun == s.scene.cells.size());  // no cell was searched twice
      check_equal(s.scene.wrong(*answer), 0);
      CHECK((answer->profile.count() > 50) == (profile > 0));
      check_equal(s.scene.wrong(s.sweep(0).value()), 0);  // nothing is left to do
      CHECK(hits_in(s.path) == s.scene.cells.size());
    }
  }
}

TEST_CASE("a sweep with a profile goes on from a journal cut at any record") {
  JournalledScene s(false, 0, 0.4);
  s.sweep(kNoStop);
  const std::string whole = bytes_of(s.path);
  std::uint64_t finished = 0;
  for (std::size_t bytes = whole.size(); bytes > 200; bytes -= whole.size() / 40) {
    put_bytes(s.path, whole.substr(0, bytes));
    finished += hits_in(s.path);
    check_equal(s.scene.wrong(s.sweep(kNoStop).value()), 0);
  }
  CHECK(finished > 100);
}

TEST_CASE("records that are not of the cloud and the query are refused") {
  const JournalledScene set(false, 0), poses(true, 0), clearances(false, 0.3);
  const JournalledScene profile(false, 0, 0.5);
  const std::string bits("\1\0\0\0\0\0\0\0", 8), none(8, '\0'), pose("\5\0\0\0", 4);
  const std::string hits_of_cell0("\1\1\0\0", 4);  // a cell, one question, the hits, cell 0
  const std::string word0("\1\0", 2);              // one word, the first
  const std::string cell0 = hits_of_cell0 + word0;
  // Cell 0 with two questions: no hits, and a clearance
  const std::string clearance = std::string("\1\2\0\1\0\0", 6) + word0 + bits + pose;
  const auto distance = [](double squared) {
    return std::string(reinterpret_cast<const char*>(&squared), sizeof squared);
  };
  CHECK_NOTHROW(open_with(set, cell0 + bits));
  CHECK_NOTHROW(open_with(poses, cell0 + bits + pose));
  CHECK_NOTHROW(open_with(clearances, clearance + distance(0.01)));
  CHECK_NOTHROW(open_with(profile, "\2\1\5" + distance(0.01) + '\7'));
  struct Row {
    const JournalledScene& scene;
    std::string bytes, words;
  };
  std::vector<Row> rows{
      {set, "", "ends too early"},
      {set, "\7", "unknown kind"},
      {set, cell0 + none, "points that the store does not have"},
      {set, cell0 + bits + "x", "longer than what it holds"},
      {set, cell0 + bits.substr(1), "ends too early"},
      {set, {"\1\1\0\xff\xff\x7f\0", 7}, "a cell that the store does not have"},
      {set, {"\1\1\1\0\0", 5}, "a question that was not asked"},
      {set, {"\1\1\x20\0\0", 5}, "a question that is unknown"},
      {set, {"\1\x20", 2}, "more questions than there are"},
      {set, hits_of_cell0 + std::string("\1\1", 2) + bits, "a block past its cell's end"},
      {set, hits_of_cell0 + std::string("\2\0", 2) + bits + '\0' + bits,
       "a block past its cell's end"},
      {poses, cell0 + bits + std::string("\xff\x7f\0\0", 4), "a pose past the trajectory's end"},
      {profile, "\2\1\5" + distance(0.25) + '\7', "a distance that is none"},
      {profile, "\2\2\5" + distance(0.01) + '\7', "ends too early"},
      {profile, "\2\1\xff\x7f" + distance(0.01) + '\7', "a pose past the trajectory's end"},
      {profile, "\2\1\5" + distance(0.01) + "\xff\xff\x7f", "a point that the store does not have"},
      {set, "\2\1\5" + distance(0.01) + '\7', "of a profile that was not asked for"}};
  using Limits = std::numeric_limits<double>;
  for (const double squared : {-1.0, Limits::quiet_NaN(), Limits::infinity()}) {
    rows.push_back({clearances, clearance + distance(squared), "a distance that is none"});
    rows.push_back({profile, "\2\1\5" + distance(squared) + '\7', "a distance that is none"});
  }
  for (const Row& row : rows) {
    check_refused([&] { open_with(row.scene, row.bytes); }, "record 1 at byte ... " + row.words);
  }
}

TEST_CASE("a cell without hits costs a few bytes") {
  const JournalledScene s(true, 0.3);
  const std::uint64_t empty = [&] {
    JournalWriter::create(s.path, kIdentity, kNever);
    return std::filesystem::file_size(s.path);
  }();
  std::filesystem::remove(s.path);
  {
    SearchJournal journal = s.opened();
    const CellRows none{.words = std::vector<std::uint64_t>(s.scene.cloud.blocks_per_cell())};
    journal.rows().add(1, {{PointQuestion::kHits, none}, {PointQuestion::kClearances, none}});
  }
  CHECK(std::filesystem::file_size(s.path) <= empty + 32 + 8);
}

TEST_CASE("a journal that cannot grow ends the run with its error") {
  const JournalledScene s(false, 0);
  SearchJournal journal = s.opened();
  ProfileSet none;
  NoProgress progress;
  {
    const FileSizeLimit limit(300);
    check_refused([&] { s.run_journalled(journal, none, progress); }, "a.journal: cannot write");
  }
  const JournalReader read(s.path);  // the record that was cut off is a torn tail
  CHECK(read.records() > 0);
  CHECK(read.records() < s.scene.cells.size());
  CHECK_FALSE(read.torn().empty());
}

TEST_CASE("rows are read back from the journal, and a record that changes meanwhile is named") {
  const JournalledScene s(true, 0.3);
  SearchJournal journal = s.opened();
  ProfileSet none;
  NoProgress progress;
  s.run_journalled(journal, none, progress);
  const AnswerRows& rows = journal.rows();
  const auto count = [&](PointQuestion question) {
    std::uint64_t points = 0;
    for (const std::uint32_t cell : rows.cells(question))
      points += rows.read(cell, question).count();
    return points;
  };
  for (const PointQuestion question : {PointQuestion::kHits, PointQuestion::kClearances}) {
    CHECK(rows.points(question) > 100);
    CHECK(count(question) == rows.points(question));
  }
  CHECK(rows.read(0, PointQuestion::kNear).count() == 0);  // was not asked
  std::string bytes = bytes_of(s.path);
  // The order of the records differs from run to run, so that all of a half are changed.
  for (std::size_t at = bytes.size() / 2; at < bytes.size(); at += 8) bytes[at] ^= 1;
  put_bytes(s.path, bytes);
  check_refused([&] { return count(PointQuestion::kHits) + count(PointQuestion::kClearances); },
                "a.journal: the record at byte ... was changed");
}

TEST_CASE("rows in memory ask for memory, and stop where there is none") {
  const JournalledScene s(true, 0);
  std::uint64_t taken = 0;
  RowsInMemory kept([&](std::uint64_t bytes) {
    if (bytes > 1000) throw ResourceError("no more");
    taken = bytes;
  });
  AnswerRows rows(s.scene.cloud, s.scene.query, kept);
  const CellRows found{.words = {5}, .poses = {7, 3}};
  std::uint32_t cell = 0;
  CHECK_THROWS_WITH(
      [&] {
        for (;; ++cell) rows.add(cell, {{PointQuestion::kHits, found}});
      }(),
      "no more");
  CHECK(cell > 10);
  CHECK(kept.allocated_bytes() == taken);
  CHECK_FALSE(rows.answered(cell, PointQuestion::kHits));
  CHECK(rows.points(PointQuestion::kHits) == 2 * cell);
  const CellRows again = rows.read(cell - 1, PointQuestion::kHits);
  CHECK(again.words == found.words);
  CHECK(again.poses == found.poses);
}
