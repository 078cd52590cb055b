#include "io/store/store_metadata.hpp"

#include <cmath>
#include <string>

#include "io/files/header_values.hpp"

namespace clearway {

static void keep_facts(HeaderValues& values, SourceFile& source) {
  values.add("name", source.name);
  values.add("bytes", source.bytes);
  values.add("xxh64", source.xxh64);
}

static void keep_facts(HeaderValues& values, StoreClasses& classes) {
  values.add("hash", classes.hash);
  values.add("points", classes.points);
}

static void keep_facts(HeaderValues& values, OriginBasis& basis) {
  values.add("what", basis.what);
  values.add("points", basis.points);
}

static void keep_facts(HeaderValues& values, StoreOrigins& origins) {
  values.add("hash", origins.hash);
  values.add("rest_on", origins.rest_on);
}

static void keep_facts(HeaderValues& values, StoreWithheld& withheld) {
  values.add("points", withheld.points);
  values.add("kept", withheld.kept);
}

void keep_facts(HeaderValues& values, StoreCorridor& near) {
  values.add("within", near.within);
  values.add("whole", near.whole);
  values.add("left_out", near.left_out);
  values.add("unread", near.unread);
  values.add("unread_bytes", near.unread_bytes);
  values.add("passed_over", near.passed_over);
}

namespace {

/// Takes counts away from `whole`. Returns what is left; none where they are more in all.
template <typename Counts, typename Of>
std::optional<std::uint64_t> left_of(std::uint64_t whole, const Counts& counts, Of of) {
  for (const auto& entry : counts) {
    const std::uint64_t count = std::invoke(of, entry);
    if (count > whole) return std::nullopt;
    whole -= count;
  }
  return whole;
}

void check_facts(const HeaderValues& values, StoreMetadata& m) {
  const auto require = [&](bool holds, const char* fact, const std::string& expected) {
    if (!holds) values.refuse_fact(fact, expected);
  };
  for (int k = 0; k < 3; ++k) {
    require(m.quantisation.scale[k] > 0, "scale", "numbers above 0");
    require(m.steps[static_cast<std::size_t>(k)] >= 0, "steps", "numbers of at least 0");
  }
  require(m.cell_points > 0 && m.cell_points <= kMostCellPoints, "cell_points",
          "1 to " + std::to_string(kMostCellPoints));
  require(m.input_points >= m.point_count, "input_points",
          "at least the points stored, " + std::to_string(m.point_count));
  const std::uint64_t not_stored = m.input_points - m.point_count;
  const std::string within = "at most the points not stored, " + std::to_string(not_stored);
  require(!m.withheld || m.withheld->left_out() <= not_stored, "withheld", within);
  require(!m.near || m.near->left_out <= not_stored, "near", within);
  require(!m.near || m.near->within >= 0, "near", "a distance of at least 0");
  require(m.source_points.empty() || (m.source_points.size() == m.sources.size() &&
                                      left_of(m.input_points, m.source_points, std::identity()) ==
                                          std::optional<std::uint64_t>(0)),
          "source_points",
          "counts of all sources that add up to input_points, " + std::to_string(m.input_points));
  const std::string points = std::to_string(m.point_count);
  require(!m.classes || (left_of(m.point_count, m.classes->points, std::identity()) ==
                             std::optional<std::uint64_t>(0) &&
                         m.classes->points[0] < m.point_count),
          "classes", "counts that add up to point_count, " + points + ", not all of class 0");
  if (!m.origins) return;
  const auto without = left_of(m.point_count, m.origins->rest_on, &OriginBasis::points);
  require(without.has_value(), "origins", "counts of at most point_count, " + points + ", in all");
  m.origins->points_without = *without;
}

}  // namespace

void keep_facts(HeaderValues& values, StoreMetadata& m) {
  values.add("point_count", m.point_count);
  values.add("input_points", m.input_points);
  values.add("cell_points", m.cell_points);
  values.add("points_hash", m.points_hash);
  values.add("scale", m.quantisation.scale);
  values.add("offset", m.quantisation.offset);
  values.add("steps", m.steps);
  values.add("layout", m.layout);
  values.add("options", m.options);
  std::string unit = to_string(m.unit);
  values.add("length_unit", unit);
  m.unit = length_unit_of(unit);
  values.add("crs_wkt", m.crs_wkt);
  values.add_if(m.height_unit != 0, "height_unit", m.height_unit);
  values.add("sources", m.sources);
  values.add_if(!m.source_points.empty(), "source_points", m.source_points);
  values.add("classes", m.classes);
  values.add("origins", m.origins);
  values.add("withheld", m.withheld);
  values.add("near", m.near);
  values.add_if(m.dates.known(), "dates", m.dates);
  values.add("warnings", m.warnings);
  if (values.reads()) check_facts(values, m);
}

}  // namespace clearway
