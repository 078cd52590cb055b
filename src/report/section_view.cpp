#include "report/section_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "clearway/error.hpp"
#include "core/describe/section_report.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/point_classes.hpp"
#include "core/section/section_intrusions.hpp"
#include "core/util/format.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/store/store_reader.hpp"
#include "report/report_facts.hpp"
#include "report/section_words.hpp"
#include "search/section.hpp"

namespace clearway {
namespace {

/// The most bits of cells of stretches that a page takes: 16 MB before they are packed.
constexpr double kMostCellBits = 128e6;
/// The most widths of bands in stretches that a page takes.
constexpr double kMostWidths = 2e6;
/// How many of a stretch's cells are searched for names of obstacles, besides the deepest.
constexpr std::size_t kLooksPerStretch = 24;

void check_obstacles(const SectionPicture& picture) {
  if (picture.obstacles.empty()) return;
  if (picture.store == nullptr || picture.path == nullptr) {
    throw UsageError(
        "names of obstacles need the store and the path of the section, because they "
        "belong to points");
  }
  const double metre = picture.store->metres_per_unit();
  const Box all = picture.store->box().grown(metre > 0 ? 0.01 / metre : 0.01);
  for (const NamedObstacle& obstacle : picture.obstacles) {
    if (all.contains(obstacle.box.lo) && all.contains(obstacle.box.hi)) continue;
    throw InputError("the obstacle \"" + obstacle.name +
                         "\" lies outside of the environment, so the conflicts are those of "
                         "another one",
                     Remedy::kSameEnvironment);
  }
}

/// The name of the smallest obstacle around a point; empty where there is none.
std::string name_at(const Vec3& point, std::span<const NamedObstacle> obstacles, double slack) {
  std::string name;
  double least = std::numeric_limits<double>::infinity();
  for (const NamedObstacle& obstacle : obstacles) {
    const Vec3 size = obstacle.box.hi - obstacle.box.lo;
    if (!obstacle.box.grown(slack).contains(point) || size.x * size.y * size.z >= least) continue;
    least = size.x * size.y * size.z;
    name = obstacle.name;
  }
  return name;
}

/// Whether something comes from the left or the right, and not from above or below.
bool is_across(Side side) { return side == Side::kLeft || side == Side::kRight; }

double cleared_to(const SectionIntrusion& intrusion, double cell) {
  const double at = intrusion.cell[is_across(intrusion.side) ? 0 : 1];
  const bool is_beyond = intrusion.side == Side::kLeft || intrusion.side == Side::kAbove;
  return is_beyond ? at * cell + intrusion.depth : (at + 1) * cell - intrusion.depth;
}

/// Two digits, rounded away from zero, so that what is cleared is enough.
std::string outwards(double value) {
  const double hundredths = std::ceil(std::abs(value) * 100 - 1e-6);
  return fmt::format("{}{:.2f}", value < 0 && hundredths > 0 ? "-" : "", hundredths / 100);
}

/// How wide, or for what comes from above or below how high, an outline is.
double size_across(std::span<const OutlinePoint> outline, Side side) {
  const auto axis = is_across(side) ? &OutlinePoint::y : &OutlinePoint::z;
  const auto [least, most] = std::ranges::minmax(outline, {}, axis);
  return most.*axis - least.*axis;
}

std::string capitalized(std::string words) {
  if (!words.empty()) words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words;
}

/// "A" to "Z", then "AA" and so on.
std::string letters(std::size_t number) {
  std::string out(1, static_cast<char>('A' + number % 26));
  return number < 26 ? out : letters(number / 26 - 1) + out;
}

/// Whether two intrusions overlap across the path, or lie within a cell of each other.
bool overlap_across(const SectionIntrusion& a, const SectionIntrusion& b, double cell) {
  return a.y_from <= b.y_to + cell && b.y_from <= a.y_to + cell && a.z_from <= b.z_to + cell &&
         b.z_from <= a.z_to + cell;
}

}  // namespace

SectionView::SectionView(const Section& of, const SectionPicture& shown)
    : section(of), picture(shown), lattice(lattice_of(of.data())), unit(section_unit(of.data())) {
  check_obstacles(picture);
  bands_ = section_bands(section, picture.heights);
  stretches_ = section_stations(section, picture.heights);
  const double widths = static_cast<double>(stretches_.size()) * static_cast<double>(bands_.size());
  if (widths > kMostWidths) {
    throw UsageError("widths of " + counted(bands_.size(), "band") + " in " +
                     counted(stretches_.size(), "stretch", "stretches") +
                     " are too many for a page; expected bands that are higher");
  }
  if (picture.outline.empty() && picture.table.rows.empty()) return;
  check_loads();
  find_stops();
  if (picture.store != nullptr && picture.path != nullptr) find_obstacles();
  find_places();
}

/// Judges the outline, or the table.
void SectionView::check_loads() {
  if (picture.table.rows.empty()) {
    const double margin = picture.margin.value_or(section.data().parameters.margin);
    static_cast<SectionCheck&>(check.emplace()) = section.check(picture.outline, margin);
    add_load({.outline_name = picture.outline_name, .outline = picture.outline, .margin = margin});
    return;
  }
  check = section.check(picture.table, picture.margin, picture.station);
  for (std::size_t i = 0; i < picture.table.rows.size(); ++i) {
    const OutlineRow& row = picture.table.rows[i];
    add_load({.outline_name = row.file.string(),
              .outline = row.outline,
              .margin = check->rows[i].margin});
  }
}

/// Notes the load of the next row, and adds it where it is not there yet.
void SectionView::add_load(ShownLoad load) {
  const auto same = std::ranges::find_if(loads, [&](const ShownLoad& other) {
    return other.outline_name == load.outline_name && other.margin == load.margin;
  });
  load_of_row_.push_back(static_cast<std::size_t>(same - loads.begin()));
  if (same != loads.end()) return;
  load.stopping = stopping_cells(section, load.outline, load.margin);
  loads.push_back(std::move(load));
}

std::vector<std::size_t> SectionView::stopping_in(const ShownStop& stop) const {
  const SectionCells& all = section.data().bin_cells;
  std::vector<std::size_t> cells;
  const auto begin = std::ranges::lower_bound(all.bin, stop.stop.bin);
  for (auto i = static_cast<std::size_t>(begin - all.bin.begin());
       i < all.size() && all.bin[i] == stop.stop.bin; ++i) {
    const std::size_t cell = index_of_cell(section.cells(), all.j[i], all.k[i]);
    if (loads[stop.load].stopping[cell]) cells.push_back(i);
  }
  return cells;
}

void SectionView::find_stops() {
  const SectionCells& all = section.data().bin_cells;
  stopping.resize(section.cells().size());
  for (const SectionStop& stop : check->stops) {
    ShownStop& shown = stops.emplace_back(ShownStop{.stop = stop, .load = load_of_row_[stop.row]});
    for (const SectionIntrusion& in : stop.intrusions) {
      shown.intrusions.push_back({in, cleared_to(in, lattice.cell)});
      if (!shown.remedy.empty()) shown.remedy += "; and ";
      shown.remedy += remedy_of(shown.intrusions.back(), loads[shown.load]);
    }
    shown.remedy = capitalized(shown.remedy);
    for (const std::size_t i : stopping_in(shown)) {
      stopping[index_of_cell(section.cells(), all.j[i], all.k[i])] = true;
    }
  }
}

void SectionView::find_places() {
  std::vector<const ShownIntrusion*> last;  // of each place
  for (std::size_t s = 0; s < stops.size(); ++s) {
    const std::uint32_t bin = stops[s].stop.bin;
    for (const ShownIntrusion& in : stops[s].intrusions) {
      const auto goes_on = [&](const ShownPlace& place) {
        const ShownIntrusion& before = *last[static_cast<std::size_t>(&place - places.data())];
        if (before.side != in.side || before.obstacle != in.obstacle ||
            place.load != stops[s].load) {
          return false;
        }
        return !in.obstacle.empty() || (stops[place.stops.back() - 1].stop.bin + 1 == bin &&
                                        overlap_across(before, in, lattice.cell));
      };
      auto place = std::ranges::find_if(places, goes_on);
      if (place == places.end()) {
        last.push_back(&in);
        place = places.insert(place, {in, "", stops[s].load});
        place->chainage_from = bin * section.data().parameters.bin;
      }
      last[static_cast<std::size_t>(place - places.begin())] = &in;
      const double z_from = std::min(place->z_from, in.z_from);
      const double z_to = std::max(place->z_to, in.z_to);
      if (in.depth > place->depth) static_cast<ShownIntrusion&>(*place) = in;
      place->z_from = z_from;
      place->z_to = z_to;
      place->chainage_to =
          std::min((bin + 1.0) * section.data().parameters.bin, section.data().chainage.back());
      place->stops.push_back(s + 1);
    }
  }
  std::ranges::stable_sort(places, std::greater{}, &ShownPlace::depth);
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i].label = letters(i);
    places[i].remedy = capitalized(remedy_of(places[i], loads[places[i].load]));
  }
}

