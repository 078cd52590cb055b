#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/report.hpp"
#include "clearway/section.hpp"
#include "core/section/section_lattice.hpp"
#include "core/section/section_tables.hpp"
#include "io/files/json.hpp"
#include "report/page.hpp"

/// What pages and pictures show of a section. Members have the names of the page's facts.
namespace clearway {

/// An outline that is judged, on the whole path or on stretches of it.
struct ShownLoad {
  std::string outline_name = {};  ///< of its file; empty where it has none
  std::span<const OutlinePoint> outline = {};
  double margin = 0;                ///< the distance that it keeps
  std::vector<bool> stopping = {};  ///< stopping_cells()
};

/// An intrusion with what is known of the obstacle.
struct ShownIntrusion : SectionIntrusion {
  /// The border up to which everything has to be cleared: a y on the left and right, a z above and
  /// below.
  double clear_to = 0;
  std::optional<SectionWitness> witness = {};
  std::string obstacle = {};  ///< its name; empty where it has none
};

/// What stops a load in a stretch, and the sentence that says what would let it pass.
struct ShownStop {
  SectionStop stop;
  std::size_t load = 0;  ///< index of the load that is stopped
  std::string remedy = {};
  std::vector<ShownIntrusion> intrusions = {};
  std::vector<std::string> obstacles = {};  ///< names of all that are known to stop the load here
};

/// What reaches into the load in stretches one after the other: the same obstacle by its name or,
/// without names, intrusions of one side in neighbouring stretches that overlap across the path. It
/// is the deepest of these intrusions, with the heights of all.
struct ShownPlace : ShownIntrusion {
  std::string label = {};                     ///< "A", "B" and so on; A is the deepest
  std::size_t load = 0;                       ///< index of the load
  std::vector<std::size_t> stops = {};        ///< numbers of the stops, from 1, ascending
  double chainage_from = 0, chainage_to = 0;  ///< ends of its stretches
  std::string remedy = {};                    ///< what would free the load from it, in a sentence
};

/// All that is drawn and said of a section.
class SectionView {
 public:
  /// section and picture outlive this object. Throws as Section::check(), section_bands() and
  /// section_witnesses(), and UsageError where obstacles are given without store and path.
  SectionView(const Section& section, const SectionPicture& picture);

  const Section& section;
  const SectionPicture& picture;
  const SectionLattice lattice;
  const std::string unit;                       ///< symbol of the unit of lengths
  std::optional<OutlineTableCheck> check = {};  ///< none without an outline
  std::vector<ShownLoad> loads = {};    ///< the outlines that are judged, each with its margin once
  std::vector<ShownStop> stops = {};    ///< along the path
  std::vector<ShownPlace> places = {};  ///< what the stops have in common, deepest first
  /// Whether each cell of the whole path, in its order, stops a load that is judged where it is
  /// blocked; empty without an outline.
  std::vector<bool> stopping = {};

  /// The answer in a sentence.
  std::string sentence() const;
  /// What the picture does not show, in a sentence.
  std::string caution() const;
  /// The cells of each bin that are not known, because no beam crossed them.
  const SectionCells& not_known() const;
  /// The object "section" of the page's facts.
  Json facts() const;
  /// The columns that the page draws from: the chainage of each pose in millimetres; as bits, the
  /// cells of the window, row by row, that are blocked anywhere (whole), and those that stop a load
  /// where it is judged, for several loads followed by those that stop each of them (stops); the
  /// first pose of each blocked cell (first); as bits, the cells of each stretch with a pose that
  /// are blocked (cells), and those that are not known (unknown), unless there are too many; and
  /// for each stretch, and last the whole path, the widths of the bands in cells, -1 where open,
  /// with their poses (left, right, left_pose, right_pose).
  void add_columns(std::vector<PageColumn>& columns) const;

 private:
  void check_loads();
  void add_load(ShownLoad load);
  void find_stops();
  void find_obstacles();
  void find_places();
  /// The cells of the bins, by index, that stop a load in its bin.
  std::vector<std::size_t> stopping_in(const ShownStop& stop) const;
  /// What would free the load from an intrusion, as the end of a sentence.
  std::string remedy_of(const ShownIntrusion& intrusion, const ShownLoad& load) const;
  /// Whether the page has the cells of each stretch, which it lacks where they would be too many.
  bool has_cells_of_bins() const;
  Json json_of_check() const;

  std::vector<std::size_t> load_of_row_;  ///< for each row of the check
  std::vector<SectionBand> bands_;
  std::vector<SectionStretch> stretches_;
};

/// The picture as an SVG element: cells, axes, outline with its margin, marks. whole: with title,
/// legend and the list of the places that stop the load, for a file of its own; otherwise for a
/// page, which has these beside it.
std::string section_svg(const SectionView& view, bool whole);

/// Colours of the cells, each for a part of the path, from dark to light, so that grey
/// distinguishes them apart, too.
inline constexpr std::array kSectionColours{"#0b2545", "#1f4e79", "#2f7f8c",
                                            "#62a87c", "#a9c46c", "#e0cf62"};

}  // namespace clearway
