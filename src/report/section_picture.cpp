#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/format.hpp"
#include "io/result/conflicts/markup_text.hpp"
#include "report/section_view.hpp"

namespace clearway {
namespace {

constexpr double kWidth = 1000, kLeft = 94, kRight = 54, kMostHeight = 640;
constexpr double kLine = 19;      ///< from one line of text to the next
constexpr double kLetter = 6.9;   ///< width of a letter of 13 pixels
constexpr double kMarkStep = 23;  ///< from one letter of a place to the next below it
constexpr std::size_t kMostMarks = 24;
constexpr std::size_t kMostLegends = 12;  ///< of outlines
/// Colours of the outlines, which begin again where there are more.
constexpr std::array<const char*, 5> kLoadColours{"#5b21b6", "#be123c", "#0369a1", "#a16207",
                                                  "#0f766e"};

/// What the picture begins with: its size, its sentence, and the patterns of its cells.
constexpr const char* kHead =
    R"svg(<svg xmlns="http://www.w3.org/2000/svg" id="section-svg")svg"
    R"svg( viewBox="0 0 {0} {1}" width="{0}" height="{1}" data-left="{2}" data-top="{3}")svg"
    R"svg( data-scale="{4}" role="img" aria-label="{5}">
<style>#section-svg text{{font:13px system-ui,"DejaVu Sans",Arial,sans-serif;fill:#374151}})svg"
    R"svg(#section-svg .section_title{{font-size:16px;font-weight:600;fill:#111827}})svg"
    R"svg(#section-svg .section_strong{{font-weight:600;fill:#111827}})svg"
    R"svg(#section-svg .section_end{{text-anchor:end}})svg"
    R"svg(#section-svg .section_halo{{paint-order:stroke;stroke:#fff;stroke-width:4px}})svg"
    R"svg(#section-svg .section_middle{{text-anchor:middle}}</style>
<defs><pattern id='section_unknown' patternUnits='userSpaceOnUse' width='{6}' height='{6}')svg"
    R"svg( patternTransform='rotate(45)'><path d='M0 0v{6}' stroke='#6b7280' stroke-width='{7}'/>)svg"
    R"svg(</pattern><pattern id='section_stops' patternUnits='userSpaceOnUse' width='{8}')svg"
    R"svg( height='{8}' patternTransform='rotate(-45)'><rect width='{8}' height='{8}')svg"
    R"svg( fill='#c2410c'/><path d='M0 0v{8}' stroke='#ffedd5' stroke-width='{9}'/></pattern></defs>
<rect width="{0}" height="{1}" fill="#fff"/>
)svg";

/// A coordinate of the picture with two digits.
double px(double value) {
  const double rounded = std::round(value * 100) / 100;
  return rounded == 0 ? 0.0 : rounded;
}

/// The words in lines of at most so many letters.
std::vector<std::string> wrapped(const std::string& words, std::size_t most) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    if (!lines.back().empty() && lines.back().size() + 1 + end - at > most) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + words.substr(at, end - at);
    at = end + 1;
  }
  return lines;
}

/// Whole steps of 1, 2 or 5 times a power of ten from `from` to `to`, about `most` of them.
std::vector<double> ticks(double from, double to, double most) {
  const double power = std::pow(10, std::floor(std::log10((to - from) / most)));
  double step = 10 * power;
  for (const double times : {5.0, 2.0, 1.0}) {
    if ((to - from) / (times * power) <= most) step = times * power;
  }
  std::vector<double> out;
  for (double i = std::ceil(from / step - 1e-9); i * step <= to + 1e-9 * step; ++i) {
    out.push_back(i * step);
  }
  return out;
}

std::string signed_words(double value) {
  return (value < 0 ? "\u2212" : value > 0 ? "+" : "") + format_brief(std::abs(value));
}

/// A depth with two digits, rounded up.
std::string depth_words(double depth) {
  const double hundredths = std::ceil(depth * 100 - 1e-6);
  return hundredths < 1 ? "less than 0.01" : format_brief(hundredths / 100);
}

