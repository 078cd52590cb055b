#include "cli/conflicts/conflict_comparison.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/verdict.hpp"
#include "core/query/verdict_words.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "findings/conflict_rank.hpp"
#include "findings/match_conflicts.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/text_writer.hpp"
#include "io/result/answer.hpp"
#include "io/result/check_results.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/result.hpp"
#include "io/scans/scan_dates.hpp"
#include "report/page.hpp"

namespace clearway::tool {
namespace {

/// One of the two results that are compared, with its conflicts.
struct ComparedSide {
  ComparedSide(ConflictComparison& options, const SearchedFiles& files,
               const Conflicts* grouped_as = nullptr)
      : opened(options, files), has_shifts(!files.model.empty() || !files.vehicle.empty()) {
    repeat_warnings(opened.result.reader(), file + ": ");
    opened.read();
    opened.log_messages();
    ConflictOptions find = options.find;
    if (files.model.empty()) find.model = nullptr;
    find.station = {};
    if (grouped_as != nullptr) {
      find.gap = grouped_as->gap;
      find.min_points = grouped_as->min_points;
    }
    conflicts = find_conflicts(opened.result, opened.poses, find, &conflict_of, &conflict_of_near);
    chainage = chainage_of(opened.poses);
    for (double& metres : chainage) metres += find.chainage_start;
  }

  GroupedResult grouped() const {
    return {opened.result, conflicts, conflict_of, conflict_of_near, opened.poses};
  }
  /// Whether something could not be found, whatever the verdict is about the rest.
  bool undecided() const {
    return answer.verdict() == Verdict::kUndecided || !answer.doubts().empty();
  }
  std::uint64_t listed_points() const {
    return conflicts.colliding_points + conflicts.near_points - conflicts.small_points;
  }

  OpenedResult opened;
  std::string file = opened.result.reader().name();
  const ResultHeader& header = opened.result.reader().header();
  std::string unit = symbol_of(unit_of(header));
  Answer answer = counted_answer(opened.result.reader());
  /// The days of the scans, by the dates of their files
  const ScanDates& scanned = opened.result.reader().findings().scanned;
  Conflicts conflicts;
  std::vector<std::uint32_t> conflict_of, conflict_of_near;
  std::vector<double> chainage;  ///< of each pose, metres, from --chainage-start on
  bool has_shifts;               ///< whether the model was given, so that shifts are known
};

/// What became of a place, worst first.
enum class Fate {
  kNew,
  kNewPart,
  kNewSmall,
  kWorse,
  kNotSearched,
  kUnknown,
  kTooSmall,
  kGone,
  kSame
};
using Fates = std::initializer_list<Fate>;

/// What a fate is called: in tables, as a class of the page's style, and as a list of the JSON.
struct FateWords {
  const char *word, *kind, *list;
};

constexpr FateWords kFates[]{{"new", "new", "new"},
                             {"new part", "new", "new_parts"},
                             {"new small group", "new", "new_small"},
                             {"worse", "worse", "worse"},
                             {"not searched", "not-searched", "not_searched"},
                             {"not known whether worse", "not-searched", "unknown_worse"},
                             {"too small", "resolved", "too_small"},
                             {"gone", "gone", "gone"},
                             {"same", "resolved", "same"}};

const FateWords& words_of(Fate fate) { return kFates[static_cast<std::size_t>(fate)]; }

/// What one of the results has at a place.
struct PlaceIn {
  const Conflict* conflict = nullptr;  ///< null for a group that is too small to be listed
  std::optional<std::uint64_t> points = {};
  std::optional<double> distance = {};

  static PlaceIn of(const Conflict* c) {
    return c == nullptr ? PlaceIn{} : PlaceIn{c, c->points, c->least_distance};
  }
};

/// A conflict of a, of b, or the same one of both; a part of one; or a group of b that is too small
/// to be listed. All outputs are made of these.
struct ComparedPlace {
  Fate fate = Fate::kSame;
  PlaceIn a = {}, b = {};
  Vec3 middle{};  ///< of a conflict its centroid
  double chainage_from = 0, chainage_to = 0;
  std::optional<double> obstacle_chainage = {};  ///< of a conflict
  std::uint64_t source = 0;                      ///< smallest source index of a part or small group
  Box box{};                                     ///< of a part or small group
  std::vector<std::string> reasons = {};
  std::string note = {};

