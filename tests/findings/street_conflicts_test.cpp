// Groups of a real scan's colliding points, against all pairs, as scanned and moved far away.
#include "clearway/clearway.hpp"
#include "findings/conflict_fixture.hpp"
#include "io/scans/requantize.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::filesystem::path street(const std::string& name) { return data_folder() / "street" / name; }

/// The colliding points, at the radius, in a part of the street.
Found crop(const Store& store, double radius, const ScratchFolder& folder, const Box& part) {
  const Query query(read_model_points(street("beetle.ply")),
                    read_trajectory(street("trajectory.txt")),
                    {.radius = radius, .first_pose = true});
  search(store, query, folder / "out.h5", {.threads = 2, .overwrite = true});
  const Result result(folder / "out.h5");
  Found out;
  out.quantisation = result.reader().header().quantisation;
  for (const Vec3& p : result.xyz()) {
    if (p.x < part.lo.x || p.x > part.hi.x || p.y < part.lo.y || p.y > part.hi.y) continue;
    std::array<std::int32_t, 3> q{};
    for (int k = 0; k < 3; ++k) {
      q[static_cast<std::size_t>(k)] = quantum_at(out.quantisation, k, p[k]).value();
    }
    out.quanta.push_back(q);
  }
  return out;
}

}  // namespace

TEST_CASE("groups of the street are those of all pairs") {
  const ScratchFolder folder;
  convert({street("street.las")}, folder / "street.h5", {.threads = 2});
  const Store store(folder / "street.h5");
  for (const auto& [radius, part] : {std::pair(0.1, Box{{20, 0, 0}, {22.5, 30, 0}}),
                                     std::pair(0.5, Box{{20, 0, 0}, {21, 30, 0}})}) {
    Found found = crop(store, radius, folder, part);
    REQUIRE(found.quanta.size() > 2000);
    REQUIRE(found.quanta.size() < 9000);
    for (const Vec3& offset : {Vec3{0, 0, 0}, Vec3{500'000, 4'000'000, 100}}) {
      for (int k = 0; k < 3; ++k) found.quantisation.offset[k] = offset[k];
      for (const double gap : {0.1, 0.3, 1.0}) check_groups(found, gap);
    }
  }
}