void SectionView::find_obstacles() {
  const SectionData& data = section.data();
  const SectionCells& all = data.bin_cells;
  std::vector<SectionPlace> wanted;  // of each stop its intrusions, and then some of its cells
  std::vector<std::size_t> end;
  for (const ShownStop& stop : stops) {
    for (const ShownIntrusion& in : stop.intrusions) wanted.push_back({in.first_pose, in.cell});
    const std::vector<std::size_t> cells =
        picture.obstacles.empty() ? std::vector<std::size_t>{} : stopping_in(stop);
    const std::size_t looks = std::min(kLooksPerStretch, cells.size());
    for (std::size_t look = 0; look < looks; ++look) {
      const std::size_t cell = cells[look * cells.size() / looks];
      wanted.push_back({all.first_pose[cell], {all.j[cell], all.k[cell]}});
    }
    end.push_back(wanted.size());
  }
  const auto witnesses = section_witnesses(data, *picture.store, *picture.path, wanted);
  const double slack = 0.01 / picture.store->metres_per_unit();
  std::size_t next = 0;
  for (std::size_t s = 0; s < stops.size(); ++s) {
    std::map<std::string, int> names;
    const std::size_t first = next;
    for (; next < end[s]; ++next) {
      const auto& witness = witnesses[next];
      const std::string name = witness ? name_at(witness->xyz, picture.obstacles, slack) : "";
      if (!name.empty()) ++names[name];
      if (next - first >= stops[s].intrusions.size()) continue;
      stops[s].intrusions[next - first].witness = witness;
      stops[s].intrusions[next - first].obstacle = name;
    }
    for (const auto& [name, times] : names) stops[s].obstacles.push_back(name);
    std::ranges::stable_sort(stops[s].obstacles, std::greater{},
                             [&](const std::string& name) { return names[name]; });
  }
}