  bool is_pair() const { return a.conflict != nullptr && b.conflict != nullptr; }
  /// Whether it is the whole of its conflicts.
  bool is_whole() const {
    return fate != Fate::kNewPart && fate != Fate::kNewSmall && fate != Fate::kNotSearched;
  }
  /// The conflict that stands for both: that of b where it is there.
  const Conflict* shown() const { return b.conflict != nullptr ? b.conflict : a.conflict; }
  std::string side() const { return shown() == nullptr ? "" : name_of(shown()->side); }
};

ComparedPlace whole_place(Fate fate, const Conflict* a, const Conflict* b, std::string note = {}) {
  ComparedPlace out{
      .fate = fate, .a = PlaceIn::of(a), .b = PlaceIn::of(b), .note = std::move(note)};
  out.middle = out.shown()->centroid;
  out.chainage_from = out.shown()->chainage_from;
  out.chainage_to = out.shown()->chainage_to;
  out.obstacle_chainage = out.shown()->obstacle_chainage;
  return out;
}

ComparedPlace part_place(Fate fate, const Box& box, std::uint64_t source, double from, double to) {
  return {.fate = fate,
          .middle = box.centre(),
          .chainage_from = from,
          .chainage_to = to,
          .source = source,
          .box = box};
}

/// The outcome of a comparison of two results' conflicts.
class ComparedConflicts {
 public:
  ComparedConflicts(const ComparedSide& side_a, const ComparedSide& side_b,
                    const ConflictComparison& options)
      : a(side_a),
        b(side_b),
        questions(question_differences(a.header, b.header)),
        other_question_allowed(options.allow_other_question),
        same_points(a.header.environment_points == b.header.environment_points &&
                    a.header.environment_hash == b.header.environment_hash),
        worse_by(options.worse_by) {
    if (a.unit != b.unit) {
      throw InputError(b.file + ": its coordinates are in " + b.unit + ", expected " + a.unit +
                       " as in " + a.file);
    }
    add_places(match_conflicts(a.grouped(), b.grouped(), a.conflicts.gap, worse_by));
  }

  std::vector<const ComparedPlace*> with(Fates fates) const {
    std::vector<const ComparedPlace*> out;
    for (const ComparedPlace& place : places) {
      if (std::ranges::find(fates, place.fate) != fates.end()) out.push_back(&place);
    }
    return out;
  }
  /// The number of conflicts of b that are at places with one of these fates: one may be the same
  /// as several of a.
  std::size_t count_in_b(Fates fates) const {
    std::set<const Conflict*> of_b;
    for (const ComparedPlace* place : with(fates)) of_b.insert(place->b.conflict);
    return of_b.size();
  }

  bool has_distances() const { return a.header.clearance > 0 && b.header.clearance > 0; }
  bool has_shifts() const { return a.has_shifts && b.has_shifts; }
  /// Whether both results answer the same question about the same points, as where one scan was
  /// given twice.
  bool is_same_scan() const { return questions.empty() && same_points; }
  bool same_question() const { return questions.empty() || other_question_allowed; }
  /// Whether all files of the scans of b are older than those of a; nothing where their dates,
  /// which may be those of a later export, show no order.
  std::optional<bool> is_older() const {
    if (same_points) return false;
    if (!a.scanned.known() || !b.scanned.known()) return std::nullopt;
    if (b.scanned.last < a.scanned.first) return true;
    return a.scanned.last < b.scanned.first ? std::optional(false) : std::nullopt;
  }
  /// Whether b is seen to be worse than a, or answers another question that was not allowed.
  bool differs() const {
    return !same_question() || std::ranges::any_of(places, [](const auto& place) {
      return place.fate <= Fate::kWorse;
    });
  }
  /// Whether b cannot show that nothing became worse: something could not be found in it, it has
  /// not searched a place where a has a conflict, or it is the same scan as a or an older one.
  bool shows_nothing() const {
    return b.undecided() || !with({Fate::kNotSearched}).empty() || is_same_scan() ||
           is_older().value_or(false);
  }
  int exit_code() const { return differs() ? kDiffers : shows_nothing() ? kUndecided : kDone; }

