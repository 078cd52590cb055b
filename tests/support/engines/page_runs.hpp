#pragma once

#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "core/section/section_ref.hpp"
#include "core/seen/beams.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// Memory with the alignment of pages, whose bytes are set beforehand to values on which no page
/// may depend.
class PageMemory {
 public:
  explicit PageMemory(std::uint64_t bytes, int before = 0) : lines_(divide_up(bytes, kLine)) {
    std::memset(lines_.data(), before, lines_.size() * kLine);
  }
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(lines_)); }

 private:
  static constexpr std::uint64_t kLine = kPageAlignment;
  struct alignas(kLine) Line {
    std::array<std::byte, kLine> bytes;
  };
  std::vector<Line> lines_;
};

/// What is left of a map's words after beams, and the beams that were left out.
struct BeamRun {
  std::vector<std::uint64_t> words;
  BeamCounts left_out;
};

/// Takes all points of a cloud in pages of a few cells through the body of the kernel on the host.
/// The map of `beams` stays as it is. Another program may put a device in its place.
extern BeamRun (*follow_pages)(const PackedCloud& cloud, const Beams& beams);

/// Takes the points of a cloud in pages of a few cells through the body of the kernel on the host,
/// with a loop over the lanes of a warp. Blocks the cells of the section's maps. Another program
/// may put a device in its place.
extern void (*block_pages)(const PackedCloud& cloud, const IgnoredPoints& ignored,
                           const SectionRef& section);

std::vector<PlannedCell> all_cells(const PackedCloud& cloud);

/// The cells of a cloud that may block something, each with its bins_in_reach().
std::vector<PlannedCell> section_cells(const PackedCloud& cloud, const SectionRef& section);

/// The greatest number of cells of a page in these runs.
inline constexpr std::uint32_t kPageCells = 3;

}  // namespace clearway
