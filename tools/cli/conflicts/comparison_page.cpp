#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "cli/conflicts/conflict_comparison.hpp"
#include "core/util/format.hpp"
#include "io/result/conflicts/markup_text.hpp"

namespace clearway::tool {
namespace {

/// The style sheet of the page.
constexpr const char* kStyle = R"css(:root {
  --ink: #111827; --soft: #4b5563; --line: #d1d5db;
  font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", Arial, sans-serif; color: var(--ink);
}
* { box-sizing: border-box; }
body { margin: 0; background: #eef0f3; }
header { display: flex; align-items: baseline; gap: 0.3rem 1.4rem; flex-wrap: wrap;
  padding: 0.5rem 1.2rem; background: var(--ink); color: #fff; }
header h1 { font-size: 1.1rem; margin: 0; }
header p { margin: 0; color: #cbd5e1; font-size: 0.9rem; overflow-wrap: anywhere; }
main { padding: 0.8rem 1.2rem; display: grid; gap: 0.8rem; }
section { background: #fff; border: 1px solid var(--line); border-radius: 8px;
  padding: 0.8rem 1.1rem; min-width: 0; }
h2 { font-size: 1.15rem; margin: 0 0 0.4rem; }
.worse { --edge: #b4330a; --back: #fbdccf; }
.open { --edge: #a16207; --back: #fff3cd; }
.holds, .gone { --edge: #00735c; --back: #e3f4ef; }
.same { --edge: #6b7280; --back: #f3f4f6; }
.answer { border-left: 10px solid var(--edge); }
.answer strong { display: block; color: var(--edge); font-size: 2.2rem; line-height: 1.1;
  text-transform: uppercase; }
.answer p { margin: 0.3rem 0 0; font-size: 1.08rem; }
.tiles { display: flex; flex-wrap: wrap; gap: 0.5rem; margin: 0.8rem 0 0; padding: 0;
  list-style: none; }
.tiles li { border: 1px solid var(--edge); background: var(--back); border-radius: 6px;
  padding: 0.3rem 0.8rem; font-size: 0.9rem; }
.tiles b { display: block; font-size: 1.3rem; line-height: 1.2; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
.facts { width: 100%; }
.facts th { text-align: left; font-weight: 500; color: var(--soft); vertical-align: top;
  padding: 0.1rem 1rem 0.1rem 0; }
.facts td { vertical-align: top; padding: 0.1rem 1rem 0.1rem 0; overflow-wrap: anywhere; }
.list { width: 100%; font-size: 0.9rem; }
.list th { background: #e5e9ef; text-align: left; padding: 0.2rem 0.5rem; }
.list td { padding: 0.25rem 0.5rem; border-top: 1px solid #e5e7eb; vertical-align: top; }
.list .number { text-align: right; white-space: nowrap; }
.word { border: 1px solid var(--edge); background: var(--back); border-radius: 5px;
  padding: 0 0.4rem; white-space: nowrap; }
.list tr:target { outline: 3px solid #1d4ed8; }
svg { display: block; width: 100%; height: auto; max-height: 80vh; }
.scroll { overflow-x: auto; }
svg text { font: 600 12px system-ui, "DejaVu Sans", Arial, sans-serif; fill: var(--ink);
  paint-order: stroke; stroke: #fff; stroke-width: 3px; }
.mark circle { fill: var(--back); stroke: var(--edge); stroke-width: 2; }
.note { color: var(--soft); font-size: 0.88rem; margin: 0.3rem 0 0; }
@media (max-width: 800px) {
  .list thead { display: none; }
  .list tr { display: block; border-top: 2px solid var(--line); padding: 0.4rem 0; }
  .list td, .list .number { display: flex; gap: 0.8rem; border: 0; padding: 0.05rem 0;
    text-align: left; white-space: normal; }
  .list td:empty { display: none; }
  .list td::before { content: attr(data-name); flex: 0 0 7.5rem; color: var(--soft); }
  .facts th, .facts td { display: block; }
  svg { min-width: 46rem; max-height: none; }
}
@page { size: A4; margin: 12mm; }
@media print {
  :root { font-size: 9pt; }
  body { background: #fff; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  header { background: none; color: var(--ink); border-bottom: 1px solid; padding: 0 0 2mm; }
  header p { color: var(--soft); }
  main { display: block; padding: 3mm 0 0; }
  section { border: 0; padding: 0; margin: 0 0 5mm; }
  .answer { padding-left: 3mm; border-left: 3mm solid var(--edge); }
  thead { display: table-header-group; }
  tr { break-inside: avoid; }
  svg { max-height: 110mm; }
}
)css";

/// What became of an obstacle, worst first; the later ones are no reason to look.
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

struct FateWords {
  const char* word;
  const char* colour;  ///< a class of the style sheet
};

constexpr std::array<FateWords, 9> kFates{{{"new", "worse"},
                                           {"new part", "worse"},
                                           {"new small group", "worse"},
                                           {"worse", "worse"},
                                           {"not searched", "open"},
                                           {"not known whether worse", "open"},
                                           {"too small in b", "same"},
                                           {"gone", "gone"},
                                           {"the same", "same"}}};

const FateWords& words_of(Fate fate) { return kFates.at(static_cast<std::size_t>(fate)); }

/// One obstacle: the conflicts of a and of b that are the same, or a part of one.
struct Obstacle {
  Fate fate = Fate::kSame;
  std::set<std::uint32_t> in_a = {}, in_b = {};  ///< ids
  std::string note = {};
  const ConflictPart* part = nullptr;
  const SmallGroup* small = nullptr;
};

class ComparisonPage {
 public:
  explicit ComparisonPage(const ComparedConflicts& found) : found_(found) { find_obstacles(); }

  std::string text(const std::filesystem::path& output) {
    out_ =
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
        "style-src 'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>Conflicts compared</title>\n<style>\n";
    out_ += std::string(kStyle) +
            "</style>\n</head>\n<body>\n<header><h1>Conflicts compared</h1><p>" +
            markup_text(name_of(found_.b)) + " beside " + markup_text(name_of(found_.a)) +
            "</p></header>\n<main>\n";
    answer();
    question(output);
    plan();
    table();
    return out_ + "</main>\n</body>\n</html>\n";
  }

 private:
  static std::string name_of(const ComparedResult& side) {
    return std::filesystem::path(side.file).filename().string();
  }

  const Conflict& of_a(std::uint32_t id) const { return conflict_at(found_.a.conflicts, id); }
  const Conflict& of_b(std::uint32_t id) const { return conflict_at(found_.b.conflicts, id); }

  /// Joins pairs that share a conflict, so that each obstacle is one row.
  void add_pairs() {
    std::map<std::uint32_t, std::size_t> at_a, at_b;
    const auto is_in = [](const auto& pairs, const auto& pair) {
      return std::ranges::find(pairs, pair) != pairs.end();
    };
    for (const auto& pair : found_.match.same) {
      const auto known_a = at_a.find(pair.first);
      const auto known_b = at_b.find(pair.second);
      std::size_t at = known_a != at_a.end()   ? known_a->second
                       : known_b != at_b.end() ? known_b->second
                                               : obstacles_.size();
      if (at == obstacles_.size()) obstacles_.emplace_back();
      if (known_a != at_a.end() && known_b != at_b.end() && known_b->second != at) {
        merge(at, known_b->second, at_a, at_b);
      }
      Obstacle& obstacle = obstacles_[at];
      obstacle.in_a.insert(pair.first);
      obstacle.in_b.insert(pair.second);
      at_a[pair.first] = at_b[pair.second] = at;
      if (is_in(found_.worse, pair)) {
        obstacle.fate = Fate::kWorse;
        if (!obstacle.note.empty()) obstacle.note += "; ";
        obstacle.note += worsening_text(found_, of_a(pair.first), of_b(pair.second));
      } else if (is_in(found_.unknown_worse, pair) && obstacle.fate == Fate::kSame) {
        obstacle.fate = Fate::kUnknown;
      }
    }
    std::erase_if(obstacles_, [](const Obstacle& o) { return o.in_a.empty() && o.in_b.empty(); });
  }

  /// Takes the conflicts of one obstacle into another, which leaves the first one empty.
  void merge(std::size_t into, std::size_t from, std::map<std::uint32_t, std::size_t>& at_a,
             std::map<std::uint32_t, std::size_t>& at_b) {
    Obstacle& target = obstacles_[into];
    Obstacle& source = obstacles_[from];
    for (const std::uint32_t id : source.in_a) at_a[id] = into;
    for (const std::uint32_t id : source.in_b) at_b[id] = into;
    target.in_a.merge(source.in_a);
    target.in_b.merge(source.in_b);
    target.fate = std::min(target.fate, source.fate);
    if (!target.note.empty() && !source.note.empty()) target.note += "; ";
    target.note += source.note;
    source = {};
  }

  void find_obstacles() {
    add_pairs();
    const ConflictMatch& match = found_.match;
    for (const std::uint32_t id : match.added) obstacles_.push_back({Fate::kNew, {}, {id}});
    for (const ConflictPart& part : match.grown) {
      obstacles_.push_back({Fate::kNewPart, {}, {part.conflict}, "", &part});
    }
    for (const std::size_t i : match.small) {
      obstacles_.push_back({Fate::kNewSmall, {}, {}, "", nullptr, &found_.b.conflicts.small[i]});
    }
    for (const NotSearched& part : match.not_searched) {
      obstacles_.push_back({Fate::kNotSearched,
                            {part.conflict},
                            {},
                            fmt::format("{}", fmt::join(part.reasons, ", ")),
                            &part});
    }
    for (const std::uint32_t id : match.shrunk) {
      obstacles_.push_back(
          {Fate::kTooSmall, {id}, {}, "b has a group there that is too small to be listed"});
    }
    for (const std::uint32_t id : match.gone) obstacles_.push_back({Fate::kGone, {id}, {}});
    std::ranges::stable_sort(obstacles_, {}, &Obstacle::fate);
  }

  std::size_t count(std::initializer_list<Fate> fates) const {
    return static_cast<std::size_t>(std::ranges::count_if(obstacles_, [&](const Obstacle& o) {
      return std::ranges::find(fates, o.fate) != fates.end();
    }));
  }

  void answer() {
    const char* colour = found_.differs() ? "worse" : found_.shows_nothing() ? "open" : "holds";
    const bool another = !found_.same_question();
    const char* word = another                  ? "Another question"
                       : found_.differs()       ? "Worse"
                       : found_.shows_nothing() ? "Undecided"
                                                : "No worse";
    std::string sentence = sentence_of(found_);
    sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
    out_ += std::string("<section class=\"answer ") + colour +
            "\" aria-label=\"Answer\">\n<strong>" + word + "</strong>\n<p>" +
            markup_text(sentence) + ".</p>\n<ul class=\"tiles\">\n";
    const auto tile = [&](std::size_t number, const char* kind, const char* words) {
      out_ += std::string("<li class=\"") + (number > 0 ? kind : "same") + "\"><b>" +
              format_count(number) + "</b>" + words + "</li>\n";
    };
    tile(count({Fate::kNew, Fate::kNewPart, Fate::kNewSmall}), "worse", "new");
    tile(count({Fate::kWorse}), "worse", "worse");
    tile(count({Fate::kNotSearched, Fate::kUnknown}), "open", "not known");
    tile(count({Fate::kGone, Fate::kTooSmall}), "gone", "gone or too small to be listed");
    tile(count({Fate::kSame}), "same", "the same");
    out_ += "</ul>\n</section>\n";
  }

  /// The report of a result, as a link relative to the page: that of check for its result, or a
  /// page with the name of the result. Nothing where there is none.
  static std::string report_link(const ComparedResult& side, const std::filesystem::path& output) {
    std::error_code failed;
    const std::filesystem::path result = std::filesystem::absolute(side.file, failed);
    std::filesystem::path report = result;
    report.replace_extension(".html");
    if (result.filename() == "result.h5") report.replace_filename("report.html");
    const std::filesystem::path page = std::filesystem::absolute(output, failed);
    if (failed || report == page || !std::filesystem::is_regular_file(report, failed)) return "";
    const std::string link = report.lexically_relative(page.parent_path()).generic_string();
    return link.empty() ? "" : "; <a href=\"" + markup_text(link) + "\">its report</a>";
  }

  void side(const char* name, const ComparedResult& of, const std::filesystem::path& output) {
    const std::string dates = !of.scanned.known() ? "its files do not say when it was scanned"
                              : of.scanned.first == of.scanned.last
                                  ? "files of " + of.scanned.first
                                  : "files of " + of.scanned.first + " to " + of.scanned.last;
    out_ += std::string("<tr><th scope=\"row\">") + name + "</th><td>" + markup_text(of.file) +
            ": " + of.words + ", " + counted(of.conflicts.listed.size(), "conflict") + " of " +
            counted(of.conflicts.colliding_points - of.conflicts.small_points, "point") + "; " +
            markup_text(dates) + report_link(of, output) + "</td></tr>\n";
  }

  void question(const std::filesystem::path& output) {
    out_ +=
        "<section>\n<h2>Question</h2>\n<table class=\"facts\">\n<tr><th scope=\"row\">Asked"
        "</th><td>Is anything closer than " +
        format_brief(found_.b.radius) + " " + found_.b.unit +
        " to the vehicle in b that was not there in a, or closer than in a?</td></tr>\n";
    side("a, before", found_.a, output);
    side("b, after", found_.b, output);
    for (const QueryDifference& query : found_.questions) {
      out_ += "<tr><th scope=\"row\">Differs</th><td>" +
              markup_text(query.what + ": " + query.a + " in a, " + query.b + " in b") +
              "</td></tr>\n";
    }
    out_ +=
        "</table>\n<p class=\"note\">Conflicts are the same where their points are near each "
        "other, and worse where they come nearer, or reach deeper, by more than " +
        format_brief(found_.worse_by) + " " + found_.b.unit + ".</p>\n</section>\n";
  }

  /// The middle of an obstacle.
  Vec3 place_of(const Obstacle& o) const {
    if (o.part != nullptr) return o.part->box.centre();
    if (o.small != nullptr) return o.small->box.centre();
    return shown(o).centroid;
  }

  /// The conflict that a row shows: of b where it is there.
  const Conflict& shown(const Obstacle& o) const {
    return o.in_b.empty() ? of_a(*o.in_a.begin()) : of_b(*o.in_b.begin());
  }

  /// The path from above, north up, and a mark for each obstacle.
  void plan() {
    const std::vector<Vec3>& path = found_.b.path;
    if (path.empty()) return;
    Box box{path[0], path[0]};
    const auto take = [&](const Vec3& p) {
      for (int k = 0; k < 2; ++k) {
        box.lo[k] = std::min(box.lo[k], p[k]);
        box.hi[k] = std::max(box.hi[k], p[k]);
      }
    };
    for (const Vec3& p : path) take(p);
    for (const Obstacle& o : obstacles_) take(place_of(o));
    constexpr double kWidth = 1200, kMostHeight = 560, kEdge = 40;
    const double wide = std::max(box.hi.x - box.lo.x, 1.0);
    const double high = std::max(box.hi.y - box.lo.y, 1.0);
    const double scale = std::min((kWidth - 2 * kEdge) / wide, (kMostHeight - 2 * kEdge) / high);
    const double height = std::max(scale * high + 2 * kEdge, 120.0);
    const auto x_of = [&](const Vec3& p) {
      return kWidth / 2 + (p.x - (box.lo.x + box.hi.x) / 2) * scale;
    };
    const auto y_of = [&](const Vec3& p) {
      return height / 2 - (p.y - (box.lo.y + box.hi.y) / 2) * scale;
    };
    out_ += fmt::format(
        "<section>\n<h2>Plan</h2>\n<div class=\"scroll\">\n<svg viewBox=\"0 0 {:.0f} {:.0f}\" "
        "role=\"img\" "
        "aria-label=\"The path from above, and the conflicts\">\n<path fill=\"none\" "
        "stroke=\"#374151\" stroke-width=\"2\" d=\"",
        kWidth, height);
    const std::size_t stride = std::max<std::size_t>(1, path.size() / 2000);
    for (std::size_t i = 0; i < path.size(); i += stride) {
      out_ += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", x_of(path[i]), y_of(path[i]));
    }
    out_ += "\"/>\n";
    for (std::size_t i = obstacles_.size(); i-- > 0;) {  // the worst on top
      const Obstacle& o = obstacles_[i];
      const Vec3 at = place_of(o);
      const FateWords& words = words_of(o.fate);
      out_ += fmt::format(
          "<a class=\"mark {0}\" href=\"#row{1}\"><title>{2}</title><circle cx=\"{3:.1f}\" "
          "cy=\"{4:.1f}\" r=\"{5}\"/>",
          words.colour, i + 1, markup_text(words.word), x_of(at), y_of(at),
          o.fate == Fate::kSame ? 4 : 7);
      if (o.fate != Fate::kSame) {
        out_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x_of(at) + 9, y_of(at) - 7,
                            i + 1);
      }
      out_ += "</a>\n";
    }
    const double power = std::pow(10, std::floor(std::log10(0.25 * kWidth / scale)));
    double bar = power;
    for (const double f : {2.0, 5.0}) {
      if (f * power * scale <= 0.25 * kWidth) bar = f * power;
    }
    out_ += fmt::format(
        "<path stroke=\"#111827\" stroke-width=\"3\" d=\"M16 {0:.1f}h{1:.1f}\"/>"
        "<text x=\"{2:.1f}\" y=\"{3:.1f}\">{4} {5}</text>\n</svg>\n</div>\n",
        height - 14, bar * scale, 24 + bar * scale, height - 10, format_brief(bar), found_.b.unit);
    out_ +=
        "<p class=\"note\">The numbers are those of the rows below; a mark without one is the "
        "same in both. y is up.</p>\n</section>\n";
  }

  static std::string ids(const std::set<std::uint32_t>& of) {
    return of.empty() ? "–" : fmt::format("{}", fmt::join(of, ", "));
  }

  /// A value before and after, such as "0.080 → 0.030".
  static std::string change(const std::string& before, const std::string& now) {
    if (before.empty() || now.empty() || before == now) return now.empty() ? before : now;
    return before + " → " + now;
  }

  template <typename Value>
  std::string of_both(const Obstacle& o, const Value& value) const {
    return change(value(found_.a, o.in_a), value(found_.b, o.in_b));
  }

  std::array<double, 2> chainages(const Obstacle& o) const {
    if (o.part != nullptr) {
      const ComparedResult& side = o.in_b.empty() ? found_.a : found_.b;
      return {side.chainage[o.part->first_pose], side.chainage[o.part->last_pose]};
    }
    if (o.small != nullptr) return {o.small->chainage_from, o.small->chainage_to};
    std::array<double, 2> range{shown(o).chainage_from, shown(o).chainage_to};
    for (const std::uint32_t id : o.in_b) {
      range = {std::min(range[0], of_b(id).chainage_from),
               std::max(range[1], of_b(id).chainage_to)};
    }
    return range;
  }

  std::string distances(const Obstacle& o) const {
    return of_both(o, [](const ComparedResult& side, const std::set<std::uint32_t>& of) {
      std::optional<double> least;
      for (const std::uint32_t id : of) {
        const auto& distance = conflict_at(side.conflicts, id).least_distance;
        if (distance && (!least || *distance < *least)) least = distance;
      }
      return least ? fmt::format("{:.3f}", *least) : std::string();
    });
  }

  std::string points(const Obstacle& o) const {
    if (o.part != nullptr) return format_count(o.part->points);
    if (o.small != nullptr) return format_count(o.small->points);
    return of_both(o, [](const ComparedResult& side, const std::set<std::uint32_t>& of) {
      std::uint64_t sum = 0;
      for (const std::uint32_t id : of) sum += conflict_at(side.conflicts, id).points;
      return of.empty() ? std::string() : format_count(sum);
    });
  }

  void row(std::size_t number, const Obstacle& o) {
    const auto [from, to] = chainages(o);
    const Vec3 at = place_of(o);
    const std::string unit = " (" + found_.b.unit + ")";
    const auto cell = [&](const std::string& name, const std::string& text, bool is_number = true) {
      out_ += "<td data-name=\"" + name + "\"" + (is_number ? " class=\"number\"" : "") + ">" +
              text + "</td>";
    };
    out_ += fmt::format("<tr id=\"row{}\" class=\"{}\">", number, words_of(o.fate).colour);
    cell("Row", std::to_string(number));
    cell("What", std::string("<span class=\"word\">") + words_of(o.fate).word + "</span>", false);
    cell("No. in a", o.small != nullptr ? "" : ids(o.in_a));
    cell("No. in b", o.small != nullptr ? "" : ids(o.in_b));
    cell("Chainage" + unit, fmt::format("{:.2f} – {:.2f}", from, to));
    cell("Side", o.small != nullptr ? "" : clearway::name_of(shown(o).side), false);
    cell("Distance" + unit, o.part != nullptr || o.small != nullptr ? "" : distances(o));
    cell("Points", points(o));
    cell("Place", fmt::format("{:.2f} {:.2f} {:.2f}", at.x, at.y, at.z));
    cell("Note", markup_text(o.note), false);
    out_ += "</tr>\n";
  }

  void rows(std::size_t first, std::size_t end) {
    const std::string unit = " (" + found_.b.unit + ")";
    out_ += "<table class=\"list\">\n<thead><tr>";
    for (const std::string& title :
         {std::string(), std::string("What"), std::string("No. in a"), std::string("No. in b"),
          "Chainage" + unit, std::string("Side"), "Distance" + unit, std::string("Points"),
          std::string("Place x y z"), std::string("Note")}) {
      const bool is_text = title == "What" || title == "Side" || title == "Note";
      out_ += std::string("<th scope=\"col\"") + (is_text ? ">" : " class=\"number\">") + title +
              "</th>";
    }
    out_ += "</tr></thead>\n<tbody>\n";
    for (std::size_t i = first; i < end; ++i) row(i + 1, obstacles_[i]);
    out_ += "</tbody>\n</table>\n";
  }

  /// Each obstacle in a row; what is the same in both is folded where it is much.
  void table() {
    if (obstacles_.empty()) return;
    constexpr std::size_t kFew = 10;
    const std::size_t same = count({Fate::kSame}), others = obstacles_.size() - same;
    out_ += "<section>\n<h2>Obstacles</h2>\n";
    if (others > 0 || same <= kFew) rows(0, same <= kFew ? obstacles_.size() : others);
    if (same > kFew) {
      out_ += "<details><summary>" + counted(same, "obstacle") + " that " +
              (same == 1 ? "is" : "are") + " the same in both</summary>\n";
      rows(others, obstacles_.size());
      out_ += "</details>\n";
    }
    out_ += "</section>\n";
  }

  const ComparedConflicts& found_;
  std::vector<Obstacle> obstacles_;
  std::string out_;
};

}  // namespace

std::string html_of(const ComparedConflicts& found, const std::filesystem::path& output) {
  return ComparisonPage(found).text(output);
}

}  // namespace clearway::tool