  const ComparedSide &a, &b;
  std::vector<QueryDifference> questions;
  bool other_question_allowed = false;
  bool same_points = false;  ///< whether both results are about the same points
  double worse_by = 0;
  /// Pairs of conflicts in the order of their ids, and the others of each fate.
  std::vector<ComparedPlace> places;

 private:
  const Conflict* of_a(std::uint32_t id) const { return &a.conflicts.listed[id - 1]; }
  const Conflict* of_b(std::uint32_t id) const { return &b.conflicts.listed[id - 1]; }

  void add_places(const ConflictMatch& match) {
    for (const std::uint32_t id : match.added) add(whole_place(Fate::kNew, nullptr, of_b(id)));
    for (const ConflictPart& part : match.grown) {
      add(part_of(Fate::kNewPart, part, b)).b = {of_b(part.conflict), part.points};
    }
    for (const std::size_t i : match.small) {
      const Conflict group = as_conflict(b.conflicts.small[i]);
      ComparedPlace& place = add(part_place(Fate::kNewSmall, group.box, group.source,
                                            group.chainage_from, group.chainage_to));
      place.middle = group.centroid;
      place.b.points = group.points;
    }
    for (const auto& [in_a, in_b] : match.same) add(pair_place(*of_a(in_a), *of_b(in_b)));
    for (const NotSearched& part : match.not_searched) {
      ComparedPlace& place = add(part_of(Fate::kNotSearched, part, a));
      place.a = {of_a(part.conflict), part.points};
      place.reasons = part.reasons;
      place.note = fmt::format("{}", fmt::join(part.reasons, ", "));
    }
    for (const std::uint32_t id : match.shrunk) {
      add(whole_place(Fate::kTooSmall, of_a(id), nullptr,
                      "b has a group there that is too small to be listed"));
    }
    for (const std::uint32_t id : match.gone) add(whole_place(Fate::kGone, of_a(id), nullptr));
  }
  ComparedPlace& add(ComparedPlace place) { return places.emplace_back(std::move(place)); }

  static ComparedPlace part_of(Fate fate, const ConflictPart& part, const ComparedSide& side) {
    return part_place(fate, part.box, part.source, side.chainage[part.first_pose],
                      side.chainage[part.last_pose]);
  }

