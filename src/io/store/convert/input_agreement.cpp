#include "io/store/convert/input_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/map_scale.hpp"
#include "io/scans/scan_crs.hpp"
#include "io/store/convert/map_warnings.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {
namespace {

using Axes = std::array<double, 3>;

constexpr double kCoarseStep = 0.001;  // metres; coarser steps cause a warning

Axes scale_of(const Quantisation& q) { return {q.scale[0], q.scale[1], q.scale[2]}; }

/// The difference of `offset` from that of `to` in quanta on each axis; nullopt where it is not a
/// whole number.
std::optional<std::array<std::int64_t, 3>> whole_shift(const double* offset,
                                                       const Quantisation& to) {
  std::array<std::int64_t, 3> shift;
  for (std::size_t k = 0; k < 3; ++k) {
    const double quanta = (offset[k] - to.offset[k]) / to.scale[k];
    const double rounded = std::nearbyint(quanta);
    // A deviation of a millionth of a quantum is noise of offsets written in decimal.
    if (!(std::abs(quanta - rounded) <= 1e-6 && std::abs(rounded) < 0x1p53)) return std::nullopt;
    shift[k] = static_cast<std::int64_t>(rounded);
  }
  return shift;
}

bool has_integers(const CloudInfo& info) { return info.quantisation.has_value(); }

bool has_unit(const CloudInfo& info) { return info.unit != LengthUnit::kUnknown; }

constexpr const char* kIgnored = "crs-ignored";

LengthUnit environment_unit_of(const FileUnit& unit) {
  for (const LengthUnit known :
       {LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kUsSurveyFoot}) {
    if (unit.metres() == metres_of(known)) return known;
  }
  throw UsageError("the coordinates of a scan in units of " + format_digits(unit.metres(), 9) +
                   " m are not read; expected m, ft, ift or us-ft");
}

bool names_crs(const CloudInfo& info) { return !info.crs_wkt.empty() || !info.crs.empty(); }

/// A reference system in words: "ETRS89 / UTM zone 32N, EPSG:25832".
std::string crs_label(const ScanCrs& crs) {
  const std::int32_t number = crs.epsg != 0 ? crs.epsg : crs.horizontal_epsg;
  if (number == 0) return crs.name + ", without an EPSG code";
  const std::string code = "EPSG:" + std::to_string(number);
  return crs.name == code ? code : crs.name + ", " + code;
}

/// Brings the declarations of the inputs together.
class Agreement {
 public:
  Agreement(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
            const ConvertOptions& given)
      : files_(files), infos_(infos.begin(), infos.end()), given_(given) {}

  CommonCrs find() {
    if (given_.unit.is_known()) take_given_unit(environment_unit_of(given_.unit));
    for (std::size_t i = 0; i < infos_.size(); ++i) check_own(i, infos_[i]);
    choose_unit();
    if (given_.unit_z.is_known()) {
      convert_heights();
    } else {
      compare_heights();
    }
    choose_crs();
    if (is_foot(metres_of(common_.unit))) {
      warn("feet", "the coordinates are in feet (" + to_string(common_.unit) +
                       "): lengths, models and trajectories without a unit of their own are taken "
                       "in feet too");
    }
    return std::move(common_);
  }

 private:
  std::string name(std::size_t i) const { return files_[i].string(); }

  void warn(WarningCode code, const std::string& text) {
    common_.warnings.push_back(warning(code, text));
  }

  /// Refuses a file for this reason, or warns of it where it is to be ignored; does nothing where
  /// the reason is empty. heights: metres of a unit of heights that can be named instead; 0 where
  /// that does not help.
  void refuse_or_warn(std::size_t i, const std::string& reason, const std::string& expected,
                      double heights = 0) {
    if (reason.empty()) return;
    if (!given_.ignore_crs) refuse(name(i), reason + expected, Remedy::kIgnoreCrs, heights);
    warn(kIgnored, name(i) + ": " + reason + ". The coordinates are taken as they are");
  }

  /// Gives its unit to inputs that name none.
  void take_given_unit(LengthUnit given) {
    const FileUnit& unit = given_.unit;
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      CloudInfo& info = infos_[i];
      if (!has_unit(info) || (info.any_foot && is_foot(unit.metres()))) {
        info.any_foot = unit.is_any_foot();
        info.unit = given;
      }
      const bool same = info.unit == given || (unit.is_any_foot() && is_foot(metres_of(info.unit)));
      if (same || given_.ignore_crs) continue;
      refuse(name(i), "its unit of length is " + to_string(info.unit) + ", but " +
                          to_string(given) + " was given; expected the same unit");
    }
  }

