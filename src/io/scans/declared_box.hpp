#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// Whether a writer filled in the box that a file declares: it is finite, not inverted and not a
/// single place.
bool is_filled_in(const Box& declared);

/// Where the points of a file may lie by the box that it declares: in the box and around it as far
/// as its size. Writers round their bounds, so small excesses are normal; a wrong unit and records
/// of zeros exceed them by far. Nullopt for a box that was not filled in.
std::optional<Box> reach_of(const std::optional<Box>& declared);

/// The box as "(1, 2, 3) to (4, 5, 6)".
std::string declared_box_text(const Box& box);

/// Collects warnings on files, or on scans of a file, with points out of reach of their declared
/// box.
class BoundsWarnings {
 public:
  /// Points of one of them, of which `beyond` are out of reach.
  struct Found {
    std::uint64_t points = 0, beyond = 0;
    Box box{};  ///< of all points
  };

  void add(const std::string& name, const Box& declared, const Found& found);
  /// Warnings on those with points on both sides, where records may be damaged, and on those with
  /// all points out of reach.
  std::vector<Message> messages() const;

 private:
  struct OfKind {
    std::uint64_t count = 0;
    std::string first;
  };
  OfKind partly_, wholly_;
};

}  // namespace clearway