  /// Judges a conflict that is the same in both. It is worse where it comes nearer, or reaches
  /// deeper, by more than `worse_by`. How deep a point is behind a surface does not follow from
  /// distances, but from the shift that its own points need.
  ComparedPlace pair_place(const Conflict& in_a, const Conflict& in_b) const {
    const auto found = [&](Fate fate, std::string note = {}) {
      return whole_place(fate, &in_a, &in_b, std::move(note));
    };
    const auto change = [&](std::optional<double> before, std::optional<double> now,
                            const char* none) {
      const auto text = [&](const auto& v) { return v ? fmt::format("{:.3f}", *v) : none; };
      return text(before) + " -> " + text(now) + " " + a.unit;
    };
    const std::optional<double>&before = in_a.least_distance, &now = in_b.least_distance;
    if (has_distances() && now) {
      if (!before || *now < *before - worse_by) {
        return found(Fate::kWorse, change(before, now, "unknown"));
      }
      if (*now > std::max(worse_by, kTouching) || b.header.model_solids > 0) {
        return found(Fate::kSame);
      }
      // With a model of points there is no depth, unless the shifts give it.
      if (b.header.model_triangles == 0 && !has_shifts()) return found(Fate::kSame);
    }
    const bool has_same_points = in_a.points == in_b.points && in_a.box.lo == in_b.box.lo &&
                                 in_a.box.hi == in_b.box.hi && in_a.centroid == in_b.centroid;
    if (questions.empty() && has_same_points) return found(Fate::kSame);
    const auto shift = [](const Conflict& c) {
      const double least = least_own_shift(c);
      return std::isinf(least) ? std::nullopt : std::optional(least);
    };
    const auto shift_a = shift(in_a), shift_b = shift(in_b);
    if (!has_shifts() || (!shift_a && !shift_b)) {
      return found(Fate::kUnknown, "it is not known whether it is worse");
    }
    if (shift_a && (!shift_b || *shift_b > *shift_a + worse_by)) {
      return found(Fate::kWorse,
                   "its own points need a shift of " + change(shift_a, shift_b, "more than 2"));
    }
    return found(Fate::kSame);
  }
};

// The last line of the text

/// A clause for a result that could not find anything; empty for others.
std::string undecided_text(const ComparedSide& side, const char* name) {
  const std::vector<std::string> doubts = side.answer.doubts();
  if (side.answer.verdict() != Verdict::kUndecided) {
    return doubts.empty()
               ? ""
               : fmt::format("; {} is not known as a whole, because its run warned of {}", name,
                             fmt::join(doubts, ", "));
  }
  if (!doubts.empty()) {
    return fmt::format("; {} is undecided, because {}", name, doubt_words(doubts));
  }
  std::vector<std::string> reasons;
  for (const Reason reason : side.answer.reasons()) reasons.emplace_back(name_of(reason));
  return fmt::format("; {} is undecided ({})", name, fmt::join(reasons, ", "));
}

/// A clause about which scan is the later one; empty where the dates of the files say that it is b.
std::string order_text(const ComparedConflicts& found) {
  const std::optional<bool> older = found.is_older();
  if (found.is_same_scan()) return "; both results are about the same scan, so nothing is compared";
  if (!older) {
    return "; the dates of the files do not show that b is the later scan, so it is taken as given";
  }
  return *older ? "; by the dates of the files b is older than a: are they the wrong way round?"
                : "";
}

/// What the comparison found, in one sentence.
std::string sentence_of(const ComparedConflicts& found) {
  std::string out;
  const auto add = [&out](std::size_t count, const char* one, const char* many) {
    if (count > 0) out += (out.empty() ? "" : ", ") + counted(count, one, many);
  };
  const auto count = [&](Fate fate) { return found.with({fate}).size(); };
  add(count(Fate::kNew), "new conflict", "new conflicts");
  add(found.count_in_b({Fate::kWorse}), "conflict is worse", "conflicts are worse");
  add(count(Fate::kNewPart), "part of another conflict is new", "parts of other conflicts are new");
  add(count(Fate::kNewSmall), "new group is too small to be listed",
      "new groups are too small to be listed");
  if (out.empty()) out = "no new conflicts";
  if (const std::size_t unknown = count(Fate::kUnknown); unknown > 0) {
    out += ", and " + counted(unknown, "conflict") + " of which it is not known whether " +
           (unknown == 1 ? "it is worse" : "they are worse");
  }
  if (const std::size_t open = count(Fate::kNotSearched); open > 0) {
    out += "; b has not searched " + counted(open, "place", "places") + " where a has a conflict";
  }
  if (const std::size_t gone = count(Fate::kGone); gone > 0 && !found.same_points) {
    out += "; " + counted(gone, "conflict is", "conflicts are") +
           " gone if b was scanned there, where gaps are known only by its warnings";
  }
  out += undecided_text(found.b, "b") + undecided_text(found.a, "a") + order_text(found);
  if (found.questions.empty()) return out;
  return out + (out.find(';') == std::string::npos ? ", but" : ";") +
         " b answers another question than a" +
         (found.other_question_allowed ? ", which was allowed"
                                       : "; --allow-other-question compares them nevertheless");
}

// Text

std::string line_of(const ComparedPlace& place) {
  const PlaceIn& in = place.b.points ? place.b : place.a;
  const Conflict* const c = place.is_whole() ? in.conflict : nullptr;
  const std::string classes = c != nullptr ? class_words(*c) : "";
  const bool has_note = place.fate == Fate::kWorse || place.fate == Fate::kNotSearched;
  return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}{}  {:.3f} {:.3f} {:.3f}{}{}{}{}\n",
                     in.conflict != nullptr ? std::to_string(in.conflict->id) : "",
                     range_text(place.chainage_from, place.chainage_to), format_count(*in.points),
                     *in.points == 1 ? "point" : "points",
                     c != nullptr ? fmt::format("  {:>7}", place.side()) : "", place.middle.x,
                     place.middle.y, place.middle.z, classes.empty() ? "" : "; ", classes,
                     has_note ? "  " : "", has_note ? place.note : "");
}

