#include "io/store/convert/input_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "clearway/error.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/scan_crs.hpp"
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

void warn(CommonCrs& common, const char* code, const std::string& text) {
  common.warnings.push_back({Message::Severity::kWarning, code, text});
}

bool has_unit(const CloudInfo& info) { return info.unit != LengthUnit::kUnknown; }

void refuse_units(const std::filesystem::path& file, const CloudInfo& info) {
  if (!info.unit_trouble.empty()) {
    refuse(file.string(),
           info.unit_trouble + "; expected metres or feet for all of them. Convert the scan first",
           Remedy::kIgnoreCrs);
  }
  if (info.unit != LengthUnit::kDegrees) return;
  refuse(file.string(),
         "its coordinate reference system is in degrees, expected lengths; project the scan first",
         Remedy::kIgnoreCrs);
}

[[noreturn]] void refuse_unit(const std::filesystem::path& file, LengthUnit found,
                              const std::filesystem::path& other, LengthUnit expected) {
  refuse(file.string(),
         "its unit of length is " + to_string(found) + ", expected " + to_string(expected) +
             " as in " + other.string(),
         Remedy::kIgnoreCrs);
}

LengthUnit environment_unit_of(const FileUnit& unit) {
  for (const LengthUnit known :
       {LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kUsSurveyFoot}) {
    if (unit.metres() == metres_of(known)) return known;
  }
  throw UsageError("the coordinates of a scan in units of " + brief(unit.metres()) +
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
    const std::string key =
        info.crs_wkt.empty() ? "EPSG:" + std::to_string(info.crs_epsg) : info.crs_wkt;
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
    return known_[key] =
               info.crs_wkt.empty() ? scan_crs_of_epsg(info.crs_epsg) : scan_crs_of(info.crs_wkt);
  }

 private:
  std::map<std::string, ScanCrs> known_;
};

bool names_crs(const CloudInfo& info) { return !info.crs_wkt.empty() || info.crs_epsg != 0; }

/// Whether both inputs certainly have the same coordinate reference system. GeoTIFF keys give the
/// code of the horizontal part, so only that is compared where an input has no well-known text.
bool has_same_crs(const CloudInfo& a, const CloudInfo& b, CrsNames& names) {
  if (a.crs_wkt == b.crs_wkt && a.crs_epsg == b.crs_epsg) return true;
  const ScanCrs &of_a = names.of(a), &of_b = names.of(b);
  const bool texts = !a.crs_wkt.empty() && !b.crs_wkt.empty();
  const std::int32_t code = texts ? of_a.epsg : of_a.horizontal_epsg;
  return code != 0 && code == (texts ? of_b.epsg : of_b.horizontal_epsg);
}

/// A reference system in words: "ETRS89 / UTM zone 32N, EPSG:25832".
std::string crs_label(const ScanCrs& crs) {
  if (crs.epsg == 0) return crs.name + ", without an EPSG code";
  const std::string code = "EPSG:" + std::to_string(crs.epsg);
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
  common.warnings.push_back({Message::Severity::kNote,
                             "no-crs",
                             std::to_string(unnamed) + " of " + std::to_string(infos.size()) +
                                 " files name no coordinate reference system. They are taken to "
                                 "be in that of " +
                                 source,
                             {{"files", static_cast<double>(unnamed)}}});
}

}  // namespace

CommonCrs common_crs(std::span<const std::filesystem::path> files,
                     std::span<const CloudInfo> as_read, const FileUnit& unit, bool ignore) {
  CommonCrs common;
  const std::vector<CloudInfo> infos = with_unit(files, as_read, unit, ignore);
  for (std::size_t i = 0; i < infos.size() && !ignore; ++i) refuse_units(files[i], infos[i]);
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (infos[i].unit_doubt.empty()) continue;
    warn(common, "units-contradict", files[i].string() + ": " + infos[i].unit_doubt);
  }
  // A "ft" in a text file means the foot of another input that says which one it uses.
  const auto says_which = [](const CloudInfo& info) { return has_unit(info) && !info.any_foot; };
  auto known = std::find_if(infos.begin(), infos.end(), has_unit);
  if (known != infos.end() && known->any_foot) {
    const auto exact = std::find_if(infos.begin(), infos.end(), says_which);
    if (exact != infos.end() && is_foot(metres_of(exact->unit))) known = exact;
  }
  if (known != infos.end()) {
    common.unit = known->unit;
    const auto& first = files[static_cast<std::size_t>(known - infos.begin())];
    for (std::size_t i = 0; i < infos.size() && !ignore; ++i) {
      // An input that names no unit is taken to be in metres.
      const bool same_foot = infos[i].any_foot && is_foot(metres_of(common.unit));
      const bool agrees = infos[i].unit == common.unit || same_foot ||
                          (!has_unit(infos[i]) && common.unit == LengthUnit::kMetre);
      if (!agrees) refuse_unit(files[i], infos[i].unit, first, common.unit);
    }
  }
  choose_crs(files, infos, common);
  if (common.unit == LengthUnit::kFoot || common.unit == LengthUnit::kUsSurveyFoot) {
    warn(common, "feet",
         "the coordinates are in feet (" + to_string(common.unit) +
             "): lengths, models and trajectories without a unit of their own are taken in feet "
             "too");
  }
  return common;
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
  return Message{
      step > kCoarseStep || as_models_are ? Message::Severity::kWarning : Message::Severity::kNote,
      "floating-point-rounded",
      std::to_string(count) + " of " + std::to_string(infos.size()) +
          " files have floating-point coordinates, the first is " +
          files[static_cast<std::size_t>(floating - infos.begin())].string() +
          ". They are rounded to the steps of " +
          files[static_cast<std::size_t>(integers - infos.begin())].string() + ", " + brief(step) +
          (as_models_are ? ". Is one of them the model? It does not belong among the "
                           "scans"
                         : ""),
      {{"files", static_cast<double>(count)}, {"step", step}}};
}

}  // namespace clearway
