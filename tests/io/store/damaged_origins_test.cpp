// Stores with origins, damaged byte by byte.
#include <catch2/catch.hpp>

#include "support/clouds.hpp"
#include "support/leaks_of_hdf5.hpp"
#include "support/origins.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("damaged origins are refused, by who asks for them and by verify") {
  const ScratchFolder folder;
  const auto points = cube_cloud(300, -4000, 4000, 3);
  write_las(folder / "a.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
  put_bytes(folder / "o.csv", "first,x,y,z\n0,1,2,3\n100,4,5,6\n200,-1,0,9\n");
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  options.origins = folder / "o.csv";
  convert_quietly(options);
  const StoreReader sound(folder / "a.h5");
  const auto expected = origins_by_source(sound);
  const std::string bytes = bytes_of(folder / "a.h5");
  const LeaksOfHdf5 of_damaged_files;
  std::uint64_t unseen = 0, refused = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    put_bytes(folder / "b.h5", changed);
    try {
      const StoreReader store(folder / "b.h5");
      if (!faults_of(store).empty()) {
        ++refused;
        continue;
      }
      // A change that is not noticed must not change what is read.
      unseen += !store.has_origins() || origins_by_source(store) != expected ||
                store.metadata().origins != sound.metadata().origins;
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(unseen == 0);
  CHECK(refused > 0);
}