std::string side_text(const char* name, const ComparedSide& side) {
  const Conflicts& found = side.conflicts;
  std::string text =
      fmt::format("{}: {} of {} in {}\n", name, counted(found.listed.size(), "conflict"),
                  counted(side.listed_points(), "point"), side.file);
  if (found.small_groups > 0) {
    text += fmt::format("{}: {} of {} {} too small to be listed\n", name,
                        counted(found.small_groups, "group"), counted(found.small_points, "point"),
                        found.small_groups == 1 ? "is" : "are");
  }
  return text;
}

std::string text_of(const ComparedConflicts& found, std::size_t show) {
  const Conflicts& a = found.a.conflicts;
  std::string text = side_text("a", found.a) + side_text("b", found.b) +
                     fmt::format("both are grouped with a gap of {} {} and at least {}\n",
                                 format_brief(a.gap), found.a.unit, counted(a.min_points, "point"));
  for (const QueryDifference& query : found.questions) {
    text += "queries differ: " + query.what + ": " + query.a + " / " + query.b + "\n";
  }
  const auto add_list = [&](Fate fate, const std::string& title, bool even_empty = false) {
    const auto list = found.with({fate});
    if (list.empty() && !even_empty) return;
    text += title + ": " + format_count(list.size()) + "\n";
    for (std::size_t i = 0; i < std::min(show, list.size()); ++i) text += line_of(*list[i]);
    if (list.size() > show) text += "  and " + format_count(list.size() - show) + " more\n";
  };
  add_list(Fate::kNew, "new, only in b", true);
  add_list(Fate::kNewPart, "parts of other conflicts that are new");
  add_list(Fate::kNewSmall, "new groups that are too small to be listed");
  if (found.has_distances() || found.has_shifts()) {
    add_list(Fate::kWorse,
             "worse by more than " + format_brief(found.worse_by) + " " + found.a.unit, true);
  } else {
    text += "worse: not known, because the results have no clearances (run --clearance)\n";
  }
  if (found.has_distances()) {
    add_list(
        Fate::kUnknown,
        std::string("not known whether they are worse, because nothing shows how deep they are "
                    "inside the model") +
            (found.has_shifts() ? "" : " (--model or --vehicle finds it by shifts)"));
  }
  add_list(Fate::kNotSearched, "not searched in b, so not known");
  add_list(Fate::kTooSmall, "in b too small to be listed");
  add_list(Fate::kGone, "gone, only in a", true);
  text += "the same in both: " +
          format_count(found.count_in_b({Fate::kWorse, Fate::kUnknown, Fate::kSame})) + "\n";
  return text + sentence_of(found) + "\n";
}

// CSV

