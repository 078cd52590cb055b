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

/// What pages and pictures show of a section.
namespace clearway {

/// A bit for each cell of the window, row by row from below and from the least j.
using CellBits = std::vector<bool>;

/// An outline that is judged, on the whole path or on stretches of it.
struct ShownLoad {
  std::string name = {};  ///< of its file; empty where it has none
  std::span<const OutlinePoint> outline = {};
  double margin = 0;                ///< the distance that it keeps
  std::vector<bool> stopping = {};  ///< stopping_cells()
};

/// An intrusion with what is known of the obstacle.
struct ShownIntrusion {
  SectionIntrusion intrusion;
  std::optional<SectionWitness> witness = {};
  std::string obstacle = {};  ///< its name; empty where it has none
};

struct ShownStop {
  SectionStop stop;
  std::size_t load = 0;  ///< index of the load that is stopped
  std::vector<ShownIntrusion> intrusions = {};
  std::vector<std::string> obstacles = {};  ///< names of all that are known to stop the load here
};

/// What reaches into the load in stretches one after the other: the same obstacle by its name or,
/// without names, intrusions of one side in neighbouring stretches that overlap across the path.
struct ShownPlace {
  std::string label = {};                     ///< "A", "B" and so on; A is the deepest
  std::size_t load = 0;                       ///< index of the load
  ShownIntrusion deepest = {};                ///< with the heights of all of its intrusions
  std::vector<std::size_t> stops = {};        ///< numbers of the stops, from 1, ascending
  double chainage_from = 0, chainage_to = 0;  ///< ends of its stretches
};

/// All that is drawn and said of a section.
class SectionView {
 public:
  /// section and picture outlive this object. Throws as Section::check(), section_bands() and
  /// section_witnesses(), and UsageError where obstacles are given without store and path.
  SectionView(const Section& section, const SectionPicture& picture);

  const Section& section() const { return section_; }
  const SectionPicture& picture() const { return picture_; }
  const SectionLattice& lattice() const { return lattice_; }
  std::string unit() const;  ///< symbol of the unit of lengths
  /// The answer to the outline, or to a table of outlines; none without them.
  const std::optional<OutlineTableCheck>& check() const { return check_; }
  /// The outlines that are judged, each with its margin once.
  const std::vector<ShownLoad>& loads() const { return loads_; }
  const std::vector<ShownStop>& stops() const { return stops_; }
  /// What the stops have in common, deepest first.
  const std::vector<ShownPlace>& places() const { return places_; }
  /// Whether each cell of the whole path, in its order, stops a load that is judged where it is
  /// blocked; empty without an outline.
  const std::vector<bool>& stopping() const { return stopping_; }

  /// The cells of each bin that are not known, because no beam crossed them.
  const SectionCells& not_known() const;

  /// The answer in a sentence.
  std::string sentence() const;
  /// What the picture does not show, in a sentence.
  std::string caution() const;
  /// What would let the load pass on a stretch, as a sentence.
  std::string remedy(const ShownStop& stop) const;
  /// What would free the load from a place, as a sentence.
  std::string remedy(const ShownPlace& place) const;

  /// Chainage at which a bin begins.
  double chainage_of_bin(double number) const { return number * section_.data().parameters.bin; }

  /// The object "section" of the page's facts.
  Json facts() const;
  /// The columns that the page draws from. docs/design/report.md describes them.
  void add_columns(std::vector<PageColumn>& columns) const;
  /// Whether the page has the cells of each stretch, which it lacks where they would be too many.
  bool has_cells_of_bins() const;

 private:
  void check_loads();
  std::size_t add_load(ShownLoad load);
  void find_stopping();
  void find_obstacles();
  void find_places();
  /// The cells of the bins, by index, that stop a load in its bin.
  std::vector<std::size_t> stopping_in(const SectionStop& stop, const ShownLoad& load) const;
  std::string remedy(const SectionIntrusion& intrusion, const ShownLoad& load) const;
  void add_question(Json& json) const;
  Json json_of_check() const;

  const Section& section_;
  const SectionPicture& picture_;
  SectionLattice lattice_;
  std::optional<OutlineTableCheck> check_;
  std::vector<ShownLoad> loads_;
  std::vector<std::size_t> load_of_row_;  ///< for each row of the check
  std::vector<bool> stopping_;
  std::vector<ShownStop> stops_;
  std::vector<ShownPlace> places_;
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
