#include "findings/ledger/judge_ledger.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "core/util/format.hpp"
#include "findings/grouped_points.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

/// Nothing farther from the places of a row than this belongs to it, metres.
constexpr double kFarthest = 0.3;

/// Changes of the values of a conflict up to this are roundings, metres.
constexpr double kChangeRounding = 1e-6;

/// Which of several statuses counts: the strictest.
int strictness(LedgerStatus status) {
  using enum LedgerStatus;
  constexpr std::array kFromStrictest{kWorse, kExpired, kOpen, kNew};
  return static_cast<int>(kFromStrictest.end() - std::ranges::find(kFromStrictest, status));
}

/// A row as far as matching needs it.
struct MatchedRow {
  const LedgerPlaces* places = nullptr;  ///< null without places
  Box box{};                             ///< around the places
  std::optional<Places> limit;           ///< finds the points that may belong to it
  std::optional<Places> gap;             ///< finds the points within its gap
};

/// What judges a conflict by a row that it belongs to.
struct RowVerdict {
  LedgerStatus status = LedgerStatus::kNew;
  std::string why;
};

class LedgerJudge {
 public:
  LedgerJudge(const GroupedResult& found, const LedgerFiles& files, const LedgerJudging& how)
      : found_(found),
        files_(files),
        how_(how),
        unit_(symbol_of(unit_of(found.result.reader().header()))),
        question_(question_of(found.result.reader().header())),
        scanned_(day_of_scan(found.result.reader().findings().scanned.last)) {
    for (const auto& places : files.places) rows_.push_back(row_of(places));
  }

  Ledger run() {
    match();
    Ledger out;
    out.date = text_of(how_.today);
    for (const Conflict& conflict : found_.conflicts.listed) {
      out.conflicts.emplace_back().conflict = conflict.id;
    }
    for (std::size_t row = 0; row < rows_.size(); ++row) out.rows.push_back(shown_row(row));
    judge_conflicts(out);
    judge_rows_without_conflict(out);
    return out;
  }

 private:
  MatchedRow row_of(const std::optional<LedgerPlaces>& places) const {
    MatchedRow row;
    if (!places || places->quanta.empty()) return row;
    row.places = &*places;
    row.limit.emplace(std::min(places->gap, kFarthest * how_.metre), 0.0);
    row.gap.emplace(places->gap);
    row.box = {places->place(0), places->place(0)};
    for (std::size_t i = 0; i < places->quanta.size(); ++i) {
      const Vec3 p = places->place(i);
      row.box.extend(p);
      row.limit->add({p, 1});
      row.gap->add({p, 1});
    }
    return row;
  }

  /// Finds the rows that each conflict belongs to, because they have a place near every point of
  /// it.
  void match() {
    rows_of_.resize(found_.conflicts.listed.size() + 1);
    for (const Conflict& conflict : found_.conflicts.listed) {
      for (std::size_t row = 0; row < rows_.size(); ++row) {
        if (rows_[row].places == nullptr) continue;
        const Box reach = rows_[row].box.grown(kFarthest * how_.metre + Places::kRounding);
        if (reach.contains(conflict.box.lo) && reach.contains(conflict.box.hi)) {
          rows_of_[conflict.id].push_back(row);
        }
      }
    }
    for_each_point(found_, [&](const PointRow& point) {
      std::erase_if(rows_of_[point.conflict],
                    [&](std::size_t row) { return !rows_[row].limit->near(point.xyz); });
    });
    rows_of_[0].clear();
  }

  LedgerRow shown_row(std::size_t row) const {
    const LedgerTable& table = files_.table;
    using enum LedgerColumn;
    LedgerRow out;
    out.key = table.get(row, kKey);
    out.status = out.shown = table.status(row);
    out.owner = table.get(row, kOwner);
    out.comment = table.get(row, kComment);
    out.until = table.get(row, kUntil);
    const auto day = [&](LedgerColumn column) {
      const auto read = table.day(row, column);
      return read ? text_of(*read) : std::string();
    };
    out.first_seen = day(kFirstSeen);
    out.last_seen = day(kLastSeen);
    if (rows_[row].places != nullptr) out.box = rows_[row].box;
    return out;
  }