std::string csv_of(const ComparedConflicts& found) {
  constexpr int kMiddleColumns = 13;  // those without status and note
  std::string out =
      "status,id_a,id_b,chainage_from,chainage_to,obstacle_chainage,side,points_a,points_b,"
      "least_distance_a,least_distance_b,x,y,z,note\n";
  for (const QueryDifference& query : found.questions) {
    out += "question," + std::string(kMiddleColumns, ',') +
           csv_cell(query.what + ": " + query.a + " / " + query.b) + "\n";
  }
  const auto number = [](const std::optional<double>& v) { return v ? format_number(*v) : ""; };
  const auto count = [](const auto& v) { return v ? std::to_string(*v) : ""; };
  const auto id = [](const PlaceIn& in) {
    return in.conflict != nullptr ? std::to_string(in.conflict->id) : "";
  };
  const auto fate_of = [](const ComparedPlace& place) {
    return place.fate == Fate::kUnknown ? Fate::kSame : place.fate;
  };
  std::vector<ComparedPlace> rows = found.places;
  std::ranges::stable_sort(rows, {}, fate_of);
  for (const ComparedPlace& place : rows) {
    out += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", words_of(fate_of(place)).word,
        id(place.a), id(place.b), number(place.chainage_from), number(place.chainage_to),
        number(place.obstacle_chainage), place.side(), count(place.a.points), count(place.b.points),
        number(place.a.distance), number(place.b.distance), number(place.middle.x),
        number(place.middle.y), number(place.middle.z), csv_cell(place.note));
  }
  return out;
}

// JSON

Json json_of(const Conflict& c) {
  Json out{{"id", c.id},
           {"points", c.points},
           {"source", c.source},
           {"lo", c.box.lo},
           {"hi", c.box.hi},
           {"centroid", c.centroid},
           {"chainage_from", c.chainage_from},
           {"chainage_to", c.chainage_to},
           {"obstacle_chainage", or_null(c.obstacle_chainage)},
           {"least_distance", or_null(c.least_distance)},
           {"own_shift_left", or_null(c.own_shift_left)},
           {"own_shift_right", or_null(c.own_shift_right)},
           {"side", name_of(c.side)}};
  if (c.main_class) out["main_class"] = *c.main_class;
  if (c.main_class_points) out["main_class_points"] = *c.main_class_points;
  return out;
}

Json json_of(const ComparedPlace& place) {
  const Conflict* const shown = place.shown();
  if (place.is_pair()) {
    return {{"a", json_of(*place.a.conflict)}, {"b", json_of(*place.b.conflict)}};
  }
  if (place.is_whole()) return json_of(*shown);
  Json out;
  if (shown != nullptr) out["id"] = shown->id;
  out.update({{"points", *(place.b.points ? place.b : place.a).points},
              {"source", place.source},
              {"lo", place.box.lo},
              {"hi", place.box.hi},
              {"chainage_from", place.chainage_from},
              {"chainage_to", place.chainage_to}});
  if (place.fate == Fate::kNotSearched) out["reasons"] = place.reasons;
  return out;
}

Json json_of(const ComparedSide& side) {
  return {{"file", side.file},
          {"unit", side.unit},
          {"radius", side.header.radius},
          {"verdict", name_of(side.answer.verdict())},
          {"doubts", side.answer.doubts()},
          {"conflicts", side.conflicts.listed.size()},
          {"colliding_points", side.conflicts.colliding_points},
          {"small_groups", side.conflicts.small_groups},
          {"small_points", side.conflicts.small_points}};
}

/// The comparison as one JSON object, with a line break at its end.
std::string json_of(const ComparedConflicts& found) {
  Json out{{"a", json_of(found.a)},
           {"b", json_of(found.b)},
           {"holds", found.exit_code() == kDone},
           {"same_scan", found.is_same_scan()},
           {"older", or_null(found.is_older())},
           {"questions", questions_json(found.questions)}};
  const auto add = [&](Fates fates) {
    Json& list = out[words_of(*(fates.end() - 1)).list] = Json::array();
    for (const ComparedPlace* place : found.with(fates)) list.push_back(json_of(*place));
  };
  for (const Fate fate :
       {Fate::kNew, Fate::kNewPart, Fate::kNewSmall, Fate::kWorse, Fate::kUnknown}) {
    add({fate});
  }
  out.update({{"worse_by", found.worse_by},
              {"gap", found.a.conflicts.gap},
              {"min_points", found.a.conflicts.min_points},
              {"distances_known", found.has_distances()}});
  for (const Fate fate : {Fate::kNotSearched, Fate::kTooSmall, Fate::kGone}) add({fate});
  add({Fate::kWorse, Fate::kUnknown, Fate::kSame});
  // File names need not be UTF-8.
  return indented_text(out, -1);
}

