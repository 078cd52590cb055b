#include "io/store/convert/input_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "clearway/error.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
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

void warn(CommonCrs& common, WarningCode code, const std::string& text) {
  common.warnings.push_back(warning(code, text));
}

bool has_unit(const CloudInfo& info) { return info.unit != LengthUnit::kUnknown; }

constexpr const char* kIgnored = "crs-ignored";

/// Refuses a file for this reason, or warns of it where it is to be ignored.
/// heights: metres of a unit of heights that can be named instead; 0 where that does not help.
void refuse_or_warn(const std::filesystem::path& file, const std::string& reason,
                    const std::string& expected, bool ignore, CommonCrs& common,
                    double heights = 0) {
  if (!ignore) refuse(file.string(), reason + expected, Remedy::kIgnoreCrs, heights);
  warn(common, kIgnored, file.string() + ": " + reason + ". The coordinates are taken as they are");
}

/// Judges what an input says of its own.
void check_own(const std::filesystem::path& file, const CloudInfo& info, bool ignore,
               CommonCrs& common) {
  if (!info.crs_unread.empty()) {
    refuse_or_warn(file, info.crs_unread + " is not read",
                   ", expected well-known text, PROJJSON, a PROJ string or a code that PROJ knows",
                   ignore, common);
  }
  if (!info.unit_trouble.empty()) {
    refuse_or_warn(file, info.unit_trouble,
                   "; expected metres or feet for all of them. Convert the scan first", ignore,
                   common);
  }
  if (info.unit == LengthUnit::kDegrees) {
    refuse_or_warn(file, "its coordinate reference system is in degrees",
                   ", expected lengths; project the scan first", ignore, common);
  }
  if (!info.unit_unread.empty() && has_unit(info)) {
    warn(common, "crs-not-read", file.string() + ": " + info.unit_unread);
  } else if (!info.unit_unread.empty()) {
    refuse_or_warn(file, info.unit_unread,
                   ". So its unit is not known, expected one that is read. --unit names it", ignore,
                   common);
  }
  if (!info.crs_doubt.empty()) {
    warn(common, "crs-not-read",
         file.string() + ": " + info.crs_doubt +
             (has_unit(info) ? "" : ". Its unit is not known, so metres are assumed"));
  }
  if (!info.unplaced.empty()) {
    refuse_or_warn(file, info.unplaced, std::string(kExpectedPlaced), ignore, common);
  }
  if (!info.unit_doubt.empty()) {
    warn(common, "units-contradict", file.string() + ": " + info.unit_doubt);
  }
}

LengthUnit environment_unit_of(const FileUnit& unit) {
  for (const LengthUnit known :
       {LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kUsSurveyFoot}) {
    if (unit.metres() == metres_of(known)) return known;
  }
  throw UsageError("the coordinates of a scan in units of " + format_digits(unit.metres(), 9) +
                   " m are not read; expected m, ft, ift or us-ft");
}

/// The inputs' declarations, where inputs that name no unit are given `unit`.
std::vector<CloudInfo> with_unit(std::span<const std::filesystem::path> files,
                                 std::span<const CloudInfo> as_read, const FileUnit& unit,
                                 bool ignore) {
  std::vector<CloudInfo> infos(as_read.begin(), as_read.end());
  if (!unit.is_known()) return infos;
  const LengthUnit given = environment_unit_of(unit);
  for (std::size_t i = 0; i < infos.size(); ++i) {
    CloudInfo& info = infos[i];
    if (!has_unit(info) || (info.any_foot && is_foot(unit.metres()))) {
      info.any_foot = unit.is_any_foot();
      info.unit = given;
    }
    const bool same = info.unit == given || (unit.is_any_foot() && is_foot(metres_of(info.unit)));
    if (!same && !ignore) {
      refuse(files[i].string(), "its unit of length is " + to_string(info.unit) + ", but " +
                                    to_string(given) + " was given; expected the same unit");
    }
  }
  return infos;
}

/// Caches coordinate reference systems, so that each is parsed only once although many files have
/// the same.
class CrsNames {
 public:
  const ScanCrs& of(const CloudInfo& info) {
    const std::string& text = info.crs.empty() ? info.crs_wkt : info.crs;
    const auto known = known_.find(text);
    if (known != known_.end()) return known->second;
    return known_[text] = scan_crs_of(text);
  }