  /// Judges what an input says of its own.
  void check_own(std::size_t i, const CloudInfo& info) {
    common_.is_partly_read = common_.is_partly_read || !info.crs_unread.empty() ||
                             !info.unit_unread.empty() || !info.crs_doubt.empty();
    refuse_or_warn(i, info.crs_unread.empty() ? "" : info.crs_unread + " is not read",
                   ", expected well-known text, PROJJSON, a PROJ string or a code that PROJ knows");
    refuse_or_warn(i, info.unit_trouble,
                   "; expected metres or feet for all of them. Convert the scan first");
    const bool in_degrees = info.unit == LengthUnit::kDegrees;
    refuse_or_warn(i, in_degrees ? "its coordinate reference system is in degrees" : "",
                   ", expected lengths; project the scan first");
    if (!info.unit_unread.empty() && has_unit(info)) {
      warn("crs-not-read", name(i) + ": " + info.unit_unread);
    } else {
      refuse_or_warn(i, info.unit_unread,
                     ". So its unit is not known, expected one that is read. --unit names it");
    }
    if (!info.crs_doubt.empty()) {
      warn("crs-not-read",
           name(i) + ": " + info.crs_doubt +
               (has_unit(info) ? "" : ". Its unit is not known, so metres are assumed"));
    }
    refuse_or_warn(i, info.unplaced, std::string(kExpectedPlaced));
    if (!info.unit_doubt.empty()) warn("units-contradict", name(i) + ": " + info.unit_doubt);
  }

  /// Takes the unit of the first input that names it.
  void choose_unit() {
    // A "ft" in a text file means the foot of another input that says which one it uses.
    const auto says_which = [](const CloudInfo& info) { return has_unit(info) && !info.any_foot; };
    auto known = std::ranges::find_if(infos_, has_unit);
    if (known == infos_.end()) return;
    if (known->any_foot) {
      const auto exact = std::ranges::find_if(infos_, says_which);
      if (exact != infos_.end() && is_foot(metres_of(exact->unit))) known = exact;
    }
    common_.unit = known->unit;
    const std::string first = name(static_cast<std::size_t>(known - infos_.begin()));
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      // An input that names no unit is taken to be in metres.
      const bool same_foot = infos_[i].any_foot && is_foot(metres_of(common_.unit));
      const bool agrees = infos_[i].unit == common_.unit || same_foot ||
                          (!has_unit(infos_[i]) && common_.unit == LengthUnit::kMetre);
      if (agrees) continue;
      refuse_or_warn(i, "its unit of length is " + to_string(infos_[i].unit),
                     ", expected " + to_string(common_.unit) + " as in " + first);
    }
  }

  /// Compares the units of heights with that of the other coordinates.
  void compare_heights() {
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const double metres = infos_[i].height_unit;
      if (has_unit(infos_[i]) || metres == 0 || std::abs(metres - 1) <= kSameHeights) continue;
      warn("units-contradict",
           name(i) + ": its heights are in " + name_of_length(metres) +
               ", and no unit of its other coordinates is named. They are taken for metres; name "
               "another unit where they are in one");
    }
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const double metres = infos_[i].height_unit;
      refuse_or_warn(i, heights_trouble(metres, common_.unit),
                     "; expected one unit for all of them", metres);
    }
  }

  /// Finds how heights in the given unit become those of the other coordinates.
  void convert_heights() {
    if (common_.unit == LengthUnit::kDegrees) {
      throw UsageError(
          "heights are converted to the unit of the other coordinates, and these are in degrees");
    }
    const double plane = metres_of(common_.unit) > 0 ? metres_of(common_.unit) : 1;
    common_.height_unit = given_.unit_z.metres_in(plane);
    common_.height_factor = common_.height_unit / plane;
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const double named = infos_[i].height_unit;
      if (named == 0 || std::abs(named - common_.height_unit) <= kSameHeights * named) continue;
      refuse_or_warn(
          i, "its heights are in " + name_of_length(named),
          ", but " + name_of_length(common_.height_unit) + " was given; expected the same unit");
    }
  }

  /// The system of an input. Each is parsed only once, although many files have the same.
  const ScanCrs& crs_of(const CloudInfo& info) {
    const std::string& text = info.crs.empty() ? info.crs_wkt : info.crs;
    const auto known = systems_.find(text);
    return known != systems_.end() ? known->second : systems_[text] = scan_crs_of(text);
  }

  /// Whether both inputs certainly have the same coordinate reference system. GeoTIFF keys give the
  /// code of the horizontal part, so only that is compared where an input has no well-known text.
  bool has_same_crs(const CloudInfo& a, const CloudInfo& b) {
    if (a.crs_wkt == b.crs_wkt && a.crs == b.crs) return true;
    const bool texts = !a.crs_wkt.empty() && !b.crs_wkt.empty();
    const auto code = texts ? &ScanCrs::epsg : &ScanCrs::horizontal_epsg;
    return crs_of(a).*code != 0 && crs_of(a).*code == crs_of(b).*code;
  }

  /// Chooses the first well-known text that any input has. Warns of inputs in systems other than
  /// the first one's, and notes inputs without any.
  void choose_crs() {
    const auto first = std::ranges::find_if(infos_, names_crs);
    if (first == infos_.end()) return;
    const std::string source = name(static_cast<std::size_t>(first - infos_.begin()));
    std::size_t unnamed = 0;
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      const CloudInfo& info = infos_[i];
      if (common_.wkt.empty()) common_.wkt = info.crs_wkt;
      if (common_.crs.empty()) common_.crs = info.crs;
      if (!names_crs(info)) {
        ++unnamed;
      } else if (!has_same_crs(info, *first)) {
        warn("other-crs",
             name(i) + ": another coordinate reference system (" + crs_label(crs_of(info)) +
                 ") than " + source + " (" + crs_label(crs_of(*first)) +
                 "). The coordinates are merged as they are, so the scans may not fit together");
      }
    }
    if (unnamed == 0) return;
    common_.warnings.push_back(note(
        "no-crs", {{"files", unnamed}},
        "{} of {} files name no coordinate reference system. They are taken to be in that of {}",
        unnamed, infos_.size(), source));
  }

  std::span<const std::filesystem::path> files_;
  std::vector<CloudInfo> infos_;
  const ConvertOptions& given_;
  CommonCrs common_;
  std::map<std::string, ScanCrs> systems_;
};

}  // namespace

