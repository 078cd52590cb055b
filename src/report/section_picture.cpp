#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/text_writer.hpp"
#include "io/result/conflicts/markup_text.hpp"
#include "report/section_view.hpp"
#include "report/section_words.hpp"

namespace clearway {
namespace {

constexpr double kWidth = 1000, kLeft = 66, kRight = 22, kMostHeight = 640;
constexpr double kLetter = 6.9;  ///< width of a letter of 13 pixels
constexpr std::size_t kMostMarks = 24;
constexpr int kColours = static_cast<int>(kSectionColours.size());

/// A coordinate of the picture with two digits.
std::string px(double value) {
  const double rounded = std::round(value * 100) / 100;
  TextBuffer out;
  out << (rounded == 0 ? 0.0 : rounded);
  return out.text();
}

/// Numbers such as "1-4, 6".
std::string list_of(std::vector<std::size_t> numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  std::string out;
  for (const std::string& range : number_ranges(numbers)) out += (out.empty() ? "" : ", ") + range;
  return out;
}

/// Intrusions of several stretches by the same obstacle, or by points that lie close together.
struct Mark {
  const ShownIntrusion* deepest = nullptr;
  std::vector<std::size_t> stops = {};  ///< numbers of the stops, from 1
  double chainage_from = 0, chainage_to = 0;
  double x = 0, y = 0;  ///< of its label

  /// The obstacle's name, or the numbers of the stretches that it stops.
  std::string label() const {
    constexpr std::size_t kLongestName = 24;
    const std::string& name = deepest->obstacle;
    return !name.empty() && name.size() <= kLongestName ? name : list_of(stops);
  }
};

/// Whether two intrusions get one mark: they have the same name, or none and lie close together, in
/// the environment or in the picture.
bool have_one_mark(const ShownIntrusion& a, const ShownIntrusion& b, double close_cells) {
  if (a.intrusion.side != b.intrusion.side) return false;
  if (!a.obstacle.empty() || !b.obstacle.empty()) return a.obstacle == b.obstacle;
  constexpr double kClose = 3;
  if (a.witness && b.witness && length(a.witness->xyz - b.witness->xyz) < kClose) return true;
  return std::hypot(a.intrusion.cell[0] - b.intrusion.cell[0],
                    a.intrusion.cell[1] - b.intrusion.cell[1]) < close_cells;
}

class Picture {
 public:
  Picture(const SectionView& view, bool whole)
      : view_(view), lattice_(view.lattice()), whole_(whole) {
    scale_ = std::min((kWidth - kLeft - kRight) / lattice_.columns, kMostHeight / lattice_.rows);
    width_ = scale_ * lattice_.columns;
    height_ = scale_ * lattice_.rows;
    left_ = kLeft + (kWidth - kLeft - kRight - width_) / 2;
    find_marks();
  }

  std::string svg() {
    const std::vector<std::string> title = whole_ ? title_lines() : std::vector<std::string>{};
    top_ = 30 + 19 * static_cast<double>(title.size());
    place_marks();
    TextBuffer body;
    std::swap(body, out_);
    for (std::size_t i = 0; i < title.size(); ++i) {
      text(16, 24 + 19 * static_cast<double>(i), title[i], i == 0 ? "section_title" : "");
    }
    draw_cells();
    draw_load();
    draw_axes();
    draw_marks();
    double bottom = draw_legend(top_ + height_ + 52);
    if (whole_) bottom = draw_list(bottom);
    std::swap(body, out_);
    return head(bottom) + body.text() + "</svg>\n";
  }