/// A place of the load in the picture, and its letter beside it.
struct Mark {
  const ShownPlace* place = nullptr;
  double x = 0, y = 0;              ///< of the deepest cell
  double label_x = 0, label_y = 0;  ///< of the letter
};

class Picture {
 public:
  Picture(const SectionView& view, bool whole) : view_(view), lattice_(view.lattice) {
    scale_ = std::min((kWidth - kLeft - kRight) / lattice_.columns, kMostHeight / lattice_.rows);
    width_ = scale_ * lattice_.columns;
    height_ = scale_ * lattice_.rows;
    left_ = kLeft + (kWidth - kLeft - kRight - width_) / 2;
    right_ = left_ + width_;
    const std::vector<std::string> title = whole ? title_lines() : std::vector<std::string>{};
    top_ = 30 + kLine * static_cast<double>(title.size());
    bottom_ = top_ + height_;
    for (std::size_t i = 0; i < title.size(); ++i) {
      text(16, 24 + kLine * static_cast<double>(i), title[i], i == 0 ? "section_title" : "");
    }
    draw_cells();
    for (std::size_t i = 0; i < view_.loads.size(); ++i) draw_load(i);
    draw_marks();
    draw_axes();
    y_ = bottom_ + 52;
    draw_legend();
    y_ += 34;
    if (whole) draw_list();
  }

  std::string svg() const {
    const double hatch = 8 / scale_;
    return fmt::format(kHead, kWidth, px(y_), left_, top_, scale_, markup_text(view_.sentence()),
                       hatch, 3 / scale_, hatch / 2, 1.4 / scale_) +
           out_ + "</svg>\n";
  }