std::string SectionView::sentence() const {
  if (!check) return widths_sentence(section, picture.heights);
  if (!picture.table.rows.empty()) return table_sentence(*check, section.data());
  return verdict_sentence(*check, section.data(), loads[0].margin);
}

const SectionCells& SectionView::not_known() const {
  static const SectionCells none;
  return section.data().unknown ? *section.data().unknown : none;
}

std::string SectionView::caution() const {
  const bool some = not_known().size() > 0;
  return some ? "Hatched cells are not known, because no beam crossed them. White cells have no "
                "point and were crossed by a beam somewhere"
              : "White says that no point is there. Whether a scanner looked there is not known: "
                "cells above its view, behind other objects, or between sparse points look free";
}

/// A load that is smaller by the depth is named as a remedy too, unless little would be left of it.
std::string SectionView::remedy_of(const ShownIntrusion& in, const ShownLoad& load) const {
  const auto or_smaller = [&](const char* begin, const char* end) {
    return in.depth < size_across(load.outline, in.side) / 2
               ? fmt::format(", or {} the load {} {} {}", begin, outwards(in.depth), unit, end)
               : "";
  };
  const std::string to = outwards(in.clear_to) + " " + unit;
  if (is_across(in.side)) {
    return fmt::format("clear {} to y = {} between z = {} and {} {}{}", words_of(in.side).on, to,
                       format_brief(in.z_from), format_brief(in.z_to), unit,
                       or_smaller("make", "narrower there"));
  }
  return in.side == Side::kAbove ? "clear up to z = " + to + or_smaller("make", "lower")
                                 : "clear down to z = " + to + or_smaller("begin", "higher");
}