 private:
  std::string head(double bottom) const {
    TextBuffer out;
    const std::string size = " viewBox=\"0 0 " + px(kWidth) + " " + px(bottom) + "\" width=\"" +
                             px(kWidth) + "\" height=\"" + px(bottom) + "\"";
    out << R"(<svg xmlns="http://www.w3.org/2000/svg" id="section-svg")" << size << " data-left=\""
        << left_ << "\" data-top=\"" << top_ << "\" data-scale=\"" << scale_
        << "\" role=\"img\" aria-label=\"" << markup_text(view_.sentence()) << "\">\n"
        << "<style>#section-svg text{font:13px system-ui,\"DejaVu "
           "Sans\",Arial,sans-serif;fill:#374151}"
           "#section-svg .section_title{font-size:16px;font-weight:600;fill:#111827}"
           "#section-svg .section_strong{font-weight:600;fill:#111827}"
           "#section-svg .section_end{text-anchor:end}#section-svg "
           ".section_middle{text-anchor:middle}"
           "</style>\n";
    const double hatch = 8 / scale_;
    const auto pattern = [&](const char* name, double side, int turn) {
      out << "<pattern id='" << name << "' patternUnits='userSpaceOnUse' width='" << side
          << "' height='" << side << "' patternTransform='rotate(" << turn << ")'>";
    };
    out << "<defs>";
    pattern("section_unknown", hatch, 45);
    out << "<path d='M0 0v" << hatch << "' stroke='#6b7280' stroke-width='" << 3 / scale_
        << "'/></pattern>";
    pattern("section_stops", hatch / 2, -45);
    out << "<rect width='" << hatch / 2 << "' height='" << hatch / 2
        << "' fill='#c2410c'/><path d='M0 0v" << hatch / 2 << "' stroke='#ffedd5' stroke-width='"
        << 1.4 / scale_ << "'/></pattern></defs>\n";
    out << "<rect width=\"" << px(kWidth) << "\" height=\"" << px(bottom) << "\" fill=\"#fff\"/>\n";
    return out.text();
  }

  double x_of(double y) const { return left_ + (lattice_.j_to - y / lattice_.cell) * scale_; }
  double y_of(double z) const { return top_ + (lattice_.k_to - z / lattice_.cell) * scale_; }

  void text(double x, double y, std::string_view words, const char* kind = "") {
    out_ << "<text x=\"" << px(x) << "\" y=\"" << px(y) << "\"";
    if (*kind != '\0') out_ << " class=\"" << kind << "\"";
    out_ << ">" << markup_text(words) << "</text>\n";
  }

  /// The words in lines that fit the width.
  static std::vector<std::string> wrapped(const std::string& words, std::size_t most) {
    std::vector<std::string> lines(1);
    std::size_t at = 0;
    while (at < words.size()) {
      const std::size_t end = std::min(words.find(' ', at), words.size());
      const std::string word = words.substr(at, end - at);
      if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) {
        lines.emplace_back();
      }
      lines.back() += (lines.back().empty() ? "" : " ") + word;
      at = end + 1;
    }
    return lines;
  }

  std::vector<std::string> title_lines() const {
    const SectionPicture& picture = view_.picture();
    const SectionParameters& asked = view_.section().data().parameters;
    std::string name = "Cross-section";
    if (!picture.section_name.empty()) name += " of " + picture.section_name;
    name += ", for a load from x = " + format_brief(asked.rear) + " to " +
            format_brief(asked.front) + " " + view_.unit();
    std::vector<std::string> lines{name};
    const auto add = [&](std::string words) {
      words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
      for (std::string& line : wrapped(words + ".", 132)) lines.push_back(std::move(line));
    };
    add(view_.sentence());
    add(view_.caution());
    for (const Message& warning : view_.section().data().warnings) {
      add("warning: " + warning.text);
    }
    return lines;
  }

  /// The path of those cells of a list, ascending by k and j, that are wanted.
  template <typename Wanted>
  std::string runs(const SectionCells& cells, const Wanted& wanted) const {
    TextBuffer path;
    for (std::size_t i = 0; i < cells.size();) {
      if (!wanted(i)) {
        ++i;
        continue;
      }
      std::size_t end = i + 1;
      while (end < cells.size() && cells.k[end] == cells.k[i] &&
             cells.j[end] == cells.j[end - 1] + 1 && wanted(end)) {
        ++end;
      }
      const auto length = end - i;
      path << "M" << cells.j[i] - static_cast<std::int32_t>(lattice_.j_from) << " "
           << cells.k[i] - static_cast<std::int32_t>(lattice_.k_from) << "h" << length << "v1h-"
           << length << "z";
      i = end;
    }
    return path.text();
  }

  int colour_of(std::uint32_t pose) const {
    const std::vector<double>& chainage = view_.section().data().chainage;
    const double length = chainage.back();
    if (!(length > 0)) return 0;
    return std::min(kColours - 1, static_cast<int>(chainage[pose] / length * kColours));
  }