 private:
  std::map<std::string, ScanCrs> known_;
};

bool names_crs(const CloudInfo& info) { return !info.crs_wkt.empty() || !info.crs.empty(); }

/// Whether both inputs certainly have the same coordinate reference system. GeoTIFF keys give the
/// code of the horizontal part, so only that is compared where an input has no well-known text.
bool has_same_crs(const CloudInfo& a, const CloudInfo& b, CrsNames& names) {
  if (a.crs_wkt == b.crs_wkt && a.crs == b.crs) return true;
  const ScanCrs &of_a = names.of(a), &of_b = names.of(b);
  const bool texts = !a.crs_wkt.empty() && !b.crs_wkt.empty();
  const std::int32_t code = texts ? of_a.epsg : of_a.horizontal_epsg;
  return code != 0 && code == (texts ? of_b.epsg : of_b.horizontal_epsg);
}

/// A reference system in words: "ETRS89 / UTM zone 32N, EPSG:25832".
std::string crs_label(const ScanCrs& crs) {
  const std::int32_t number = crs.epsg != 0 ? crs.epsg : crs.horizontal_epsg;
  if (number == 0) return crs.name + ", without an EPSG code";
  const std::string code = "EPSG:" + std::to_string(number);
  return crs.name == code ? code : crs.name + ", " + code;
}

/// Chooses the first well-known text that any input has. Warns of inputs in systems other than the
/// first one's, and notes inputs without any.
void choose_crs(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                CommonCrs& common) {
  const auto first = std::ranges::find_if(infos, names_crs);
  if (first == infos.end()) return;
  const auto text =
      std::ranges::find_if(infos, [](const CloudInfo& info) { return !info.crs_wkt.empty(); });
  if (text != infos.end()) common.wkt = text->crs_wkt;
  const auto read =
      std::ranges::find_if(infos, [](const CloudInfo& info) { return !info.crs.empty(); });
  if (read != infos.end()) common.crs = read->crs;
  const std::string source = files[static_cast<std::size_t>(first - infos.begin())].string();
  CrsNames names;
  std::size_t unnamed = 0;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (!names_crs(infos[i])) {
      ++unnamed;
    } else if (!has_same_crs(infos[i], *first, names)) {
      warn(common, "other-crs",
           files[i].string() + ": another coordinate reference system (" +
               crs_label(names.of(infos[i])) + ") than " + source + " (" +
               crs_label(names.of(*first)) +
               "). The coordinates are merged as they are, so the scans may not fit together");
    }
  }
  if (unnamed == 0) return;
  common.warnings.push_back(
      note("no-crs",
           std::to_string(unnamed) + " of " + std::to_string(infos.size()) +
               " files name no coordinate reference system. They are taken to "
               "be in that of " +
               source,
           {{"files", static_cast<double>(unnamed)}}));
}

}  // namespace

namespace {

/// The unit of the first input that names it.
void choose_unit(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                 bool ignore, CommonCrs& common) {
  // A "ft" in a text file means the foot of another input that says which one it uses.
  const auto says_which = [](const CloudInfo& info) { return has_unit(info) && !info.any_foot; };
  auto known = std::find_if(infos.begin(), infos.end(), has_unit);
  if (known == infos.end()) return;
  if (known->any_foot) {
    const auto exact = std::find_if(infos.begin(), infos.end(), says_which);
    if (exact != infos.end() && is_foot(metres_of(exact->unit))) known = exact;
  }
  common.unit = known->unit;
  const auto& first = files[static_cast<std::size_t>(known - infos.begin())];
  for (std::size_t i = 0; i < infos.size(); ++i) {
    // An input that names no unit is taken to be in metres.
    const bool same_foot = infos[i].any_foot && is_foot(metres_of(common.unit));
    const bool agrees = infos[i].unit == common.unit || same_foot ||
                        (!has_unit(infos[i]) && common.unit == LengthUnit::kMetre);
    if (agrees) continue;
    refuse_or_warn(files[i], "its unit of length is " + to_string(infos[i].unit),
                   ", expected " + to_string(common.unit) + " as in " + first.string(), ignore,
                   common);
  }
}

/// Compares the units of heights with that of the other coordinates, or with the given one, to
/// which heights are then converted.
void choose_heights(std::span<const std::filesystem::path> files, std::span<const CloudInfo> infos,
                    const GivenUnits& given, CommonCrs& common) {
  if (!given.unit_z.is_known()) {
    for (std::size_t i = 0; i < infos.size(); ++i) {
      const std::string trouble = heights_trouble(infos[i].height_unit, common.unit);
      if (trouble.empty()) continue;
      refuse_or_warn(files[i], trouble, "; expected one unit for all of them", given.ignore_crs,
                     common, infos[i].height_unit);
    }
    return;
  }
  if (common.unit == LengthUnit::kDegrees) {
    throw UsageError(
        "heights are converted to the unit of the other coordinates, and these are in degrees");
  }
  const double plane = metres_of(common.unit) > 0 ? metres_of(common.unit) : 1;
  common.height_unit = given.unit_z.metres_in(plane);
  common.height_factor = common.height_unit / plane;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const double named = infos[i].height_unit;
    if (named == 0 || std::abs(named - common.height_unit) <= kSameHeights * named) continue;
    refuse_or_warn(
        files[i], "its heights are in " + name_of_length(named),
        ", but " + name_of_length(common.height_unit) + " was given; expected the same unit",
        given.ignore_crs, common);
  }
}