bool SectionView::has_cells_of_bins() const {
  return static_cast<double>(lattice.cells()) * static_cast<double>(stretches_.size()) <=
         kMostCellBits;
}

// The library of JSON finds these by their arguments, so they stand in the namespace of these.

static void to_json(Json& json, const SectionWitness& witness) {
  json = {{"source", witness.source},
          {"xyz", witness.xyz},
          {"class", witness.point_class},
          {"class_name", class_name(witness.point_class)}};
}

static void to_json(Json& json, const ShownIntrusion& in) {
  using In = ShownIntrusion;
  json = members_json<&In::side, &In::depth, &In::clear_to, &In::cells, &In::first_pose,
                      &In::chainage, &In::cell, &In::y_from, &In::y_to, &In::z_from, &In::z_to,
                      &In::obstacle, &In::witness>(in);
}

static void to_json(Json& json, const ShownStop& stop) {
  using Stop = SectionStop;
  json = members_json<&Stop::bin>(stop.stop);
  json["load"] = stop.load;
  json.update(members_json<&Stop::first_pose, &Stop::chainage, &Stop::cell>(stop.stop));
  json.update(
      members_json<&ShownStop::remedy, &ShownStop::obstacles, &ShownStop::intrusions>(stop));
}

static void to_json(Json& json, const ShownPlace& place) {
  using Place = ShownPlace;
  to_json(json, static_cast<const ShownIntrusion&>(place));
  json.update(members_json<&Place::label, &Place::load, &Place::stops, &Place::chainage_from,
                           &Place::chainage_to, &Place::remedy>(place));
}

static void to_json(Json& json, const OutlinePoint& point) { json = {point.y, point.z}; }

static void to_json(Json& json, const ShownLoad& load) {
  json = members_json<&ShownLoad::outline_name, &ShownLoad::margin, &ShownLoad::outline>(load);
}

static void to_json(Json& json, const HalfWidth& half) { json = half.width; }
static void to_json(Json& json, const BodyPivots& pivots) { json = {pivots.front, pivots.rear}; }

Json SectionView::json_of_check() const {
  if (!check) return {};
  Json out = members_json<&SectionCheck::verdict, &SectionCheck::reason>(*check);
  out["loads"] = loads;
  out["rows"] = Json::array();
  for (std::size_t i = 0; i < check->rows.size(); ++i) {
    using Row = OutlineRowCheck;
    const Row& row = check->rows[i];
    Json& json = out["rows"].emplace_back(members_json<&Row::line>(row));
    json["load"] = load_of_row_[i];
    json.update(members_json<&Row::chainage_from, &Row::chainage_to, &Row::bins>(row));
    json["verdict"] = row.bins ? Json(name_of(row.check.verdict)) : Json();
    json["reason"] = row.check.reason;
  }
  out["gaps"] = json_of_fact(check->gaps);
  out["places"] = places;
  out["stops"] = stops;
  return out;
}

Json SectionView::facts() const {
  using Asked = SectionParameters;
  const SectionData& data = section.data();
  const auto bands = [&](const std::vector<SectionBand>& list) {
    return list_of(list, [&](const SectionBand& band) {
      using Band = SectionBand;
      Json out = members_json<&Band::z_from, &Band::z_to, &Band::left, &Band::right>(band);
      out["symmetric_width"] = json_of_fact(symmetric_width(data, band));
      return out;
    });
  };
  Json out{{"name", picture.section_name}, {"sentence", sentence()}, {"caution", caution()}};
  out.update(members_json<&Asked::rear, &Asked::front, &Asked::cell, &Asked::bin, &Asked::margin,
                          &Asked::between_poses, &Asked::pivots>(data.parameters));
  out["rounding"] = data.rounding;
  out["kept"] = kept_beside(data);
  out["points"] = data.environment_points;
  out["ignored_points"] = data.ignored_points;
  out["ignored"] = ignored_text(ignored_by(data.parameters));
  out.update(
      members_json<&SectionData::ignored_cells, &SectionData::poses, &SectionData::load_poses>(
          data));
  out["length"] = data.chainage.empty() ? 0.0 : data.chainage.back();
  out["environment_name"] = picture.environment_name;
  out["trajectory_name"] = picture.trajectory_name;
  out["scans"] = picture.store ? json_of_scans(picture.store->reader().metadata()) : Json();
  out["environment_hash"] = hash_text(data.environment_hash);
  out["trajectory_hash"] = hash_text(data.trajectory_hash);
  out.update(members_json<&SectionLattice::columns, &SectionLattice::rows, &SectionLattice::j_from,
                          &SectionLattice::k_from>(lattice));
  out["colours"] = kSectionColours;
  out["blocked"] = section.cells().size();
  out["not_known"] = not_known().size();
  out["has_cells_of_bins"] = has_cells_of_bins();
  out["bins"] = data.bins;
  out["bands"] = bands(bands_);
  out["boxes"] = bands(section_boxes(section, picture.heights));
  out["check"] = json_of_check();
  return out;
}

