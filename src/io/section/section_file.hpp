#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "clearway/section.hpp"
#include "io/files/table_file.hpp"

namespace clearway {

inline constexpr TableFileKind kSectionKind{"clearway section", 4, "a section",
                                            "clearway section find", "run section find again"};

/// The cells of a section as they are written: bin by bin, so that they need not be held at once.
struct SectionRows {
  std::vector<std::uint64_t> counts = {};  ///< how many each of SectionData::bins has
  /// Appends the cells of a bin, given by its place in SectionData::bins, ascending by k and j. The
  /// numbers of bins are not needed.
  std::function<void(std::size_t, SectionCells&)> add = {};

  std::uint64_t total() const;
};

/// Writes a section to a new file (docs/design/section.md, "The file"). section: without its cells.
/// unknown: with seen space, the cells that are not known. Throws ResourceError.
void write_section(const SectionData& section, const SectionRows& blocked,
                   const std::optional<SectionRows>& unknown, const std::filesystem::path& path);

/// Reads a section and checks all of it. Throws InputError where it is not an intact, complete
/// section of this version, ResourceError where it cannot be read.
SectionData read_section(const std::filesystem::path& path);

}  // namespace clearway