// The page

/// The report of a result, as a link relative to the page: that of check for its result, or a page
/// with the name of the result. Empty where there is none.
std::string report_link(const std::filesystem::path& file, const std::filesystem::path& output) {
  std::error_code failed;
  const std::filesystem::path result = std::filesystem::absolute(file, failed);
  std::filesystem::path report = result;
  report.replace_extension(".html");
  if (result.filename() == "result.h5") report.replace_filename("report.html");
  const std::filesystem::path page = std::filesystem::absolute(output, failed);
  if (failed || report == page || !std::filesystem::is_regular_file(report, failed)) return "";
  return report.lexically_relative(page.parent_path()).generic_string();
}

Json page_side(const char* name, const ComparedSide& side, const std::filesystem::path& output) {
  const auto& [first, last] = side.scanned;
  const std::string dates = !side.scanned.known()
                                ? "its files do not say when it was scanned"
                                : "files of " + first + (first == last ? "" : " to " + last);
  return {{"name", name},
          {"words", fmt::format("{}: {}, {} of {}; {}", side.file,
                                verdict_words(side.answer.verdict(), !side.answer.warnings.empty()),
                                counted(side.conflicts.listed.size(), "conflict"),
                                counted(side.listed_points(), "point"), dates)},
          {"report", report_link(side.file, output)}};
}

Json page_place(const ComparedPlace& place) {
  const auto in = [](const PlaceIn& of) -> Json {
    if (!of.points) return nullptr;
    return {{"id", of.conflict != nullptr ? Json(of.conflict->id) : Json()},
            {"points", *of.points},
            {"distance", or_null(of.distance)}};
  };
  const FateWords& words = words_of(place.fate);
  return {{"rank", static_cast<int>(place.fate)},
          {"what", words.word},
          {"kind", words.kind},
          {"a", in(place.a)},
          {"b", in(place.b)},
          {"chainage", {place.chainage_from, place.chainage_to}},
          {"side", place.side()},
          {"middle", place.middle},
          {"note", place.note}};
}

/// The comparison as a page. output: the page's file, from which its links lead.
void write_comparison_page(const ComparedConflicts& found, const std::filesystem::path& output,
                           const std::filesystem::path& path) {
  constexpr std::size_t kMostPlaces = 2000;
  const auto name = [](const ComparedSide& side) {
    return std::filesystem::path(side.file).filename().string();
  };
  const std::string title = name(found.b) + " beside " + name(found.a) + ": conflicts compared";
  Json facts = page_head({}, title);
  facts["unit"] = to_string(unit_of(found.b.header));
  facts["word"] = !found.same_question()  ? "Another question"
                  : found.differs()       ? "Worse"
                  : found.shows_nothing() ? "Undecided"
                                          : "No worse";
  facts["kind"] = found.differs() ? "conflict" : found.shows_nothing() ? "undecided" : "clear";
  facts["sentence"] = sentence_of(found);
  facts["radius"] = found.b.header.radius;
  facts["worse_by"] = found.worse_by;
  facts["sides"] = {page_side("a, before", found.a, output),
                    page_side("b, after", found.b, output)};
  facts["questions"] = questions_json(found.questions);
  facts["places"] = Json::array();
  for (const ComparedPlace& place : found.places) facts["places"].push_back(page_place(place));
  const std::vector<Pose>& poses = found.b.opened.poses;
  facts["path"] = Json::array();
  for (std::size_t i = 0; i < poses.size(); i += 1 + poses.size() / kMostPlaces) {
    facts["path"].push_back(poses[i].position());
  }
  write_page(path, kComparisonPage, {.title = title, .facts = page_text(facts)});
}