/// Warns of heights whose unit an input names, while it names none for its other coordinates.
void warn_of_lone_heights(std::span<const std::filesystem::path> files,
                          std::span<const CloudInfo> infos, CommonCrs& common) {
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const double metres = infos[i].height_unit;
    if (has_unit(infos[i]) || metres == 0 || std::abs(metres - 1) <= kSameHeights) continue;
    warn(common, "units-contradict",
         files[i].string() + ": its heights are in " + name_of_length(metres) +
             ", and no unit of its other coordinates is named. They are taken for metres; name "
             "another unit where they are in one");
  }
}

}  // namespace

CommonCrs common_crs(std::span<const std::filesystem::path> files,
                     std::span<const CloudInfo> as_read, const GivenUnits& given) {
  CommonCrs common;
  const bool ignore = given.ignore_crs;
  const std::vector<CloudInfo> infos = with_unit(files, as_read, given.unit, ignore);
  for (std::size_t i = 0; i < infos.size(); ++i) check_own(files[i], infos[i], ignore, common);
  common.is_partly_read = std::ranges::any_of(infos, [](const CloudInfo& info) {
    return !info.crs_unread.empty() || !info.unit_unread.empty() || !info.crs_doubt.empty();
  });
  choose_unit(files, infos, ignore, common);
  if (!given.unit_z.is_known()) warn_of_lone_heights(files, infos, common);
  choose_heights(files, infos, given, common);
  choose_crs(files, infos, common);
  if (common.unit == LengthUnit::kFoot || common.unit == LengthUnit::kUsSurveyFoot) {
    warn(common, "feet",
         "the coordinates are in feet (" + to_string(common.unit) +
             "): lengths, models and trajectories without a unit of their own are taken in feet "
             "too");
  }
  return common;
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
  return common_crs(files, infos, {options.unit, options.unit_z, options.ignore_crs});
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
  const auto floating = std::find_if_not(infos.begin(), infos.end(), has_integers);
  const auto count = infos.size() - static_cast<std::size_t>(
                                        std::count_if(infos.begin(), infos.end(), has_integers));
  if (count == 0 || count == infos.size()) return std::nullopt;
  const auto integers = std::find_if(infos.begin(), infos.end(), has_integers);
  const double step = *std::max_element(quantisation.scale, quantisation.scale + 3);
  const bool as_models_are = std::any_of(files.begin(), files.end(), [](const auto& file) {
    return file.extension() == ".ply" || file.extension() == ".PLY";
  });
  return warning_or_note(
      step > kCoarseStep || as_models_are, "floating-point-rounded",
      std::to_string(count) + " of " + std::to_string(infos.size()) +
          " files have floating-point coordinates, the first is " +
          files[static_cast<std::size_t>(floating - infos.begin())].string() +
          ". They are rounded to the steps of " +
          files[static_cast<std::size_t>(integers - infos.begin())].string() + ", " +
          format_digits(step, 9) +
          (as_models_are ? ". Is one of them the model? It does not belong among the "
                           "scans"
                         : ""),
      {{"files", static_cast<double>(count)}, {"step", step}});
}

}  // namespace clearway
