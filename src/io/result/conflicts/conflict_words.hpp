#pragma once

#include <array>
#include <optional>
#include <string>

#include "clearway/conflicts.hpp"
#include "clearway/shift.hpp"
#include "io/result/conflicts/conflict_file.hpp"

namespace clearway {

/// Distances below this, in metres, say only that the surfaces touch, because a scan can show no
/// more.
inline constexpr double kTouching = 0.001;

/// The longest own shift of a conflict that is tried, metres.
inline constexpr double kMostOwnShift = 2;

/// The conflict with rank 1. Null where there are none.
const Conflict* worst_of(const Conflicts& conflicts);

/// What is missing at a conflict, in digits of a millimetre: "0.099 m" of a solid, and otherwise
/// "at least 0.099 m" or "touches". Empty without an encroachment, and for points that are only
/// near. unit: the symbol of lengths; an empty one is left out. metre: metres per unit.
std::string missing_words(const Conflict& conflict, const std::string& unit, double metre);

/// Where something lies, seen from the vehicle, and from where it came in if it is inside. Empty
/// where that is not known.
struct SideWords {
  const char *on, *from;
};
inline constexpr std::array kSideWords{SideWords{"", ""},
                                       SideWords{"on the left", "from its left side"},
                                       SideWords{"on the right", "from its right side"},
                                       SideWords{"above it", "from its top"},
                                       SideWords{"below it", "from its underside"},
                                       SideWords{"in front of it", "from its front"},
                                       SideWords{"behind it", "from its rear"},
                                       SideWords{"around it", "from both sides"}};
constexpr const SideWords& words_of(Side side) {
  return kSideWords[static_cast<std::size_t>(side)];
}

/// How conflicts are put in words.
struct RemedyWords {
  const Conflicts& conflicts;
  std::string unit;                    ///< symbol of lengths
  double metre = 1;                    ///< metres per unit of length
  std::string body = {};               ///< name of the conflict's first_body, for a vehicle
  std::string nearest = {};            ///< name of its nearest body, for a vehicle
  bool has_budget = false;             ///< whether the search has an error budget
  const ShiftTable* shifts = nullptr;  ///< confirmed shifts, where they are known
};

/// How a conflict of a file is put in words.
RemedyWords words_about(const Conflict& conflict, const ConflictFile& file);

/// What most points of a conflict are classified as: "60 of 60 points are classified as high noise
/// (18)". Empty where the class says nothing.
std::string class_words(const Conflict& conflict);

/// What frees a vehicle from a conflict, in sentences: "To pass it: a trim of 0.15 m on the left is
/// enough." Names only trims and shifts that a search has confirmed; of an own shift it says that
/// this is what the conflict's own points need. Says so where nothing of what was tried frees the
/// vehicle. Empty where nothing is known, and for points that are only near.
std::string remedy_words(const Conflict& conflict, const RemedyWords& how);

/// Where a conflict is, what is missing there, and what frees the vehicle from it: "conflict
/// 1, 64.1 m along the path, on the left: at least 0.093 m are missing. To pass it: ...".
std::string conflict_words(const Conflict& conflict, const RemedyWords& how);

}  // namespace clearway
