#include "findings/ledger/ledger_files.hpp"

#include <chrono>
#include <cmath>
#include <map>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_writer.hpp"

namespace clearway {
namespace {

/// Spreadsheets may round what the table has with three digits, but no more than that.
constexpr double kCellRounding = 0.0015;

bool is_about(std::optional<double> cell, double number) {
  return cell && std::abs(*cell - number) <= kCellRounding;
}

/// Whether a cell says this day, in whichever order of day and month.
bool may_be(const std::optional<Day>& cell, const Day& day) {
  return cell == std::optional(day) ||
         (cell && cell->year == day.year && cell->month == day.day && cell->day == day.month);
}

/// Whether a row was written together with these places.
bool agree(const LedgerTable& table, std::size_t row, const LedgerPlaces& places) {
  const LedgerCells& cells = places.cells;
  using enum LedgerColumn;
  constexpr std::array kMiddle{kX, kY, kZ}, kSize{kSizeX, kSizeY, kSizeZ};
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (!is_about(table.number(row, kMiddle[axis]), cells.middle[k])) return false;
    if (!is_about(table.number(row, kSize[axis]), cells.size[k])) return false;
  }
  return may_be(table.day(row, kFirstSeen), cells.first_seen) &&
         may_be(table.day(row, kLastSeen), cells.last_seen);
}

/// A row that somebody wrote by hand: it has no place.
bool is_by_hand(const LedgerTable& table, std::size_t row) {
  return !table.number(row, LedgerColumn::kX);
}

/// Gives the rows their places. Returns what contradicts the table; empty where nothing does.
std::string join(LedgerFiles& files, std::vector<LedgerPlaces> all) {
  std::map<std::string, LedgerPlaces, std::less<>> of_key;
  for (LedgerPlaces& row : all) {
    std::string key = row.key;
    of_key.emplace(std::move(key), std::move(row));
  }
  files.places.resize(files.table.rows());
  for (std::size_t row = 0; row < files.table.rows(); ++row) {
    const std::string key = files.table.get(row, LedgerColumn::kKey);
    const auto found = of_key.find(key);
    if (found == of_key.end()) {
      if (is_by_hand(files.table, row)) continue;
      return "the places lack the row " + key;
    }
    if (!agree(files.table, row, found->second)) return "the row " + key + " has other values";
    files.places[row] = std::move(found->second);
    of_key.erase(found);
  }
  if (of_key.empty()) return "";
  return "the table lacks the row " + of_key.begin()->first;
}

std::filesystem::path partial_of(const std::filesystem::path& path) {
  std::filesystem::path out = path;
  return out += ".partial";
}

/// Whether the table under its partial name belongs to the places, because an update was killed
/// when it had renamed only one of its files.
bool partial_agrees(const std::filesystem::path& table, const std::vector<LedgerPlaces>& places) {
  try {
    const std::filesystem::path partial = partial_of(table);
    LedgerFiles files{LedgerTable(text_of_file(partial), partial.string()), {}};
    return join(files, places).empty();
  } catch (const Error&) {
    return false;
  }
}

std::string advice_to_complete(const std::filesystem::path& table) {
  return "an update was interrupted. The new table is complete in " + partial_of(table).string() +
         ": rename it to " + table.filename().string();
}

/// Whether a process that lives is writing the ledger.
bool is_being_written(const std::filesystem::path& table) {
  try {
    return lock_state(File::open_for_reading(partial_of(table))) == LockState::kHeld;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::string advice_on_missing_table(const std::filesystem::path& table, const std::string& unit) {
  return partial_agrees(table, read_places(places_of(table), unit))
             ? advice_to_complete(table)
             : "restore the table, or remove the places to begin a new ledger";
}

bool wait_for_update(const std::filesystem::path& table, int& waits) {
  constexpr int kMostWaits = 500;
  constexpr std::chrono::milliseconds kWait(20);
  if (waits == kMostWaits || !is_being_written(table)) return false;
  ++waits;
  std::this_thread::sleep_for(kWait);
  return true;
}

LedgerFiles read_ledger(const std::filesystem::path& table, const std::string& unit) {
  const std::filesystem::path beside = places_of(table);
  LedgerFiles files;
  std::vector<LedgerPlaces> places;
  std::string difference;
  for (int waits = 0;;) {
    const std::string text = text_of_file(table);
    files = {LedgerTable(text, table.string()), {}};
    std::error_code unknown;
    if (!std::filesystem::exists(beside, unknown)) {
      files.places.resize(files.table.rows());
      return files;
    }
    places = read_places(beside, unit);
    difference = join(files, places);
    if (difference.empty()) return files;
    // The files are replaced one after the other, so a reader may meet one of each.
    if (!wait_for_update(table, waits) && text_of_file(table) == text) break;
  }
  std::string advice =
      "restore both files as one run wrote them; a row that is done stays with "
      "the status resolved. Without " +
      beside.string() + " the ledger accepts nothing";
  if (partial_agrees(table, places)) advice = advice_to_complete(table);
  throw InputError(table.string() + " and " + beside.string() +
                   ": are of different runs, because " + difference + "; " + advice);
}

namespace {

/// Waits as long as another process is writing the ledger, until a moment at the latest.
void wait_for_others(const std::filesystem::path& table, Progress* progress,
                     std::chrono::steady_clock::time_point until) {
  constexpr std::chrono::milliseconds kPause(50);
  if (!is_being_written(table)) return;
  if (progress != nullptr) progress->begin("wait for another update of the ledger", 0, "");
  while (is_being_written(table)) {
    if (progress != nullptr) throw_if_stopped(*progress);
    if (std::chrono::steady_clock::now() >= until) {
      throw ResourceError(table.string() +
                          ": another process is updating this ledger and has not ended yet; give "
                          "the command again once it has");
    }
    std::this_thread::sleep_for(kPause);
  }
  if (progress != nullptr) progress->end();
}

}  // namespace

LedgerUpdate::LedgerUpdate(const std::filesystem::path& table, Progress* progress,
                           std::chrono::milliseconds most_wait)
    : path_(table) {
  const auto until = std::chrono::steady_clock::now() + most_wait;
  for (;;) {
    wait_for_others(table, progress, until);
    try {
      table_.emplace(table, true);
      places_.emplace(places_of(table), true);
      return;
    } catch (const ResourceError&) {
      table_.reset();
      if (!is_being_written(table)) throw;  // no other process came first
    }
  }
}

void LedgerUpdate::publish(const LedgerFiles& files, const std::string& unit) {
  std::vector<LedgerPlaces> places;
  for (std::size_t row = 0; row < files.places.size(); ++row) {
    if (files.places[row]) places.push_back(*files.places[row]);
  }
  write_places(places_->partial(), places, unit);
  {
    const File file = File::create(table_->partial());
    TextWriter out(file);
    out << files.table.text();
    out.flush();
  }
  table_->sync();
  places_->publish();
  table_->publish();
}

}  // namespace clearway
