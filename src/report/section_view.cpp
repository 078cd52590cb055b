#include "report/section_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "clearway/error.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/point_classes.hpp"
#include "core/section/section_intrusions.hpp"
#include "core/util/format.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/store/store_metadata.hpp"
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
  const Box all = picture.store->box();
  const double slack =
      picture.store->metres_per_unit() > 0 ? 0.01 / picture.store->metres_per_unit() : 0.01;
  for (const NamedObstacle& obstacle : picture.obstacles) {
    const Box box = obstacle.box;
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      inside = inside && box.lo[k] >= all.lo[k] - slack && box.hi[k] <= all.hi[k] + slack;
    }
    if (inside) continue;
    throw InputError("the obstacle \"" + obstacle.name +
                         "\" lies outside of the environment, so the conflicts are those of "
                         "another one",
                     Remedy::kSameEnvironment);
  }
}

double volume(const Box& box) {
  return (box.hi.x - box.lo.x) * (box.hi.y - box.lo.y) * (box.hi.z - box.lo.z);
}

/// The name of the smallest obstacle around a point; empty where there is none.
std::string name_at(const Vec3& point, std::span<const NamedObstacle> obstacles, double slack) {
  const NamedObstacle* best = nullptr;
  for (const NamedObstacle& obstacle : obstacles) {
    if (!obstacle.box.grown(slack).contains(point)) continue;
    if (best == nullptr || volume(obstacle.box) < volume(best->box)) best = &obstacle;
  }
  return best == nullptr ? "" : best->name;
}

}  // namespace

SectionView::SectionView(const Section& section, const SectionPicture& picture)
    : section_(section), picture_(picture), lattice_(lattice_of(section.data())) {
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
  find_stopping();
  for (const SectionStop& stop : check_->stops) {
    ShownStop shown{.stop = stop, .load = load_of_row_[stop.row]};
    for (const SectionIntrusion& intrusion : stop.intrusions)
      shown.intrusions.push_back({intrusion});
    stops_.push_back(std::move(shown));
  }
  if (picture.store != nullptr && picture.path != nullptr) find_obstacles();
  find_places();
}

/// Judges the outline as a table of one row, or the table.
void SectionView::check_loads() {
  const OutlineTable& table = picture_.table;
  if (!table.rows.empty()) {
    check_ = section_.check(table, picture_.margin, picture_.station);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      load_of_row_.push_back(add_load({.name = table.rows[i].file.string(),
                                       .outline = table.rows[i].outline,
                                       .margin = check_->rows[i].margin}));
    }
    return;
  }
  const double margin = picture_.margin.value_or(section_.data().parameters.margin);
  check_.emplace();
  static_cast<SectionCheck&>(*check_) = section_.check(picture_.outline, margin);
  check_->rows.push_back(
      {.chainage_to = section_.data().chainage.empty() ? 0.0 : section_.data().chainage.back(),
       .margin = margin,
       .bins = SectionBinRange{},
       .check = *check_});
  load_of_row_.push_back(
      add_load({.name = picture_.outline_name, .outline = picture_.outline, .margin = margin}));
}

/// The index of a load, which is added where it is not there yet.
std::size_t SectionView::add_load(ShownLoad load) {
  const auto same = std::ranges::find_if(loads_, [&](const ShownLoad& other) {
    return other.name == load.name && other.margin == load.margin;
  });
  if (same != loads_.end()) return static_cast<std::size_t>(same - loads_.begin());
  load.stopping = stopping_cells(section_, load.outline, load.margin);
  loads_.push_back(std::move(load));
  return loads_.size() - 1;
}

std::vector<std::size_t> SectionView::stopping_in(const SectionStop& stop,
                                                  const ShownLoad& load) const {
  const SectionCells& all = section_.data().bin_cells;
  std::vector<std::size_t> cells;
  const auto begin = std::ranges::lower_bound(all.bin, stop.bin);
  for (auto i = static_cast<std::size_t>(begin - all.bin.begin());
       i < all.size() && all.bin[i] == stop.bin; ++i) {
    if (load.stopping[index_of_cell(section_.cells(), all.j[i], all.k[i])]) cells.push_back(i);
  }
  return cells;
}