  void draw_cells() {
    const SectionCells& cells = view_.section().cells();
    out_ << "<rect x=\"" << px(left_) << "\" y=\"" << px(top_) << "\" width=\"" << px(width_)
         << "\" height=\"" << px(height_) << "\" fill=\"#fff\"/>\n";
    draw_grid();
    out_ << "<g id=\"section-cells\" shape-rendering=\"crispEdges\" transform=\"matrix(" << -scale_
         << " 0 0 " << -scale_ << " " << left_ + width_ << " " << top_ + height_ << ")\">\n";
    const SectionCells& unknown = view_.section().unknown_cells();
    if (unknown.size() > 0) {
      out_ << "<path class=\"unknown\" fill=\"url(#section_unknown)\" d=\""
           << runs(unknown, [](std::size_t) { return true; }) << "\"/>\n";
    }
    for (int colour = 0; colour < kColours; ++colour) {
      const std::string path =
          runs(cells, [&](std::size_t i) { return colour_of(cells.first_pose[i]) == colour; });
      if (path.empty()) continue;
      out_ << "<path fill=\"" << kSectionColours[static_cast<std::size_t>(colour)] << "\" d=\""
           << path << "\"/>\n";
    }
    const std::vector<bool>& stopping = view_.stopping();
    if (!stopping.empty()) {
      out_ << "<path class=\"stops\" fill=\"url(#section_stops)\" d=\""
           << runs(cells, [&](std::size_t i) { return stopping[i]; }) << "\"/>\n";
    }
    out_ << "</g>\n";
  }

  std::string outline_path() const {
    std::string path;
    for (const OutlinePoint& p : view_.picture().outline) {
      path += (path.empty() ? "M" : "L") + px(x_of(p.y)) + " " + px(y_of(p.z));
    }
    return path + "Z";
  }

  void draw_load() {
    if (view_.picture().outline.empty()) return;
    const std::string path = outline_path();
    const double band = 2 * view_.margin() / lattice_.cell * scale_;
    if (band > 0) {
      out_ << R"(<clipPath id="section_outside"><path clip-rule="evenodd" d="M)" << px(left_) << " "
           << px(top_) << "h" << px(width_) << "v" << px(height_) << "h-" << px(width_) << "z"
           << path << "\"/></clipPath>\n"
           << "<path class='section_margin' clip-path='url(#section_outside)' fill='none' "
              "stroke='#7c3aed' "
              "stroke-opacity='0.35' stroke-linejoin='round' stroke-width=\""
           << px(band) << "\" d=\"" << path << "\"/>\n";
    }
    out_ << R"(<path fill="none" stroke="#fff" stroke-width="5" d=")" << path << "\"/>\n"
         << R"(<path class="section_outline" fill="none" stroke="#5b21b6" stroke-width="2.6" d=")"
         << path << "\"/>\n";
  }

