#pragma once

#include <string_view>

namespace clearway {

/// Metres of the units in which files are often written. The two feet differ by 2 in a million,
/// which is 4 m in state plane coordinates of 2,000 km.
inline constexpr double kMetresPerMillimetre = 0.001, kMetresPerCentimetre = 0.01,
                        kMetresPerInch = 0.0254, kMetresPerFoot = 0.3048,
                        kMetresPerUsSurveyFoot = 1200.0 / 3937;

/// The unit in which the numbers of a file are written, or that none is known. A "ft" does not say
/// which foot it is: where the environment is in a foot of any kind, it is that foot, so that its
/// numbers are taken as they are. Elsewhere it is the international foot.
class FileUnit {
 public:
  FileUnit() = default;  ///< none is known
  /// metres: 0 where none is known. kMetresPerFoot is a "ft", because it is how people write one;
  /// FileUnit::named("ift") is the international foot whatever the environment is in.
  FileUnit(double metres)  // NOLINT(google-explicit-constructor): a number is a unit too
      : metres_(metres), any_foot_(metres == kMetresPerFoot) {}

  /// "mm", "cm", "m", "in", "ft" (the environment's foot), "ift" (the international foot), "us-ft"
  /// (the US survey foot), or one of their longer names, such as "us-survey-foot". Throws
  /// UsageError for any other text.
  static FileUnit named(std::string_view name);
  /// The foot of exactly so many metres, and no other.
  static FileUnit exactly(double metres) { return {metres, false}; }

  bool is_known() const { return metres_ != 0; }
  bool is_any_foot() const { return any_foot_; }
  /// 0 where none is known; of a "ft" those of the international foot.
  double metres() const { return metres_; }
  /// Metres of this unit where the environment's unit is so many metres long. Exactly
  /// `environment_unit` where both are the same unit.
  double metres_in(double environment_unit) const;

  friend bool operator==(const FileUnit&, const FileUnit&) = default;

 private:
  FileUnit(double metres, bool any_foot) : metres_(metres), any_foot_(any_foot) {}

  double metres_ = 0;
  bool any_foot_ = false;
};

}  // namespace clearway