void SectionView::find_stopping() {
  const SectionCells& all = section_.data().bin_cells;
  stopping_.resize(section_.cells().size());
  for (const SectionStop& stop : check_->stops) {
    for (const std::size_t i : stopping_in(stop, loads_[load_of_row_[stop.row]])) {
      stopping_[index_of_cell(section_.cells(), all.j[i], all.k[i])] = true;
    }
  }
}

namespace {

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

void SectionView::find_places() {
  std::vector<const ShownIntrusion*> last;  // of each place
  for (std::size_t s = 0; s < stops_.size(); ++s) {
    const std::uint32_t bin = stops_[s].stop.bin;
    for (const ShownIntrusion& shown : stops_[s].intrusions) {
      const SectionIntrusion& in = shown.intrusion;
      std::size_t at = 0;
      for (; at < places_.size(); ++at) {
        const ShownIntrusion& before = *last[at];
        if (before.intrusion.side != in.side || before.obstacle != shown.obstacle ||
            places_[at].load != stops_[s].load) {
          continue;
        }
        const bool follows = stops_[places_[at].stops.back() - 1].stop.bin + 1 == bin;
        if (!shown.obstacle.empty() ||
            (follows && overlap_across(before.intrusion, in, lattice_.cell))) {
          break;
        }
      }
      if (at == places_.size()) {
        places_.push_back(
            {.load = stops_[s].load, .deepest = shown, .chainage_from = chainage_of_bin(bin)});
        last.push_back(&shown);
      }
      ShownPlace& place = places_[at];
      last[at] = &shown;
      const double z_from = std::min(place.deepest.intrusion.z_from, in.z_from);
      const double z_to = std::max(place.deepest.intrusion.z_to, in.z_to);
      if (in.depth > place.deepest.intrusion.depth) place.deepest = shown;
      place.deepest.intrusion.z_from = z_from;
      place.deepest.intrusion.z_to = z_to;
      place.chainage_to = std::min(chainage_of_bin(bin + 1.0), section_.data().chainage.back());
      place.stops.push_back(s + 1);
    }
  }
  std::ranges::stable_sort(places_, [](const ShownPlace& a, const ShownPlace& b) {
    return a.deepest.intrusion.depth > b.deepest.intrusion.depth;
  });
  for (std::size_t i = 0; i < places_.size(); ++i) places_[i].label = letters(i);
}

void SectionView::find_obstacles() {
  const SectionData& data = section_.data();
  const SectionCells& all = data.bin_cells;
  std::vector<SectionPlace> places;
  std::vector<std::size_t> stop_of;
  for (std::size_t s = 0; s < stops_.size(); ++s) {
    for (const ShownIntrusion& shown : stops_[s].intrusions) {
      places.push_back({shown.intrusion.first_pose, shown.intrusion.cell});
    }
    stop_of.resize(places.size(), s);
    if (picture_.obstacles.empty()) continue;
    const std::vector<std::size_t> cells = stopping_in(stops_[s].stop, loads_[stops_[s].load]);
    const std::size_t looks = std::min(kLooksPerStretch, cells.size());
    for (std::size_t look = 0; look < looks; ++look) {
      const std::size_t cell = cells[look * cells.size() / looks];
      places.push_back({all.first_pose[cell], {all.j[cell], all.k[cell]}});
    }
    stop_of.resize(places.size(), s);
  }
  const auto witnesses = section_witnesses(data, *picture_.store, *picture_.path, places);
  const double slack = 0.01 / picture_.store->metres_per_unit();
  std::size_t next = 0;
  for (std::size_t s = 0; s < stops_.size(); ++s) {
    std::map<std::string, int> names;
    const auto named = [&](const std::optional<SectionWitness>& witness) {
      const std::string name =
          witness ? name_at(witness->xyz, picture_.obstacles, slack) : std::string();
      if (!name.empty()) ++names[name];
      return name;
    };
    for (ShownIntrusion& shown : stops_[s].intrusions) {
      shown.witness = witnesses[next++];
      shown.obstacle = named(shown.witness);
    }
    for (; next < places.size() && stop_of[next] == s; ++next) named(witnesses[next]);
    for (const auto& [name, times] : names) stops_[s].obstacles.push_back(name);
    std::ranges::stable_sort(stops_[s].obstacles,
                             [&](const auto& a, const auto& b) { return names[a] > names[b]; });
  }
}

std::string SectionView::unit() const { return section_unit(section_.data()); }

std::string SectionView::sentence() const {
  if (check_ && !picture_.table.rows.empty()) {
    return table_sentence(*check_, section_.data());
  }
  if (check_) return verdict_sentence(*check_, section_.data(), loads_[0].margin);
  return widths_sentence(section_, picture_.heights);
}

const SectionCells& SectionView::not_known() const {
  static const SectionCells none;
  return section_.data().unknown ? *section_.data().unknown : none;
}

std::string SectionView::caution() const {
  const bool some = not_known().size() > 0;
  return some ? "Hatched cells are not known, because no beam crossed them. White cells have no "
                "point and were crossed by a beam somewhere"
              : "White says that no point is there. Whether a scanner looked there is not known: "
                "cells above its view, behind other objects, or between sparse points look free";
}

namespace {

/// Whether something comes from the left or the right, and not from above or below.
bool is_across(Side side) { return side == Side::kLeft || side == Side::kRight; }

/// The border up to which everything has to be cleared for the load: a y on the left and right, a z
/// above and below.
double cleared_to(const SectionIntrusion& intrusion, double cell) {
  const double at = intrusion.cell[is_across(intrusion.side) ? 0 : 1];
  const bool is_beyond = intrusion.side == Side::kLeft || intrusion.side == Side::kAbove;
  return is_beyond ? at * cell + intrusion.depth : (at + 1) * cell - intrusion.depth;
}

/// Two digits, rounded away from zero, so that what is cleared is enough.
std::string outwards(double value) {
  const double hundredths = std::ceil(std::abs(value) * 100 - 1e-6);
  std::string digits = std::to_string(static_cast<long long>(hundredths));
  while (digits.size() < 3) digits.insert(digits.begin(), '0');
  digits.insert(digits.size() - 2, ".");
  return (value < 0 && hundredths > 0 ? "-" : "") + digits;
}

/// How wide, or for what comes from above or below how high, an outline is.
double size_across(std::span<const OutlinePoint> outline, Side side) {
  const auto axis = is_across(side) ? &OutlinePoint::y : &OutlinePoint::z;
  const auto [least, most] = std::ranges::minmax(outline, {}, axis);
  return most.*axis - least.*axis;
}

/// gives_way: whether a load that is smaller by the depth is named as a remedy too.
std::string remedy_of(const SectionIntrusion& in, double cell, const std::string& unit,
                      bool gives_way) {
  const std::string to = outwards(cleared_to(in, cell)) + " " + unit;
  const auto or_smaller = [&](const char* begin, const char* end) {
    return gives_way
               ? fmt::format(", or {} the load {} {} {}", begin, outwards(in.depth), unit, end)
               : "";
  };
  if (is_across(in.side)) {
    return fmt::format("clear {} to y = {} between z = {} and {} {}{}", words_of(in.side).on, to,
                       format_brief(in.z_from), format_brief(in.z_to), unit,
                       or_smaller("make", "narrower there"));
  }
  return in.side == Side::kAbove ? "clear up to z = " + to + or_smaller("make", "lower")
                                 : "clear down to z = " + to + or_smaller("begin", "higher");
}

std::string capitalized(std::string words) {
  if (!words.empty()) words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words;
}

}  // namespace

std::string SectionView::remedy(const ShownStop& stop) const {
  std::string out;
  for (const ShownIntrusion& shown : stop.intrusions) {
    if (!out.empty()) out += "; and ";
    out += remedy(shown.intrusion, loads_[stop.load]);
  }
  return capitalized(std::move(out));
}

std::string SectionView::remedy(const ShownPlace& place) const {
  return capitalized(remedy(place.deepest.intrusion, loads_[place.load]));
}

std::string SectionView::remedy(const SectionIntrusion& intrusion, const ShownLoad& load) const {
  const bool gives_way = intrusion.depth < size_across(load.outline, intrusion.side) / 2;
  return remedy_of(intrusion, lattice_.cell, unit(), gives_way);
}

bool SectionView::has_cells_of_bins() const {
  return static_cast<double>(lattice_.cells()) * static_cast<double>(stretches_.size()) <=
         kMostCellBits;
}

namespace {

Json json_of(const SectionWitness& witness) {
  return {{"source", witness.source},
          {"xyz", witness.xyz},
          {"class", witness.point_class},
          {"class_name", class_name(witness.point_class)}};
}

Json json_of(const ShownIntrusion& shown, double cell) {
  const SectionIntrusion& in = shown.intrusion;
  return {{"side", name_of(in.side)},
          {"depth", in.depth},
          {"clear_to", cleared_to(in, cell)},
          {"cells", in.cells},
          {"first_pose", in.first_pose},
          {"chainage", in.chainage},
          {"cell", in.cell},
          {"y_from", in.y_from},
          {"y_to", in.y_to},
          {"z_from", in.z_from},
          {"z_to", in.z_to},
          {"obstacle", shown.obstacle},
          {"witness", shown.witness ? json_of(*shown.witness) : Json()}};
}

Json json_of(const SectionData& data, const SectionBand& band) {
  const auto width = [](const std::optional<HalfWidth>& half) {
    return half ? Json(half->width) : Json();
  };
  return {{"z_from", band.z_from},
          {"z_to", band.z_to},
          {"left", width(band.left)},
          {"right", width(band.right)},
          {"symmetric_width", or_null(symmetric_width(data, band))}};
}

Json json_of(const SectionData& data, const std::vector<SectionBand>& bands) {
  Json out = Json::array();
  for (const SectionBand& band : bands) out.push_back(json_of(data, band));
  return out;
}

}  // namespace

void SectionView::add_question(Json& json) const {
  const SectionData& data = section_.data();
  const SectionParameters& asked = data.parameters;
  json["rear"] = asked.rear;
  json["front"] = asked.front;
  json["cell"] = asked.cell;
  json["bin"] = asked.bin;
  json["margin"] = asked.margin;
  json["between_poses"] = asked.between_poses;
  json["pivots"] = asked.pivots ? Json::array({asked.pivots->front, asked.pivots->rear}) : Json();
  json["rounding"] = data.rounding;
  json["kept"] = kept_beside(data);
  json["points"] = data.environment_points;
  json["ignored_points"] = data.ignored_points;
  json["ignored"] = ignored_text(ignored_by(asked));
  json["ignored_cells"] = Json();
  if (data.ignored_cells) {
    json["ignored_cells"] = {{"blocked", data.ignored_cells->blocked},
                             {"high", data.ignored_cells->high}};
  }
  json["poses"] = data.poses;
  json["load_poses"] = data.load_poses;
  json["length"] = data.chainage.empty() ? 0.0 : data.chainage.back();
  json["environment_name"] = picture_.environment_name;
  json["trajectory_name"] = picture_.trajectory_name;
  json["scans"] = picture_.store ? json_of_scans(picture_.store->reader().metadata()) : Json();
  json["environment_hash"] = hash_text(data.environment_hash);
  json["trajectory_hash"] = hash_text(data.trajectory_hash);
}

namespace {

Json json_of(const ShownLoad& load) {
  Json outline = Json::array();
  for (const OutlinePoint& p : load.outline) outline.push_back(Json::array({p.y, p.z}));
  return {{"outline_name", load.name}, {"margin", load.margin}, {"outline", std::move(outline)}};
}

Json json_of(const std::optional<SectionBinRange>& bins) {
  return bins ? Json::array({bins->first, bins->last}) : Json();
}

Json json_of(const OutlineRowCheck& row, std::size_t load) {
  return {{"line", row.line},
          {"load", load},
          {"chainage_from", row.chainage_from},
          {"chainage_to", row.chainage_to},
          {"bins", json_of(row.bins)},
          {"verdict", row.bins ? Json(name_of(row.check.verdict)) : Json()},
          {"reason", row.check.reason}};
}

Json json_of(const OutlineGap& gap) {
  return {{"chainage_from", gap.chainage_from},
          {"chainage_to", gap.chainage_to},
          {"bins", json_of(gap.bins)}};
}

}  // namespace

Json SectionView::json_of_check() const {
  if (!check_) return {};
  Json stops = Json::array();
  for (const ShownStop& shown : stops_) {
    Json intrusions = Json::array();
    for (const ShownIntrusion& in : shown.intrusions) {
      intrusions.push_back(json_of(in, lattice_.cell));
    }
    stops.push_back({{"bin", shown.stop.bin},
                     {"load", shown.load},
                     {"first_pose", shown.stop.first_pose},
                     {"chainage", shown.stop.chainage},
                     {"cell", shown.stop.cell},
                     {"remedy", remedy(shown)},
                     {"obstacles", shown.obstacles},
                     {"intrusions", std::move(intrusions)}});
  }
  Json places = Json::array();
  for (const ShownPlace& place : places_) {
    Json json = json_of(place.deepest, lattice_.cell);
    json["label"] = place.label;
    json["load"] = place.load;
    json["stops"] = place.stops;
    json["chainage_from"] = place.chainage_from;
    json["chainage_to"] = place.chainage_to;
    json["remedy"] = remedy(place);
    places.push_back(std::move(json));
  }
  Json out{{"verdict", name_of(check_->verdict)}, {"reason", check_->reason}};
  Json loads = Json::array(), rows = Json::array(), gaps = Json::array();
  for (const ShownLoad& load : loads_) loads.push_back(json_of(load));
  for (std::size_t i = 0; i < picture_.table.rows.size(); ++i) {
    rows.push_back(json_of(check_->rows[i], load_of_row_[i]));
  }
  for (const OutlineGap& gap : check_->gaps) gaps.push_back(json_of(gap));
  out["loads"] = std::move(loads);
  out["rows"] = std::move(rows);
  out["gaps"] = std::move(gaps);
  out["places"] = std::move(places);
  out["stops"] = std::move(stops);
  return out;
}

Json SectionView::facts() const {
  const SectionData& data = section_.data();
  Json out{{"name", picture_.section_name}, {"sentence", sentence()}, {"caution", caution()}};
  add_question(out);
  out["columns"] = lattice_.columns;
  out["rows"] = lattice_.rows;
  out["j_from"] = lattice_.j_from;
  out["k_from"] = lattice_.k_from;
  out["colours"] = kSectionColours;
  out["blocked"] = section_.cells().size();
  out["not_known"] = not_known().size();
  out["has_cells_of_bins"] = has_cells_of_bins();
  out["bins"] = data.bins;
  out["bands"] = json_of(data, bands_);
  out["boxes"] = json_of(data, section_boxes(section_, picture_.heights));
  out["check"] = json_of_check();
  return out;
}

namespace {

/// Bits in bytes, the first in the lowest bit.
std::string packed(const CellBits& bits) {
  std::string out((bits.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i]) out[i / 8] = static_cast<char>(out[i / 8] | 1 << i % 8);
  }
  return out;
}

void add_integers(const std::string& name, const std::vector<std::int32_t>& values,
                  std::vector<PageColumn>& columns) {
  columns.push_back({name, delta_planes(values)});
}

/// Widths in cells, or -1 where a side is open, and their poses.
void add_widths(const std::string& side, std::optional<HalfWidth> SectionBand::*half,
                const std::vector<const std::vector<SectionBand>*>& rows, double cell,
                std::vector<PageColumn>& columns) {
  std::vector<std::int32_t> widths, poses;
  for (const std::vector<SectionBand>* bands : rows) {
    for (const SectionBand& band : *bands) {
      const std::optional<HalfWidth>& of = band.*half;
      widths.push_back(of ? static_cast<std::int32_t>(std::round(of->width / cell)) : -1);
      poses.push_back(of ? static_cast<std::int32_t>(of->first_pose) : -1);
    }
  }
  add_integers("section." + side, widths, columns);
  add_integers("section." + side + "_pose", poses, columns);
}

}  // namespace