  /// Whole steps of 1, 2 or 5 times a power of ten from `from` to `to`, about `most` of them.
  static std::vector<double> ticks(double from, double to, double most) {
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

  std::vector<double> y_ticks() const {
    return ticks(lattice_.j_from * lattice_.cell, lattice_.j_to * lattice_.cell, 14);
  }
  std::vector<double> z_ticks() const {
    return ticks(lattice_.k_from * lattice_.cell, lattice_.k_to * lattice_.cell, 10);
  }

  void line(double x1, double y1, double x2, double y2, const char* how) {
    out_ << "<path " << how << " d=\"M" << px(x1) << " " << px(y1) << "L" << px(x2) << " " << px(y2)
         << "\"/>\n";
  }

  void draw_grid() {
    constexpr const char* kGrid = R"(stroke="#e5e7eb")";
    for (const double y : y_ticks()) line(x_of(y), top_, x_of(y), top_ + height_, kGrid);
    for (const double z : z_ticks()) line(left_, y_of(z), left_ + width_, y_of(z), kGrid);
  }

  static std::string signed_words(double value) {
    const std::string digits = format_brief(std::abs(value));
    return value == 0 ? "0" : (value < 0 ? "\u2212" : "+") + digits;
  }

  void draw_axes() {
    constexpr const char* kInk = R"(fill="none" stroke="#111827")";
    out_ << "<rect x=\"" << px(left_) << "\" y=\"" << px(top_) << "\" width=\"" << px(width_)
         << "\" height=\"" << px(height_) << "\" " << kInk << "/>\n";
    if (x_of(0) >= left_ && x_of(0) <= left_ + width_) {
      line(x_of(0), top_, x_of(0), top_ + height_,
           R"(fill="none" stroke="#111827" stroke-dasharray="2 4")");
    }
    const double bottom = top_ + height_;
    for (const double y : y_ticks()) {
      line(x_of(y), bottom, x_of(y), bottom + 5, kInk);
      text(x_of(y), bottom + 19, signed_words(y), "section_middle");
    }
    for (const double z : z_ticks()) {
      line(left_ - 5, y_of(z), left_, y_of(z), kInk);
      text(left_ - 9, y_of(z) + 4, signed_words(z), "section_end");
    }
    text(left_, bottom + 40, "\u2190 left of the path", "section_strong");
    text(left_ + width_ / 2, bottom + 40, "y (" + view_.unit() + "), looking forward",
         "section_middle section_strong");
    text(left_ + width_, bottom + 40, "right of the path \u2192", "section_end section_strong");
    text(left_, top_ - 9, "height z (" + view_.unit() + ")", "section_strong");
  }

  void find_marks() {
    const std::vector<ShownStop>& stops = view_.stops();
    for (std::size_t s = 0; s < stops.size(); ++s) {
      for (const ShownIntrusion& in : stops[s].intrusions) {
        constexpr double kClosePixels = 40;
        const auto known = std::ranges::find_if(marks_, [&](const Mark& mark) {
          return have_one_mark(*mark.deepest, in, kClosePixels / scale_);
        });
        Mark& mark = known == marks_.end() ? marks_.emplace_back() : *known;
        const double chainage = in.intrusion.chainage;
        if (mark.deepest == nullptr) mark.chainage_from = mark.chainage_to = chainage;
        mark.chainage_from = std::min(mark.chainage_from, chainage);
        mark.chainage_to = std::max(mark.chainage_to, chainage);
        if (mark.deepest == nullptr || in.intrusion.depth > mark.deepest->intrusion.depth) {
          mark.deepest = &in;
        }
        mark.stops.push_back(s + 1);
      }
    }
    std::ranges::stable_sort(marks_, [](const Mark& a, const Mark& b) {
      return a.deepest->intrusion.depth > b.deepest->intrusion.depth;
    });
    more_marks_ = marks_.size() > kMostMarks ? marks_.size() - kMostMarks : 0;
    if (marks_.size() > kMostMarks) marks_.resize(kMostMarks);
    std::ranges::stable_sort(marks_, {}, [](const Mark& mark) { return mark.stops.front(); });
  }

  std::array<double, 2> place_of(const Mark& mark) const {
    const auto& cell = mark.deepest->intrusion.cell;
    return {x_of((cell[0] + 0.5) * lattice_.cell), y_of((cell[1] + 0.5) * lattice_.cell)};
  }

  static double half_width(const Mark& mark) {
    return 8 + 0.56 * kLetter * static_cast<double>(mark.label().size());
  }

  /// Puts each label near its cell, where no other label is.
  void place_marks() {
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const auto [x, y] = place_of(marks_[i]);
      constexpr int kMostAttempts = 1500;
      for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
        const double angle = -0.9 + 2.4 * attempt, far = 26 + 0.4 * attempt;
        marks_[i].x = x + 1.5 * far * std::cos(angle);
        marks_[i].y = y + far * std::sin(angle);
        if (is_free(i)) break;
      }
    }
  }

  bool is_free(std::size_t i) const {
    const Mark& mark = marks_[i];
    const double half = half_width(mark);
    if (mark.x - half < left_ || mark.x + half > left_ + width_ || mark.y - 11 < top_ ||
        mark.y + 11 > top_ + height_) {
      return false;
    }
    for (std::size_t other = 0; other < marks_.size(); ++other) {
      const auto [x, y] = place_of(marks_[other]);
      if (std::abs(x - mark.x) < half + 3 && std::abs(y - mark.y) < 14) return false;
      if (other < i && std::abs(marks_[other].x - mark.x) < half + half_width(marks_[other]) + 2 &&
          std::abs(marks_[other].y - mark.y) < 23) {
        return false;
      }
    }
    return true;
  }

  void draw_marks() {
    out_ << "<g id=\"section-marks\">\n";
    for (const Mark& mark : marks_) {
      const auto [x, y] = place_of(mark);
      line(x, y, mark.x, mark.y, R"(stroke="#fff" stroke-width="4")");
      line(x, y, mark.x, mark.y, R"(stroke="#111827" stroke-width="1.5")");
    }
    for (const Mark& mark : marks_) {
      const auto [x, y] = place_of(mark);
      out_ << "<circle cx=\"" << px(x) << "\" cy=\"" << px(y)
           << R"(" r="4" fill="#fff" stroke="#111827" stroke-width="2"/>)"
           << "<rect x=\"" << px(mark.x - half_width(mark)) << "\" y=\"" << px(mark.y - 10)
           << "\" width=\"" << px(2 * half_width(mark))
           << R"(" height="20" rx="10" fill="#fff" stroke="#111827" stroke-width="1.5"/>)"
           << "\n";
      text(mark.x, mark.y + 4.5, mark.label(), "section_middle section_strong");
    }
    out_ << "</g>\n";
  }