  void judge_conflicts(Ledger& out) const {
    for (const Conflict& conflict : found_.conflicts.listed) {
      LedgerEntry& entry = out.conflicts[conflict.id - 1];
      bool is_first = true;
      for (const std::size_t row : rows_of_[conflict.id]) {
        LedgerRow& shown = out.rows[row];
        const RowVerdict verdict = judge(conflict, row);
        const bool is_first_of_row = shown.conflicts.empty();
        shown.conflicts.push_back(conflict.id);
        if (is_first_of_row || strictness(verdict.status) > strictness(shown.shown)) {
          shown.shown = verdict.status;
          shown.why = verdict.why;
        }
        if (is_first || strictness(verdict.status) > strictness(entry.status)) {
          entry.status = verdict.status;
          entry.why = verdict.why;
          entry.key = shown.key;
          entry.owner = shown.owner;
          entry.comment = shown.comment;
          entry.until = shown.until;
        }
        is_first = false;
      }
    }
  }

  RowVerdict judge(const Conflict& conflict, std::size_t row) const {
    switch (files_.table.status(row)) {
      case LedgerStatus::kNew:
        return {LedgerStatus::kNew, ""};
      case LedgerStatus::kResolved:
        return {LedgerStatus::kOpen, "it was resolved, and collides again"};
      case LedgerStatus::kAccepted:
        break;
      default:
        return {LedgerStatus::kOpen, ""};
    }
    const std::string worse = why_worse(conflict, *rows_[row].places);
    if (!worse.empty()) return {LedgerStatus::kWorse, worse};
    const std::optional<Day> until = files_.table.day(row, LedgerColumn::kUntil);
    if (until && how_.today > *until) {
      return {LedgerStatus::kExpired, "it was accepted until " + text_of(*until)};
    }
    return {LedgerStatus::kAccepted, ""};
  }

  /// Why a conflict is worse than its row was when it was accepted; empty where it is not.
  std::string why_worse(const Conflict& conflict, const LedgerPlaces& row) const {
    const LedgerQuestion& then = row.question;
    if (question_.model_hash != then.model_hash) return "the model is another one";
    if (question_.floor != then.floor || question_.floors_hash != then.floors_hash) {
      return "the floor is another one";
    }
    if (question_.radius > then.radius) return "the radius is larger";
    if (question_.reach > then.reach) return "the error budget reaches farther";
    const LedgerValues now = values_of(conflict);
    const double more = how_.worse_by + kChangeRounding * how_.metre;
    if (row.values.least) {
      if (!now.least) return "its least distance is not known any more";
      if (*now.least < *row.values.least - more) {
        return change("its least distance", *row.values.least, *now.least);
      }
    }
    if (now.shift() > row.values.shift() + more) {
      return change("the shift that its own points need", row.values.shift(), now.shift());
    }
    constexpr std::array kTrims{"the trim on the left", "the trim on the right",
                                "the trim from above", "the trim from below"};
    for (std::size_t i = 0; i < kTrims.size(); ++i) {
      if (now.trims[i] > row.values.trims[i] + more) {
        return change(kTrims[i], row.values.trims[i], now.trims[i]);
      }
    }
    return "";
  }

  std::string change(const char* what, double then, double now) const {
    const auto length = [&](double value) { return format_digits(value, 4) + " " + unit_; };
    return what + (" was " + length(then)) +
           (std::isinf(now) ? ", and none is known now" : " and is " + length(now));
  }

  /// The conflicts of which points lie within the gap of a row's places; 0 for small groups.
  using Contacts = std::set<std::uint32_t>;