CommonCrs common_crs(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                     const ConvertOptions& given) {
  return Agreement(files, infos, given).find();
}

CommonCrs declared_crs(const std::vector<std::filesystem::path>& inputs,
                       const ConvertOptions& options) {
  std::vector<std::filesystem::path> files;
  std::vector<CloudInfo> infos;
  for (const std::filesystem::path& file : list_point_files(inputs)) {
    try {
      infos.push_back(open_point_file(file, {options.columns, true, false})->info());
      files.push_back(file);
    } catch (const InputError&) {
      if (!options.skip_unreadable) throw;
    }
  }
  return common_crs(files, infos, options);
}

bool is_of_ignored_crs(const Message& warning) {
  if (warning.code == kIgnored) return true;
  if (warning.code != kMapScaleCode) return false;
  return std::ranges::any_of(warning.numbers, [](const auto& number) {
    return number.first == "scale" && std::abs(number.second - 1) > kMostMapScale;
  });
}

std::optional<CommonQuanta> common_quanta(std::span<const std::filesystem::path> files,
                                          std::span<const CloudInfo> infos,
                                          std::optional<double> scale) {
  const auto kept = std::find_if(infos.begin(), infos.end(), has_integers);
  if (kept == infos.end()) return std::nullopt;
  const std::filesystem::path& file = files[static_cast<std::size_t>(kept - infos.begin())];
  CommonQuanta common{.quantisation = *kept->quantisation, .shifts = {}};
  const Axes first = scale_of(common.quantisation);
  if (scale && first != Axes{*scale, *scale, *scale}) return std::nullopt;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const std::optional<Quantisation>& own = infos[i].quantisation;
    if (!own) {
      common.shifts.push_back({});
      continue;
    }
    const auto shift =
        scale_of(*own) == first ? whole_shift(own->offset, common.quantisation) : std::nullopt;
    if (!shift) {
      if (scale) return std::nullopt;
      refuse(files[i].string(), "its scale or offset does not agree with that of " + file.string(),
             Remedy::kOneScale, first[0]);
    }
    common.shifts.push_back(*shift);
  }
  return common;
}

std::optional<Message> remark_on_mixture(std::span<const std::filesystem::path> files,
                                         std::span<const CloudInfo> infos,
                                         const Quantisation& quantisation) {
  const auto count =
      infos.size() - static_cast<std::size_t>(std::ranges::count_if(infos, has_integers));
  if (count == 0 || count == infos.size()) return std::nullopt;
  const auto name_of = [&](auto info) {
    return files[static_cast<std::size_t>(info - infos.begin())].string();
  };
  const double step = *std::max_element(quantisation.scale, quantisation.scale + 3);
  const bool as_models_are = std::any_of(files.begin(), files.end(), [](const auto& file) {
    return file.extension() == ".ply" || file.extension() == ".PLY";
  });
  return warning_or_note(
      step > kCoarseStep || as_models_are, "floating-point-rounded",
      fmt::format("{} of {} files have floating-point coordinates, the first is {}. They are "
                  "rounded to the steps of {}, {}{}",
                  count, infos.size(), name_of(std::ranges::find_if_not(infos, has_integers)),
                  name_of(std::ranges::find_if(infos, has_integers)), format_digits(step, 9),
                  as_models_are ? ". Is one of them the model? It does not belong among the "
                                  "scans"
                                : ""),
      {{"files", count}, {"step", step}});
}

}  // namespace clearway