  /// A sample of the legend with its words; the place moves on.
  void legend_item(double& x, double& y, const std::string& sample, const std::string& words) {
    const double wide = 34 + kLetter * static_cast<double>(words.size()) + 16;
    if (x + wide > kWidth - 10) {
      x = 16;
      y += 24;
    }
    out_ << "<g transform=\"translate(" << px(x) << " " << px(y) << ")\">" << sample << "</g>\n";
    text(x + 30, y + 12, words);
    x += wide;
  }

  double draw_legend(double y) {
    const SectionData& data = view_.section().data();
    const auto box = [](const std::string& fill) {
      return "<rect width=\"24\" height=\"15\" fill=\"" + fill + "\" stroke=\"#6b7280\"/>";
    };
    double x = 16;
    const double length = data.chainage.empty() ? 0 : data.chainage.back();
    const auto at = [&](int part) { return format_brief(length * part / kColours); };
    for (int colour = 0; colour < kColours && length > 0; ++colour) {
      const std::string words = colour == 0
                                    ? "blocked first at chainage 0 to " + at(1) + " " + view_.unit()
                                    : at(colour) + " to " + at(colour + 1);
      legend_item(x, y, box(kSectionColours[static_cast<std::size_t>(colour)]), words);
    }
    x = 16;
    y += 24;
    const double zoom = scale_;
    const auto patterned = [&](const char* name) {
      return "<g transform=\"scale(" + px(zoom) + ")\"><rect width=\"" + px(24 / zoom) +
             "\" height=\"" + px(15 / zoom) + "\" fill=\"url(#" + name + ")\"/></g>";
    };
    legend_item(x, y, box("#fff"), "no point");
    if (view_.not_known().size() > 0) {
      legend_item(x, y, patterned("section_unknown"), "not known");
    }
    if (view_.check()) {
      legend_item(x, y, R"(<path d="M0 8h24" stroke="#5b21b6" stroke-width="3"/>)", "load");
      if (view_.margin() > 0) {
        legend_item(x, y,
                    R"(<path d="M0 8h24" stroke="#7c3aed" stroke-opacity="0.35" )"
                    R"(stroke-width="10"/>)",
                    "its margin, " + format_brief(view_.margin()) + " " + view_.unit());
      }
      if (!view_.stops().empty()) {
        legend_item(x, y, patterned("section_stops"), "stops the load");
        legend_item(x, y,
                    R"(<rect x="2" y="-1" width="20" height="18" rx="9" fill="#fff" )"
                    R"(stroke="#111827" stroke-width="1.5"/>)",
                    "what it is, or the numbers of the stretches, and its deepest place");
      }
    }
    return y + 34;
  }

  /// A depth with two digits, rounded up.
  static std::string depth_words(double depth) {
    const double hundredths = std::ceil(depth * 100 - 1e-6);
    return hundredths < 1 ? "less than 0.01" : format_brief(hundredths / 100);
  }

  /// One line for each mark: where, how deep, and what it is.
  double draw_list(double y) {
    const std::string unit = view_.unit();
    for (const Mark& mark : marks_) {
      const SectionIntrusion& in = mark.deepest->intrusion;
      std::string words =
          std::string(name_of(in.side)) + ", chainage " + format_brief(mark.chainage_from);
      if (mark.chainage_to != mark.chainage_from) words += " to " + format_brief(mark.chainage_to);
      words += " " + unit + (mark.stops.size() == 1 ? ", stretch " : ", stretches ") +
               list_of(mark.stops) + ": reaches " + depth_words(in.depth) + " " + unit +
               " too far, z = " + format_brief(in.z_from) + " to " + format_brief(in.z_to) + " " +
               unit;
      if (mark.deepest->witness) {
        words += ", point " + std::to_string(mark.deepest->witness->source);
      }
      text(190, y, mark.label(), "section_end section_strong");
      text(202, y, words);
      y += 19;
    }
    if (more_marks_ > 0) {
      text(202, y, "and " + counted(more_marks_, "place") + " less deep");
      y += 19;
    }
    return y + 4;
  }

  const SectionView& view_;
  const SectionLattice& lattice_;
  const bool whole_;
  double scale_ = 1, width_ = 0, height_ = 0, left_ = 0, top_ = 0;
  std::vector<Mark> marks_;
  std::size_t more_marks_ = 0;
  TextBuffer out_;
};

}  // namespace

std::string section_svg(const SectionView& view, bool whole) { return Picture(view, whole).svg(); }

}  // namespace clearway