void SectionView::add_columns(std::vector<PageColumn>& columns) const {
  const SectionData& data = section.data();
  const auto add_integers = [&](const char* name, const auto& list, const auto& integer) {
    std::vector<std::int32_t> values;
    for (const auto& item : list) values.push_back(static_cast<std::int32_t>(integer(item)));
    columns.push_back({std::string("section.") + name, delta_planes(values)});
  };
  // Appends a bit for each cell of the window, row by row from below and from the least j: whether
  // it is one of the cells from `first` to `end` that are wanted.
  const auto append_bits = [&](const SectionCells& cells, std::size_t first, std::size_t end,
                               const auto& is_wanted, std::string& bits) {
    const std::size_t before = bits.size();
    bits.resize(before + (lattice.cells() + 7) / 8);
    for (std::size_t i = first; i < end; ++i) {
      if (!is_wanted(i)) continue;
      const auto at = static_cast<std::size_t>(cells.k[i] - lattice.k_from) * lattice.columns +
                      static_cast<std::size_t>(cells.j[i] - lattice.j_from);
      bits[before + at / 8] = static_cast<char>(bits[before + at / 8] | 1 << at % 8);
    }
  };
  const auto all = [](std::size_t) { return true; };
  const SectionCells& cells = section.cells();
  add_integers("chainage", data.chainage,
               [](double at) { return std::min(std::round(at * 1000), 0x1p31 - 1); });
  append_bits(cells, 0, cells.size(), all,
              columns.emplace_back(PageColumn{"section.whole", {}}).bytes);
  add_integers("first", cells.first_pose, std::identity());
  if (check) {
    std::string& bits = columns.emplace_back(PageColumn{"section.stops", {}}).bytes;
    const auto append = [&](const std::vector<bool>& wanted) {
      append_bits(
          cells, 0, cells.size(), [&](std::size_t i) { return wanted[i]; }, bits);
    };
    append(stopping);
    for (const ShownLoad& load : loads) {
      if (loads.size() > 1) append(load.stopping);
    }
  }
  std::vector<SectionBand> widths;
  for (const SectionStretch& stretch : stretches_) {
    widths.insert(widths.end(), stretch.bands.begin(), stretch.bands.end());
  }
  widths.insert(widths.end(), bands_.begin(), bands_.end());
  const auto add_side = [&](const char* width, const char* pose, auto side) {
    add_integers(width, widths, [&](const SectionBand& band) {
      return band.*side ? std::round((band.*side)->width / lattice.cell) : -1;
    });
    add_integers(pose, widths, [&](const SectionBand& band) {
      return band.*side ? static_cast<double>((band.*side)->first_pose) : -1;
    });
  };
  add_side("left", "left_pose", &SectionBand::left);
  add_side("right", "right_pose", &SectionBand::right);
  if (!has_cells_of_bins()) return;
  const auto add_bins = [&](const char* name, const SectionCells& of) {
    std::string& bits = columns.emplace_back(PageColumn{name, {}}).bytes;
    for (const std::uint32_t bin : data.bins) {
      const auto [first, end] = std::ranges::equal_range(of.bin, bin);
      append_bits(of, static_cast<std::size_t>(first - of.bin.begin()),
                  static_cast<std::size_t>(end - of.bin.begin()), all, bits);
    }
  };
  add_bins("section.cells", data.bin_cells);
  if (not_known().size() > 0) add_bins("section.unknown", not_known());
}

}  // namespace clearway
