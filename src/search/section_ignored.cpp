#include "search/section_ignored.hpp"

#include <string>

#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "findings/check_conflicts.hpp"
#include "search/checks/question.hpp"
#include "search/ignored.hpp"
#include "search/section.hpp"

namespace clearway {
CellsOfIgnored cells_of_ignored(const SectionMaps& maps, const SectionMaps& ignored,
                                const SectionLattice& lattice, std::span<const SectionBin> bins,
                                std::span<const std::uint32_t> path_pose, double high_from) {
  const std::vector<bool> others = maps.blocked_anywhere(bins.size());
  std::vector<bool> high(lattice.cells());
  CellsOfIgnored out;
  const std::vector<bool> all = ignored.blocked_anywhere(bins.size());
  for (std::size_t cell = 0; cell < all.size(); ++cell) {
    if (!all[cell] || others[cell]) continue;
    ++out.blocked;
    const double k = lattice.k_from + static_cast<double>(cell / lattice.columns);
    if (!(k * lattice.cell > high_from)) continue;
    ++out.high;
    high[cell] = true;
  }
  for (std::size_t bin = 0; bin < bins.size() && out.high > 0; ++bin) {
    const std::span firsts = ignored.firsts(bin);
    bool has_high = false;
    for (std::size_t cell = 0; cell < high.size() && !has_high; ++cell) {
      has_high = high[cell] && firsts[cell] != kNotBlocked;
    }
    if (!has_high) continue;
    const SectionBin& of = bins[bin];
    const std::uint32_t first = path_pose[of.first], last = path_pose[of.first + of.count - 1];
    std::vector<PoseRange>& stretches = out.high_stretches;
    const bool follows = !stretches.empty() && stretches.back().last + 1 >= first;
    if (!follows) stretches.push_back({first, last});
    stretches.back().last = last;
  }
  return out;
}

void warn_of_cells_of_ignored(const SectionData& section, const CellsOfIgnored& found,
                              std::uint64_t blocked, LengthUnit unit, MessageLog& log) {
  const QueryParameters ignoring = ignored_by(section.parameters);
  const std::string because = " free only because " + counted(section.ignored_points, "point") +
                              (section.ignored_points == 1 ? " is" : " are") + " ignored (" +
                              ignored_text(ignoring) + ")";
  const auto are = [](std::uint64_t cells) { return cells == 1 ? " is" : " are"; };
  if (found.blocked > blocked) {
    log.warn("ignored-collide",
             counted(found.blocked, "cell") + " of the cross-section" + are(found.blocked) +
                 because + ", and the other points block only " + counted(blocked, "cell") +
                 ": a load may pass because of what was ignored. If it is the ground below the "
                 "wheels, begin the window above it instead of ignoring it",
             {{"cells", static_cast<double>(found.blocked)}});
  }
  if (found.high > 0) {
    log.warn("ignored-high",
             counted(found.high, "cell") + " of the cross-section, more than " +
                 length_text(ground_height(unit), unit) + " above the lowest place of a load," +
                 are(found.high) + because +
                 ". No ground is so high, so a load may pass because of what was ignored. Ignore "
                 "the ground alone",
             {{"cells", static_cast<double>(found.high)}}, found.high_stretches);
  }
}

}  // namespace clearway
