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

constexpr double kWidth = 1000, kLeft = 94, kRight = 54, kMostHeight = 640;
constexpr double kLetter = 6.9;  ///< width of a letter of 13 pixels
constexpr std::size_t kMostMarks = 24;
constexpr std::size_t kMostLegends = 12;  ///< of outlines
/// Colours of the outlines, which begin again where there are more.
constexpr std::array<const char*, 5> kLoadColours{"#5b21b6", "#be123c", "#0369a1", "#a16207",
                                                  "#0f766e"};
constexpr int kColours = static_cast<int>(kSectionColours.size());

/// A coordinate of the picture with two digits.
std::string px(double value) {
  const double rounded = std::round(value * 100) / 100;
  TextBuffer out;
  out << (rounded == 0 ? 0.0 : rounded);
  return out.text();
}

/// A place of the load in the picture, and its letter beside it.
struct Mark {
  const ShownPlace* place = nullptr;
  double x = 0, y = 0;              ///< of the deepest cell
  double label_x = 0, label_y = 0;  ///< of the letter
};

class Picture {
 public:
  Picture(const SectionView& view, bool whole)
      : view_(view), lattice_(view.lattice()), whole_(whole) {
    scale_ = std::min((kWidth - kLeft - kRight) / lattice_.columns, kMostHeight / lattice_.rows);
    width_ = scale_ * lattice_.columns;
    height_ = scale_ * lattice_.rows;
    left_ = kLeft + (kWidth - kLeft - kRight - width_) / 2;
  }

