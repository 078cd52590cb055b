#pragma once

#include <string_view>

namespace clearway {

/// Metres of the units in which files are often written. The two feet differ by 2 in a million,
/// which is 4 m in state plane coordinates of 2,000 km.
inline constexpr double kMetresPerMillimetre = 0.001, kMetresPerCentimetre = 0.01,
                        kMetresPerInch = 0.0254, kMetresPerFoot = 0.3048,
                        kMetresPerUsSurveyFoot = 1200.0 / 3937;

/// The unit in which the numbers of a file are written, or that it is not known. A "ft" does not
/// say which foot it is: if the environment is in a foot of any kind, it is that foot, so that its
/// numbers are taken as they are. Otherwise it is the international foot.
class FileUnit {
 public:
  FileUnit() = default;  ///< the unit is not known
  /// Makes a unit from its length in metres; 0 if it is not known. kMetresPerFoot counts as a "ft",
  /// because that is how people write one; FileUnit::named("ift") is the international foot
  /// whatever the environment is in.
  FileUnit(double metres)  // NOLINT(google-explicit-constructor): a number is a unit too
      : metres_(metres), any_foot_(metres == kMetresPerFoot) {}

  /// Makes a unit from its name: "mm", "cm", "m", "in", "ft" (the environment's foot), "ift" (the
  /// international foot), "us-ft" (the US survey foot), or one of their longer names, such as
  /// "us-survey-foot". Throws UsageError for any other text.
  static FileUnit named(std::string_view name);
  /// A foot of exactly this length, whatever the environment is in.
  static FileUnit exactly(double metres) { return {metres, false}; }

  bool is_known() const { return metres_ != 0; }
  bool is_any_foot() const { return any_foot_; }
  /// Length of the unit in metres, 0 if it is not known; for a "ft" that of the international foot.
  double metres() const { return metres_; }
  /// Length of this unit in metres if the environment's unit has `environment_unit` metres. Exactly
  /// `environment_unit` if both are the same unit.
  double metres_in(double environment_unit) const;

  friend bool operator==(const FileUnit&, const FileUnit&) = default;

 private:
  FileUnit(double metres, bool any_foot) : metres_(metres), any_foot_(any_foot) {}

  double metres_ = 0;
  bool any_foot_ = false;
};

}  // namespace clearway
