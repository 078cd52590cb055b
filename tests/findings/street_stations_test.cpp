// The station table of a real street, against its definition.
#include "findings/station_oracle.hpp"
#include "support/store_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the station table of the street is that of its clearances and contacts") {
  const auto street = data_folder() / "street";
  const ScratchFolder folder;
  convert({street / "street.las"}, folder / "street.h5", {.threads = 2});
  Query query(read_model_points(street / "beetle.ply"), read_trajectory(street / "trajectory.txt"),
              {.radius = 0.1, .first_pose = true, .clearance = 0.5});
  // The lower part stands on the ground, so that nothing would be clear.
  std::erase_if(query.model.vertices, [](const Vec3& p) { return p.z < -1; });
  search(Store(folder / "street.h5"), query, folder / "out.h5", {.threads = 2});
  const Result result(folder / "out.h5");
  const auto first = result.first_pose(), last = result.last_pose();
  REQUIRE(first.size() > 100);
  for (const double every : {0.5, 5.0, 50.0}) {
    CAPTURE(every);
    StationOptions options;
    options.every = every;
    const StationTable table = station_table(result, query.poses, options);
    check_distances(table, expected_rows(result, query, every), query.radius);
    const std::vector<std::size_t> row_of = rows_of(query.poses, every);
    std::vector<bool> at_ends(table.rows.size()), between(table.rows.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      at_ends[row_of[first[i]]] = at_ends[row_of[last[i]]] = true;
      for (std::size_t row = row_of[first[i]]; row <= row_of[last[i]]; ++row) between[row] = true;
    }
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const Verdict verdict = table.rows[row].verdict;
      if (at_ends[row]) CHECK(verdict == Verdict::kConflict);
      if (!between[row]) CHECK(verdict != Verdict::kConflict);
    }
  }
}