  std::string svg() {
    const std::vector<std::string> title = whole_ ? title_lines() : std::vector<std::string>{};
    top_ = 30 + 19 * static_cast<double>(title.size());
    find_marks();
    TextBuffer body;
    std::swap(body, out_);
    for (std::size_t i = 0; i < title.size(); ++i) {
      text(16, 24 + 19 * static_cast<double>(i), title[i], i == 0 ? "section_title" : "");
    }
    draw_cells();
    draw_loads();
    draw_marks();
    draw_axes();
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
           ".section_halo{paint-order:stroke;"
           "stroke:#fff;stroke-width:4px}#section-svg "
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
    std::vector<std::string> lines = wrapped(name, 100);
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

  std::string outline_path(const ShownLoad& load) const {
    std::string path;
    for (const OutlinePoint& p : load.outline) {
      path += (path.empty() ? "M" : "L") + px(x_of(p.y)) + " " + px(y_of(p.z));
    }
    return path + "Z";
  }

  void draw_loads() {
    for (std::size_t i = 0; i < view_.loads().size(); ++i) draw_load(i);
  }

  void draw_load(std::size_t index) {
    const ShownLoad& load = view_.loads()[index];
    const std::string path = outline_path(load), number = std::to_string(index);
    const std::string colour = kLoadColours[index % kLoadColours.size()];
    const double band = 2 * load.margin / lattice_.cell * scale_;
    out_ << "<g class=\"section_load\" data-load=\"" << number << "\">\n";
    if (band > 0) {
      out_ << "<clipPath id=\"section_outside" << number << R"("><path clip-rule="evenodd" d="M)"
           << px(left_) << " " << px(top_) << "h" << px(width_) << "v" << px(height_) << "h-"
           << px(width_) << "z" << path << "\"/></clipPath>\n"
           << "<path class='section_margin' clip-path='url(#section_outside" << number
           << ")' fill='none' stroke='" << colour
           << "' stroke-opacity='0.35' stroke-linejoin='round' stroke-width=\"" << px(band)
           << "\" d=\"" << path << "\"/>\n";
    }
    out_ << R"(<path fill="none" stroke="#fff" stroke-width="5" d=")" << path << "\"/>\n"
         << R"(<path class="section_outline" fill="none" stroke=")" << colour
         << R"(" stroke-width="2.6" d=")" << path << "\"/>\n</g>\n";
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
      text(left_ - 9, y_of(z) + 4, signed_words(z), "section_end section_halo");
    }
    text(left_, bottom + 40, "\u2190 left of the path", "section_strong");
    text(left_ + width_ / 2, bottom + 40, "y (" + view_.unit() + "), looking forward",
         "section_middle section_strong");
    text(left_ + width_, bottom + 40, "right of the path \u2192", "section_end section_strong");
    text(left_, top_ - 9, "height z (" + view_.unit() + ")", "section_strong");
  }

  static constexpr double kLabelStep = 23;  ///< from one letter to the next below it

  /// Takes the deepest places, as many as have room for their letters on both sides.
  void find_marks() {
    for (const ShownPlace& place : view_.places()) {
      if (marks_.size() == kMostMarks) break;
      const auto& cell = place.deepest.intrusion.cell;
      marks_.push_back(
          {&place, x_of((cell[0] + 0.5) * lattice_.cell), y_of((cell[1] + 0.5) * lattice_.cell)});
    }
    for (const bool on_left : {true, false}) place_letters(on_left);
    std::erase_if(marks_, [](const Mark& mark) { return mark.label_x == 0; });
  }

  bool is_left(const Mark& mark) const { return mark.x < left_ + width_ / 2; }

  /// Writes the letters of one half of the picture below each other beside it, each as near to the
  /// height of its place as its neighbours let it. Those that do not fit get no place.
  void place_letters(bool on_left) {
    const auto fits = static_cast<std::size_t>(std::max(1.0, std::floor(height_ / kLabelStep)));
    std::vector<Mark*> column;
    for (Mark& mark : marks_) {
      if (is_left(mark) == on_left && column.size() < fits) column.push_back(&mark);
    }
    std::ranges::stable_sort(column, {}, [](const Mark* mark) { return mark->y; });
    double next = top_;
    for (Mark* mark : column) {
      mark->label_x = on_left ? left_ - 66 : left_ + width_ + 30;
      mark->label_y = std::max(mark->y, next);
      next = mark->label_y + kLabelStep;
    }
    next = top_ + height_;
    for (auto mark = column.rbegin(); mark != column.rend(); ++mark) {
      (*mark)->label_y = std::min((*mark)->label_y, next);
      next = (*mark)->label_y - kLabelStep;
    }
  }

  void draw_marks() {
    out_ << "<g id=\"section-marks\">\n";
    for (const Mark& mark : marks_) {
      const double end = mark.label_x + (is_left(mark) ? 15 : -15);
      line(mark.x, mark.y, end, mark.label_y, R"(stroke="#fff" stroke-width="4")");
      line(mark.x, mark.y, end, mark.label_y, R"(stroke="#111827" stroke-width="1.3")");
    }
    for (const Mark& mark : marks_) {
      out_ << "<circle cx=\"" << px(mark.x) << "\" cy=\"" << px(mark.y)
           << R"(" r="4" fill="#fff" stroke="#111827" stroke-width="2"/>)"
           << "<rect x=\"" << px(mark.label_x - 15) << "\" y=\"" << px(mark.label_y - 10)
           << R"(" width="30" height="20" rx="10" fill="#fff" stroke="#111827" )"
           << "stroke-width=\"1.5\"/>\n";
      text(mark.label_x, mark.label_y + 4.5, mark.place->label, "section_middle section_strong");
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

  void draw_legend_of_loads(double& x, double& y) {
    const std::vector<ShownLoad>& loads = view_.loads();
    for (std::size_t i = 0; i < std::min(loads.size(), kMostLegends); ++i) {
      const std::string colour = kLoadColours[i % kLoadColours.size()];
      const ShownLoad& load = loads[i];
      const std::string margin = format_brief(load.margin) + " " + view_.unit();
      const std::string line = "<path d=\"M0 8h24\" stroke=\"" + colour;
      if (loads.size() > 1) {
        legend_item(x, y, line + "\" stroke-width=\"3\"/>",
                    load.name + (load.margin > 0 ? ", margin " + margin : ""));
        continue;
      }
      legend_item(x, y, line + "\" stroke-width=\"3\"/>", "load");
      if (load.margin > 0) {
        legend_item(x, y, line + R"(" stroke-opacity="0.35" stroke-width="10"/>)",
                    "its margin, " + margin);
      }
    }
    if (loads.size() > kMostLegends) {
      legend_item(x, y, "", "and " + counted(loads.size() - kMostLegends, "further outline"));
    }
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
      draw_legend_of_loads(x, y);
      if (!view_.stops().empty()) {
        legend_item(x, y, patterned("section_stops"), "stops the load");
        legend_item(x, y,
                    R"(<rect x="2" y="-1" width="20" height="18" rx="9" fill="#fff" )"
                    R"(stroke="#111827" stroke-width="1.5"/>)",
                    "a place that stops the load, with its letter");
      }
    }
    return y + 34;
  }

  /// A depth with two digits, rounded up.
  static std::string depth_words(double depth) {
    const double hundredths = std::ceil(depth * 100 - 1e-6);
    return hundredths < 1 ? "less than 0.01" : format_brief(hundredths / 100);
  }

  /// What each letter stands for: where, how deep, and what it is.
  double draw_list(double y) {
    const std::string unit = view_.unit();
    for (const Mark& mark : marks_) {
      const ShownIntrusion& deepest = mark.place->deepest;
      const SectionIntrusion& in = deepest.intrusion;
      std::string words = deepest.obstacle.empty() ? "" : deepest.obstacle + ", ";
      words += std::string(name_of(in.side)) + ", chainage " +
               format_brief(mark.place->chainage_from) + " to " +
               format_brief(mark.place->chainage_to) + " " + unit + ": reaches " +
               depth_words(in.depth) + " " + unit + " too far, z = " + format_brief(in.z_from) +
               " to " + format_brief(in.z_to) + " " + unit;
      if (view_.loads().size() > 1) words += ", of " + view_.loads()[mark.place->load].name;
      if (deepest.witness) words += ", point " + std::to_string(deepest.witness->source);
      text(40, y, mark.place->label, "section_end section_strong");
      for (const std::string& part : wrapped(words, 132)) {
        text(52, y, part);
        y += 19;
      }
    }
    if (const std::size_t more = view_.places().size() - marks_.size(); more > 0) {
      text(52, y, "and " + counted(more, "place") + " less deep");
      y += 19;
    }
    return y + 4;
  }

  const SectionView& view_;
  const SectionLattice& lattice_;
  const bool whole_;
  double scale_ = 1, width_ = 0, height_ = 0, left_ = 0, top_ = 0;
  std::vector<Mark> marks_;
  TextBuffer out_;
};

}  // namespace

std::string section_svg(const SectionView& view, bool whole) { return Picture(view, whole).svg(); }

}  // namespace clearway