enum class ComparisonFormat { kCsv, kJson, kHtml };

ComparisonFormat comparison_format_of(const std::filesystem::path& output) {
  const std::string ending = file_ending(output);
  if (ending == ".csv") return ComparisonFormat::kCsv;
  if (ending == ".json") return ComparisonFormat::kJson;
  if (ending == ".html") return ComparisonFormat::kHtml;
  throw UsageError(output.string() +
                   ": unknown output format; the name must end in .csv, .json or .html");
}

}  // namespace

Json questions_json(const std::vector<QueryDifference>& questions) {
  Json out = Json::array();
  for (const auto& [what, a, b] : questions) out.push_back({{"what", what}, {"a", a}, {"b", b}});
  return out;
}

void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts) {
  const std::vector<CLI::Option*> before = command.get_options();
  const GroupScope inputs(command, OptionGroup::kInputs);
  add_file(command, "--trajectory", options.trajectory, "The trajectory of A, and of B");
  add_file(command, "--trajectory-b", options.b.trajectory,
           "The trajectory of B, where it is another");
  add_file(command, "--model", options.model,
           "The model of A, and of B: for shifts, which show how deep a surface is touched");
  add_file(command, "--model-b", options.b.model, "The model of B, where it is another");
  add_file(command, "--vehicle", options.vehicle,
           "The vehicle of several bodies of A, and of B: for sides and shifts");
  add_file(command, "--vehicle-b", options.b.vehicle, "The vehicle of B, where it is another");
  add_model_options(command, options.model_options, options.lengths);
  add_conflict_options(command, options);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
  add_axis_options(command, options);
  {
    const GroupScope conflict_group(command, OptionGroup::kConflicts);
    options.lengths.add(
        command, "--worse-by", options.worse_by,
        "A conflict is worse where it comes nearer, or reaches deeper, by more than "
        "this (default: 0.02)",
        FieldRange::kFromZero);
    command.add_flag("--allow-other-question", options.allow_other_question,
                     "Compare results of different questions; they differ otherwise (exit code 1)");
  }
  add_file(command, "-o,--output", options.outputs,
           "Write the comparison to a file: .csv, .json or .html; may be repeated")
      ->expected(1)
      ->take_all();
  const GroupScope files(command, OptionGroup::kFiles);
  command.add_flag("--force", options.force, "Overwrite an existing output");
  for (CLI::Option* option : command.get_options()) {
    if (std::ranges::find(before, option) == before.end()) option->needs(conflicts);
  }
}

int compare_conflicts(ConflictComparison& options) {
  if (options.trajectory.empty()) {
    throw UsageError("--conflicts needs --trajectory, the trajectory of the runs");
  }
  for (const auto of :
       {&SearchedFiles::trajectory, &SearchedFiles::model, &SearchedFiles::vehicle}) {
    if ((options.b.*of).empty()) options.b.*of = options.*of;
  }
  NewOutputs<ComparisonFormat> outputs(options, comparison_format_of,
                                       options.b.with(options.with({})));
  const ComparedSide a(options, options);
  // Both are grouped as a is, so that a scan of another density has the same groups.
  const ComparedSide b(options, options.b, &a.conflicts);
  const ComparedConflicts found(a, b, options);
  auto output = options.outputs.begin();
  outputs.write([&](ComparisonFormat format, const std::filesystem::path& path) {
    if (format == ComparisonFormat::kHtml) {
      write_comparison_page(found, *output, path);
    } else {
      const std::string text = format == ComparisonFormat::kCsv ? csv_of(found) : json_of(found);
      File::create(path).write(std::as_bytes(std::span(text)));
    }
    ++output;
  });
  print(options.json ? json_of(found) : text_of(found, options.show));
  return found.exit_code();
}

}  // namespace clearway::tool