void SectionView::add_columns(std::vector<PageColumn>& columns) const {
  const SectionData& data = section_.data();
  const SectionCells& all = data.bin_cells;
  const std::uint64_t cells = lattice_.cells();
  const auto place = [&](std::int32_t j, std::int32_t k) {
    return static_cast<std::uint64_t>(k - lattice_.k_from) * lattice_.columns +
           static_cast<std::uint64_t>(j - lattice_.j_from);
  };
  std::vector<std::int32_t> millimetres, firsts;
  for (const double at : data.chainage) {
    millimetres.push_back(static_cast<std::int32_t>(std::min(std::round(at * 1000), 0x1p31 - 1)));
  }
  add_integers("section.chainage", millimetres, columns);
  CellBits whole(cells), stops(cells);
  for (std::size_t i = 0; i < section_.cells().size(); ++i) {
    const std::uint64_t at = place(section_.cells().j[i], section_.cells().k[i]);
    whole[at] = true;
    if (check_ && stopping_[i]) stops[at] = true;
    firsts.push_back(static_cast<std::int32_t>(section_.cells().first_pose[i]));
  }
  columns.push_back({"section.whole", packed(whole)});
  add_integers("section.first", firsts, columns);
  if (check_) {
    std::string bytes = packed(stops);
    for (std::size_t load = 0; loads_.size() > 1 && load < loads_.size(); ++load) {
      CellBits of_load(cells);
      for (std::size_t i = 0; i < section_.cells().size(); ++i) {
        if (!loads_[load].stopping[i]) continue;
        of_load[place(section_.cells().j[i], section_.cells().k[i])] = true;
      }
      bytes += packed(of_load);
    }
    columns.push_back({"section.stops", std::move(bytes)});
  }
  std::vector<const std::vector<SectionBand>*> rows;
  for (const SectionStretch& stretch : stretches_) rows.push_back(&stretch.bands);
  rows.push_back(&bands_);
  add_widths("left", &SectionBand::left, rows, lattice_.cell, columns);
  add_widths("right", &SectionBand::right, rows, lattice_.cell, columns);
  if (!has_cells_of_bins()) return;
  const auto bits_of_bins = [&](const SectionCells& of) {
    std::string bytes;
    std::size_t i = 0;
    for (const std::uint32_t bin : data.bins) {
      CellBits bits(cells);
      while (i < of.size() && of.bin[i] < bin) ++i;
      for (; i < of.size() && of.bin[i] == bin; ++i) bits[place(of.j[i], of.k[i])] = true;
      bytes += packed(bits);
    }
    return bytes;
  };
  columns.push_back({"section.cells", bits_of_bins(all)});
  if (not_known().size() > 0) columns.push_back({"section.unknown", bits_of_bins(not_known())});
}

}  // namespace clearway