  void judge_rows_without_conflict(Ledger& out) const {
    std::vector<std::size_t> open;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      LedgerRow& shown = out.rows[row];
      if (!shown.conflicts.empty() || is_resolved_before(row)) continue;
      if (rows_[row].places == nullptr) {
        shown.shown = LedgerStatus::kNotSearched;
        shown.why = "the ledger does not have its places";
        continue;
      }
      open.push_back(row);
    }
    const std::vector<Contacts> contacts = contacts_of(open);
    std::vector<std::size_t> alone;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (contacts[i].empty()) {
        alone.push_back(open[i]);
      } else {
        name(contacts[i], out.rows[open[i]], out);
      }
    }
    if (alone.empty()) return;
    std::vector<const LedgerPlaces*> places;
    for (const std::size_t row : alone) places.push_back(rows_[row].places);
    const std::vector<std::string> reasons = how_.why_not_gone(places);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      LedgerRow& shown = out.rows[alone[i]];
      const std::string earlier = why_earlier(*places[i]);
      const std::string& reason = earlier.empty() ? reasons[i] : earlier;
      if (shown.status == LedgerStatus::kResolved && !reason.empty()) continue;
      shown.shown = reason.empty() ? LedgerStatus::kGone : LedgerStatus::kNotSearched;
      shown.why = reason.empty() ? "nothing collides there any more" : reason;
    }
  }

  /// Why this run is about an earlier day or scan than the one that showed a row last, so that the
  /// row may have come later; empty where it is not.
  std::string why_earlier(const LedgerPlaces& row) const {
    if (how_.today < row.cells.last_seen) {
      return "it was seen on " + text_of(row.cells.last_seen) + ", after the day of this run";
    }
    if (scanned_ && row.scanned && *scanned_ < *row.scanned) {
      return "it was seen in a later scan, of " + text_of(*row.scanned);
    }
    return "";
  }

  /// Whether a row was resolved before this run. What an update of the same day found gone is
  /// judged anew, so that the same run shows the same when it is repeated.
  bool is_resolved_before(std::size_t row) const {
    if (files_.table.status(row) != LedgerStatus::kResolved) return false;
    return rows_[row].places == nullptr || rows_[row].places->gone_on != how_.today;
  }

  std::vector<Contacts> contacts_of(const std::vector<std::size_t>& rows) const {
    std::vector<Contacts> out(rows.size());
    if (rows.empty()) return out;
    std::vector<Box> reach;
    for (const std::size_t row : rows) {
      reach.push_back(rows_[row].box.grown(rows_[row].places->gap + Places::kRounding));
    }
    for_each_point(found_, [&](const PointRow& point) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!reach[i].contains(point.xyz) || out[i].contains(point.conflict)) continue;
        if (rows_[rows[i]].gap->near(point.xyz)) out[i].insert(point.conflict);
      }
    });
    return out;
  }

  /// The row keeps its status, because something collides there that does not belong to it.
  static void name(const Contacts& contacts, LedgerRow& row, Ledger& out) {
    std::vector<std::string> ids;
    for (const std::uint32_t id : contacts) {
      if (id == 0) continue;
      ids.push_back(std::to_string(id));
      LedgerEntry& entry = out.conflicts[id - 1];
      if (entry.key.empty() && entry.why.empty()) {
        entry.why = "a part of it is at the row " + row.key;
      }
    }
    std::string what = ids.empty() ? "" : (ids.size() == 1 ? "conflict " : "conflicts ");
    what += format_list(ids);
    if (contacts.contains(0)) {
      what += std::string(ids.empty() ? "" : " and ") + "a group too small to be listed";
    }
    row.why = "points of " + what + " are there";
  }

  const GroupedResult& found_;
  const LedgerFiles& files_;
  const LedgerJudging& how_;
  const std::string unit_;
  const LedgerQuestion question_;
  const std::optional<Day> scanned_;  ///< the last day of this scan, by the dates of its files
  mutable std::vector<MatchedRow> rows_;
  std::vector<std::vector<std::size_t>> rows_of_;  ///< of each conflict, by its id
};

}  // namespace

Ledger judge_ledger(const GroupedResult& found, const LedgerFiles& files,
                    const LedgerJudging& how) {
  return LedgerJudge(found, files, how).run();
}

}  // namespace clearway