 private:
  template <typename... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), text, std::forward<Args>(args)...);
  }

  double x_of(double y) const { return left_ + (lattice_.j_to - y / lattice_.cell) * scale_; }
  double y_of(double z) const { return top_ + (lattice_.k_to - z / lattice_.cell) * scale_; }

  void text(double x, double y, std::string_view words, std::string_view kind = "") {
    add(R"(<text x="{}" y="{}")", px(x), px(y));
    if (!kind.empty()) add(R"( class="{}")", kind);
    add(">{}</text>\n", markup_text(words));
  }

  void line(double x1, double y1, double x2, double y2, std::string_view how) {
    add("<path {} d=\"M{} {}L{} {}\"/>\n", how, px(x1), px(y1), px(x2), px(y2));
  }

  /// The field of the picture.
  void field(std::string_view how) {
    add("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {}/>\n", px(left_), px(top_),
        px(width_), px(height_), how);
  }

  std::vector<std::string> title_lines() const {
    const SectionPicture& picture = view_.picture;
    const SectionData& data = view_.section.data();
    std::vector<std::string> lines =
        wrapped(fmt::format("Cross-section{}{}, for a load from x = {} to {} {}",
                            picture.section_name.empty() ? "" : " of ", picture.section_name,
                            format_brief(data.parameters.rear), format_brief(data.parameters.front),
                            view_.unit),
                100);
    const auto add = [&](std::string words) {
      words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
      for (std::string& line : wrapped(words + ".", 132)) lines.push_back(std::move(line));
    };
    add(view_.sentence());
    add(view_.caution());
    for (const Message& warning : data.warnings) add("warning: " + warning.text);
    return lines;
  }

  /// Draws those cells of a list, ascending by k and j, that are wanted; nothing where there are
  /// none and `if_any` is set.
  template <typename Wanted>
  void fill(std::string_view how, const SectionCells& cells, bool if_any, const Wanted& wanted) {
    std::string path;
    for (std::size_t i = 0, end = 0; i < cells.size(); i = end) {
      end = i + 1;
      if (!wanted(i)) continue;
      while (end < cells.size() && cells.k[end] == cells.k[i] &&
             cells.j[end] == cells.j[end - 1] + 1 && wanted(end)) {
        ++end;
      }
      fmt::format_to(std::back_inserter(path), "M{} {}h{}v1h-{}z", cells.j[i] - lattice_.j_from,
                     cells.k[i] - lattice_.k_from, end - i, end - i);
    }
    if (!path.empty() || !if_any) add("<path {} d=\"{}\"/>\n", how, path);
  }

  /// The number of the colour of a pose.
  std::size_t colour_of(std::uint32_t pose) const {
    const std::vector<double>& chainage = view_.section.data().chainage;
    if (!(chainage.back() > 0)) return 0;
    const double part = chainage[pose] / chainage.back();
    return std::min(kSectionColours.size() - 1,
                    static_cast<std::size_t>(part * static_cast<double>(kSectionColours.size())));
  }

  void draw_cells() {
    field(R"(fill="#fff")");
    constexpr std::string_view kGrid = R"(stroke="#e5e7eb")";
    for (const double y : y_ticks()) line(x_of(y), top_, x_of(y), bottom_, kGrid);
    for (const double z : z_ticks()) line(left_, y_of(z), right_, y_of(z), kGrid);
    add("<g id=\"section-cells\" shape-rendering=\"crispEdges\" transform=\"matrix({0} 0 0 {0} {1} "
        "{2})\">\n",
        -scale_, right_, bottom_);
    const SectionCells& cells = view_.section.cells();
    fill("class=\"unknown\" fill=\"url(#section_unknown)\"", view_.section.unknown_cells(), true,
         [](std::size_t) { return true; });
    for (std::size_t colour = 0; colour < kSectionColours.size(); ++colour) {
      fill(fmt::format(R"(fill="{}")", kSectionColours[colour]), cells, true,
           [&](std::size_t i) { return colour_of(cells.first_pose[i]) == colour; });
    }
    if (!view_.stopping.empty()) {
      fill("class=\"stops\" fill=\"url(#section_stops)\"", cells, false,
           [&](std::size_t i) { return view_.stopping[i]; });
    }
    add("</g>\n");
  }

  void draw_load(std::size_t index) {
    const ShownLoad& load = view_.loads[index];
    std::string path;
    for (const OutlinePoint& p : load.outline) {
      path += fmt::format("{}{} {}", path.empty() ? "M" : "L", px(x_of(p.y)), px(y_of(p.z)));
    }
    path += "Z";
    const char* const colour = kLoadColours[index % kLoadColours.size()];
    add("<g class=\"section_load\" data-load=\"{}\">\n", index);
    if (const double band = 2 * load.margin / lattice_.cell * scale_; band > 0) {
      add(R"(<clipPath id="section_outside{}"><path clip-rule="evenodd" d="M{} {}h{}v{}h-{}z{}"/>)"
          "</clipPath>\n",
          index, px(left_), px(top_), px(width_), px(height_), px(width_), path);
      add("<path class='section_margin' clip-path='url(#section_outside{})' fill='none' "
          "stroke='{}' "
          "stroke-opacity='0.35' stroke-linejoin='round' stroke-width=\"{}\" d=\"{}\"/>\n",
          index, colour, px(band), path);
    }
    add("<path fill=\"none\" stroke=\"#fff\" stroke-width=\"5\" d=\"{}\"/>\n", path);
    add("<path class=\"section_outline\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.6\" "
        "d=\"{}\"/>\n</g>\n",
        colour, path);
  }

  std::vector<double> y_ticks() const {
    return ticks(lattice_.j_from * lattice_.cell, lattice_.j_to * lattice_.cell, 14);
  }
  std::vector<double> z_ticks() const {
    return ticks(lattice_.k_from * lattice_.cell, lattice_.k_to * lattice_.cell, 10);
  }

  void draw_axes() {
    constexpr std::string_view kInk = R"(fill="none" stroke="#111827")";
    field(kInk);
    if (x_of(0) >= left_ && x_of(0) <= right_) {
      line(x_of(0), top_, x_of(0), bottom_, std::string(kInk) + R"( stroke-dasharray="2 4")");
    }
    for (const double y : y_ticks()) {
      line(x_of(y), bottom_, x_of(y), bottom_ + 5, kInk);
      text(x_of(y), bottom_ + 19, signed_words(y), "section_middle");
    }
    for (const double z : z_ticks()) {
      line(left_ - 5, y_of(z), left_, y_of(z), kInk);
      text(left_ - 9, y_of(z) + 4, signed_words(z), "section_end section_halo");
    }
    text(left_, bottom_ + 40, "\u2190 left of the path", "section_strong");
    text(left_ + width_ / 2, bottom_ + 40, "y (" + view_.unit + "), looking forward",
         "section_middle section_strong");
    text(right_, bottom_ + 40, "right of the path \u2192", "section_end section_strong");
    text(left_, top_ - 9, "height z (" + view_.unit + ")", "section_strong");
  }

  /// Writes letters of the deepest places, on each side below each other beside the picture, and
  /// each as near to the height of its place as its neighbours let it. Those that do not fit get no
  /// mark.
  std::vector<Mark> find_marks() const {
    std::array<std::vector<Mark>, 2> sides;
    const auto fits = static_cast<std::size_t>(std::max(1.0, std::floor(height_ / kMarkStep)));
    for (const ShownPlace& place : view_.places) {
      if (static_cast<std::size_t>(&place - view_.places.data()) == kMostMarks) break;
      const double x = x_of((place.cell[0] + 0.5) * lattice_.cell);
      const bool is_left = x < left_ + width_ / 2;
      if (sides[is_left].size() == fits) continue;
      sides[is_left].push_back({&place, x, y_of((place.cell[1] + 0.5) * lattice_.cell),
                                is_left ? left_ - 66 : right_ + 30});
    }
    std::vector<Mark> marks;
    for (std::vector<Mark>& side : sides) {
      std::ranges::stable_sort(side, {}, &Mark::y);
      double next = top_;
      for (Mark& mark : side) {
        mark.label_y = std::max(mark.y, next);
        next = mark.label_y + kMarkStep;
      }
      next = bottom_;
      for (auto mark = side.rbegin(); mark != side.rend(); ++mark) {
        mark->label_y = std::min(mark->label_y, next);
        next = mark->label_y - kMarkStep;
      }
      marks.insert(marks.end(), side.begin(), side.end());
    }
    std::ranges::sort(marks, {}, &Mark::place);
    return marks;
  }

  void draw_marks() {
    marks_ = find_marks();
    add("<g id=\"section-marks\">\n");
    for (const Mark& mark : marks_) {
      const double end = mark.label_x + (mark.label_x < left_ ? 15 : -15);
      line(mark.x, mark.y, end, mark.label_y, R"(stroke="#fff" stroke-width="4")");
      line(mark.x, mark.y, end, mark.label_y, R"(stroke="#111827" stroke-width="1.3")");
    }
    for (const Mark& mark : marks_) {
      add(R"(<circle cx="{}" cy="{}" r="4" fill="#fff" stroke="#111827" stroke-width="2"/>)",
          px(mark.x), px(mark.y));
      add("<rect x=\"{}\" y=\"{}\" width=\"30\" height=\"20\" rx=\"10\" fill=\"#fff\" "
          "stroke=\"#111827\" stroke-width=\"1.5\"/>\n",
          px(mark.label_x - 15), px(mark.label_y - 10));
      text(mark.label_x, mark.label_y + 4.5, mark.place->label, "section_middle section_strong");
    }
    add("</g>\n");
  }

  /// A sample of the legend with its words, and the next line where they do not fit into this one.
  void legend_item(const std::string& sample, const std::string& words) {
    const double wide = 34 + kLetter * static_cast<double>(words.size()) + 16;
    if (x_ + wide > kWidth - 10) next_line();
    add("<g transform=\"translate({} {})\">{}</g>\n", px(x_), px(y_), sample);
    text(x_ + 30, y_ + 12, words);
    x_ += wide;
  }

  void next_line() {
    x_ = 16;
    y_ += 24;
  }

  void draw_legend() {
    const std::vector<double>& chainage = view_.section.data().chainage;
    const double length = chainage.empty() ? 0 : chainage.back();
    const auto box = [](const char* fill) {
      return fmt::format(R"(<rect width="24" height="15" fill="{}" stroke="#6b7280"/>)", fill);
    };
    const auto patterned = [&](const char* name) {
      return fmt::format(
          "<g transform=\"scale({})\"><rect width=\"{}\" height=\"{}\" fill=\"url(#{})\"/></g>",
          px(scale_), px(24 / scale_), px(15 / scale_), name);
    };
    for (std::size_t i = 0; i < kSectionColours.size() && length > 0; ++i) {
      const auto at = [&](std::size_t part) {
        return format_brief(length * static_cast<double>(part) /
                            static_cast<double>(kSectionColours.size()));
      };
      legend_item(box(kSectionColours[i]),
                  i == 0 ? "blocked first at chainage 0 to " + at(1) + " " + view_.unit
                         : at(i) + " to " + at(i + 1));
    }
    next_line();
    legend_item(box("#fff"), "no point");
    if (view_.not_known().size() > 0) legend_item(patterned("section_unknown"), "not known");
    draw_legend_of_loads();
    if (view_.stops.empty()) return;
    legend_item(patterned("section_stops"), "stops the load");
    legend_item(R"(<rect x="2" y="-1" width="20" height="18" rx="9" fill="#fff" )"
                R"(stroke="#111827" stroke-width="1.5"/>)",
                "a place that stops the load, with its letter");
  }

  void draw_legend_of_loads() {
    const std::vector<ShownLoad>& loads = view_.loads;
    for (std::size_t i = 0; i < std::min(loads.size(), kMostLegends); ++i) {
      const std::string line =
          fmt::format(R"(<path d="M0 8h24" stroke="{}")", kLoadColours[i % kLoadColours.size()]);
      const std::string margin = format_brief(loads[i].margin) + " " + view_.unit;
      const bool is_one = loads.size() == 1, has_margin = loads[i].margin > 0;
      legend_item(line + R"( stroke-width="3"/>)",
                  is_one       ? "load"
                  : has_margin ? loads[i].outline_name + ", margin " + margin
                               : loads[i].outline_name);
      if (!is_one || !has_margin) continue;
      legend_item(line + R"( stroke-opacity="0.35" stroke-width="10"/>)", "its margin, " + margin);
    }
    if (loads.size() <= kMostLegends) return;
    legend_item("", "and " + counted(loads.size() - kMostLegends, "further outline"));
  }

  /// What each letter stands for: where, how deep, and what it is.
  void draw_list() {
    const auto add_line = [&](const std::string& words) {
      text(52, y_, words);
      y_ += kLine;
    };
    for (const Mark& mark : marks_) {
      const ShownPlace& place = *mark.place;
      std::string words = fmt::format(
          "{}{}{}, chainage {} to {} {unit}: reaches {} {unit} too far, z = {} to {} {unit}",
          place.obstacle, place.obstacle.empty() ? "" : ", ", name_of(place.side),
          format_brief(place.chainage_from), format_brief(place.chainage_to),
          depth_words(place.depth), format_brief(place.z_from), format_brief(place.z_to),
          fmt::arg("unit", view_.unit));
      if (view_.loads.size() > 1) words += ", of " + view_.loads[place.load].outline_name;
      if (place.witness) words += ", point " + std::to_string(place.witness->source);
      text(40, y_, place.label, "section_end section_strong");
      for (const std::string& part : wrapped(words, 132)) add_line(part);
    }
    if (const std::size_t more = view_.places.size() - marks_.size(); more > 0) {
      add_line("and " + counted(more, "place") + " less deep");
    }
    y_ += 4;
  }

  const SectionView& view_;
  const SectionLattice& lattice_;
  double scale_ = 1, width_ = 0, height_ = 0, left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;
  double x_ = 16, y_ = 0;  ///< of what is written next below the picture
  std::vector<Mark> marks_;
  std::string out_;
};

}  // namespace

std::string section_svg(const SectionView& view, bool whole) { return Picture(view, whole).svg(); }

}  // namespace clearway
