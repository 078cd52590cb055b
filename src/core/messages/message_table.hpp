#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "clearway/answer.hpp"

namespace clearway {

/// Whether a message with some code is a note, a warning, or one or the other.
enum class Severities : unsigned { kNote = 1, kWarning = 2, kEither = 3 };

/// What a search that gave a warning may have missed.
enum class Missing {
  kNothing,
  kPlace,  ///< points, because the model may not have been where they are
  kScan    ///< points that the scan lacks, so that what stood there may stand there still
};

/// What a warning means for an answer. A search that gave a warning with a doubt or with something
/// missing may have missed points; other warnings leave the answer as it is. A warning that a store
/// repeats from its conversion has the effect of its code without the prefix.
struct MessageEffect {
  Doubt doubt = Doubt::kNone;
  Missing missing = Missing::kNothing;
  /// Whether the warning concerns the vehicle and not a single body: a roof is always above the
  /// ground, and in a cutting a bogie has a wall on its own side only.
  bool of_vehicle = false;
};

/// What the program knows of the messages with one code.
struct MessageKind {
  std::string_view code;
  Severities severities;
  MessageEffect effect = {};
};

namespace message_table {

using enum Severities;

/// The messages, by what they are about and code; docs/guide/warnings.md says what each means.
inline constexpr auto kMessageKinds = std::to_array<MessageKind>({
    // Scans
    {"absent-points", kWarning},
    {"column-names", kWarning},
    {"crs-ignored", kWarning},
    {"crs-not-read", kWarning},
    {"cut-off", kWarning, {.doubt = Doubt::kQuestion}},
    {"cut-text", kWarning, {.doubt = Doubt::kQuestion}},
    {"declared-bounds", kWarning, {.doubt = Doubt::kQuestion}},
    {"degrees", kWarning, {.doubt = Doubt::kQuestion}},
    {"e57-unit", kWarning},
    {"far-apart", kWarning},
    {"feet", kEither},
    {"floating-point-rounded", kEither},
    {"gps-times-contradict", kWarning},
    {"gps-times-not-finite", kWarning},
    {"las-count", kWarning},
    {"left-out", kEither},
    {"like-degrees", kWarning},
    {"lost-digits", kWarning},
    {"map-scale", kWarning},
    {"map-scale-unknown", kWarning},
    {"mesh-faces", kWarning},
    {"model-among-scans", kNote},
    {"more-warnings", kWarning},
    {"named-otherwise", kNote},
    {"near-store", kNote},
    {"no-crs", kNote},
    {"no-gps-times", kWarning},
    {"no-points", kWarning, {.doubt = Doubt::kQuestion}},
    {"non-finite-points", kWarning},
    {"origins-at-zero", kWarning},
    {"origins-far", kWarning},
    {"origins-path-gap", kWarning},
    {"other-crs", kWarning},
    {"other-size", kWarning},
    {"other-unit", kWarning},
    {"outside-bounds", kWarning},
    {"padded-cells", kWarning},
    {"pcd-viewpoint", kWarning},
    {"points-without-origin", kWarning},
    {"poses-not-applied", kWarning},
    {"same-place", kWarning},
    {"same-scan", kWarning},
    {"scan-axes-contradict", kWarning},
    {"scan-not-registered", kWarning, {.doubt = Doubt::kQuestion}},
    {"scan-not-rigid", kWarning},
    {"scan-placed", kNote},
    {"scan-without-pose", kWarning},
    {"skipped-files", kWarning},
    {"units-contradict", kWarning},
    {"withheld-points", kEither},
    // Models
    {"half-outline", kWarning},
    {"loose-vertices", kWarning},
    {"mesh-bent-faces", kWarning},
    {"mesh-crossing-faces", kWarning},
    {"two-feet", kWarning},
    {"unit-assumed", kWarning},
    {"withheld-model-points", kWarning},
    // Trajectories
    {"alignment-crs", kWarning},
    {"alignment-feet", kWarning},
    {"alignment-kink", kWarning},
    {"alignment-length", kWarning},
    {"alignment-stations", kWarning},
    {"angle-frame", kNote},
    {"angles-in-degrees", kNote},
    {"body-far", kWarning},
    {"body-folded", kWarning},
    {"body-off-path", kEither, {.doubt = Doubt::kStretch}},
    {"body-transient", kEither},
    {"body-turned", kWarning},
    {"body-undefined", kWarning, {.doubt = Doubt::kStretch}},
    {"cant-ends", kWarning},
    {"cant-rails", kNote},
    {"cant-rotation", kWarning},
    {"cant-side", kWarning},
    {"cant-transition", kWarning},
    {"cant-unit", kWarning},
    {"datum-accuracy", kEither},
    {"ellipsoidal-heights", kWarning},
    {"forward-axis", kWarning},
    {"frames-not-poses", kNote},
    {"ground-ends", kWarning},
    {"ground-leans", kWarning},
    {"heights-converted", kNote},
    {"line-crs", kWarning},
    {"line-curved", kEither},
    {"line-degrees", kWarning},
    {"line-others", kNote},
    {"line-rounded", kNote},
    {"line-stations", kWarning},
    {"line-steep", kWarning},
    {"map-distorts", kWarning},
    {"map-projection", kNote},
    {"map-unit", kEither},
    {"model-frame", kNote},
    {"no-cant", kNote},
    {"on-ground", kNote},
    {"path-outside-scan", kWarning},
    {"poses-inverse", kWarning, {.doubt = Doubt::kQuestion}},
    {"profile-shorter", kWarning},
    {"quaternion-order", kWarning, {.doubt = Doubt::kQuestion}},
    {"rotation-missing", kWarning},
    {"rotation-too-small", kWarning, {.doubt = Doubt::kQuestion}},
    {"station-equations", kWarning},
    {"station-order", kWarning},
    {"steps-above-radius", kWarning},
    {"superelevation", kWarning},
    {"time-order", kWarning},
    {"trajectory-jump", kEither},
    {"trajectory-unit", kNote},
    {"turns-against-path", kWarning, {.doubt = Doubt::kQuestion}},
    {"unread-columns", kEither},
    {"up-axis", kWarning},
    {"upside-down", kWarning},
    // Queries
    {"absent-class", kWarning},
    {"all-ignored", kWarning, {.doubt = Doubt::kQuestion}},
    {"beams-without-origin", kWarning},
    {"below-ground", kWarning, {.doubt = Doubt::kQuestion, .missing = Missing::kPlace}},
    {"coarse-digits", kWarning, {.doubt = Doubt::kQuestion}},
    {"coarse-scan", kWarning, {.missing = Missing::kScan}},
    {"drives-backwards", kNote},
    {"empty-box", kWarning},
    {"errors-exceed-margin", kNote},
    {"few-sigmas", kWarning},
    {"fine-radius", kWarning},
    {"flat-model", kWarning},
    {"flat-scan", kWarning},
    {"floats", kWarning, {.doubt = Doubt::kStretch, .of_vehicle = true}},
    {"floor-axis", kWarning},
    {"floor-high", kWarning},
    {"ground-collides", kNote},
    {"ignored-collide", kWarning},
    {"ignored-high", kWarning},
    {"inside-model", kWarning},
    {"journal-left", kWarning},
    {"large-cubes", kWarning},
    {"large-steps", kEither},
    {"leans", kWarning},
    {"leaves-scan", kWarning, {.doubt = Doubt::kStretch, .missing = Missing::kScan}},
    {"long-beams", kWarning},
    {"mirrored-poses", kWarning, {.doubt = Doubt::kQuestion}},
    {"model-is-environment", kWarning, {.doubt = Doubt::kQuestion}},
    {"model-origin", kWarning},
    {"model-size", kWarning},
    {"model-spacing", kWarning},
    {"model-unit", kWarning, {.doubt = Doubt::kQuestion}},
    {"most-ignored", kWarning},
    {"motion-exceeds-cell", kWarning},
    {"no-poses", kWarning, {.doubt = Doubt::kQuestion}},
    {"nothing-below",
     kWarning,
     {.doubt = Doubt::kStretch, .missing = Missing::kScan, .of_vehicle = true}},
    {"nothing-beside", kWarning, {.missing = Missing::kScan, .of_vehicle = true}},
    {"nothing-blocked", kWarning},
    {"nothing-swept", kWarning, {.doubt = Doubt::kQuestion}},
    {"one-side", kWarning, {.missing = Missing::kScan, .of_vehicle = true}},
    {"open-model", kWarning},
    {"out-of-reach", kWarning, {.doubt = Doubt::kQuestion, .missing = Missing::kScan}},
    {"radius-size", kWarning},
    {"rotations", kWarning},
    {"same-body", kWarning},
    {"scaled-poses", kWarning},
    {"sideways", kWarning},
    {"single-precision", kWarning},
    {"small-error-angle", kWarning},
    {"small-unseen", kWarning},
    {"tilted", kWarning},
    {"tiny-path", kWarning},
    // Findings
    {"no-clearances", kWarning},
    {"no-overthrow", kWarning},
    {"one-long-conflict", kWarning},
    {"searched-unknown", kWarning},
    {"sides-unknown", kWarning},
    {"unmatched-files", kNote},
});

}  // namespace message_table

/// Prefix of the codes of a store's warnings where another command repeats them.
inline constexpr std::string_view kStorePrefix = "store-";

/// The place of a code in the table, or the number of its rows.
constexpr std::size_t place_of_message_kind(std::string_view code) {
  const auto& kinds = message_table::kMessageKinds;
  const auto found = std::ranges::find(kinds, code, &MessageKind::code);
  return static_cast<std::size_t>(found - kinds.begin());
}

/// The row with a code, or nullptr.
constexpr const MessageKind* find_message_kind(std::string_view code) {
  const auto& kinds = message_table::kMessageKinds;
  const std::size_t place = place_of_message_kind(code);
  return place == kinds.size() ? nullptr : &kinds[place];
}

/// What a warning with this code means for an answer, also where a store repeats it; nothing for an
/// unknown code.
constexpr MessageEffect effect_of(std::string_view code) {
  if (code.starts_with(kStorePrefix)) code.remove_prefix(kStorePrefix.size());
  const MessageKind* const kind = find_message_kind(code);
  return kind == nullptr ? MessageEffect() : kind->effect;
}

/// A code that the table has for messages of this severity. It is made of a literal, and another
/// literal does not compile.
template <Severities kNeeded>
class MessageCode {
 public:
  consteval MessageCode(const char* code) : code_(code) {  // NOLINT(google-explicit-constructor)
    // By its place: with sanitizers, gcc compares no address while it compiles.
    const auto& kinds = message_table::kMessageKinds;
    const std::size_t place = place_of_message_kind(code);
    const auto needed = static_cast<unsigned>(kNeeded);
    if (place == kinds.size() ||
        (static_cast<unsigned>(kinds[place].severities) & needed) != needed) {
      throw "the table of messages has no such code of this severity";
    }
  }

  constexpr std::string_view view() const { return code_; }

  friend bool operator==(std::string_view a, const MessageCode& b) { return a == b.code_; }

 private:
  std::string_view code_;
};

using NoteCode = MessageCode<Severities::kNote>;
using WarningCode = MessageCode<Severities::kWarning>;
using EitherCode = MessageCode<Severities::kEither>;

}  // namespace clearway
