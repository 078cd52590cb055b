// Stores with classes, damaged byte by byte.
#include <catch2/catch.hpp>

#include "support/classed_scans.hpp"
#include "support/leaks_of_hdf5.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("damaged classes are refused, by who asks for them and by verify") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  write_classed(folder / "a.las", points, random_classes(points.size(), 9));
  convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
  const std::string bytes = bytes_of(folder / "a.h5");
  const LeaksOfHdf5 of_damaged_files;
  std::uint64_t unseen = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    put_bytes(folder / "b.h5", changed);
    try {
      const StoreReader store(folder / "b.h5");
      if (!faults_of(store).empty()) continue;
      // A change that is not noticed must not change what is read.
      unseen += !store.has_classes() ||
                classes_by_source(store) != classes_by_source(StoreReader(folder / "a.h5"));
    } catch (const InputError&) {
    }
  }
  CHECK(unseen == 0);
}
