// A store that is read by calls, cell by cell, without its map.
#include <unistd.h>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct SmallStore {
  SmallStore() {
    write_las(folder / "a.las", cube_cloud(3000, -40'000, 40'000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, path, 100));
  }
  void flip(std::uint64_t at) const {
    std::string bytes = bytes_of(path);
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    put_bytes(path, bytes);
  }
  ScratchFolder folder;
  std::filesystem::path path = folder / "a.h5";
};

std::vector<std::byte> read(const StoreReader& store, std::uint32_t cell) {
  std::vector<std::byte> bytes(store.packed_bytes(cell));
  store.read_packed(cell, bytes);
  return bytes;
}

}  // namespace

TEST_CASE("cells read from the file are those of the map, and count as touched once") {
  const SmallStore small;
  const StoreReader store(small.path), mapped(small.path);
  check_equal(store.cells_touched(), 0);
  std::uint64_t wrong = 0;
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    std::vector<std::byte> bytes(store.packed_bytes(cell));
    const auto chunks = store.read_packed(cell, bytes);
    const auto expected = mapped.coordinates(cell);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::uint32_t i = 0; i < store.cell_points(); ++i) {
        wrong += chunks[axis][i] != expected[axis][i];
      }
    }
  }
  check_equal(wrong, 0);
  const std::uint64_t once = mapped.bytes_read().coordinates;
  CHECK(store.bytes_read().coordinates == once);
  read(store, 3);
  store.coordinates(3);
  CHECK(store.cells_touched() == store.cells().size());
  CHECK(store.bytes_read().coordinates == once + 2 * store.packed_bytes(3));
}

TEST_CASE("a flipped bit in any of the three chunks is found and named") {
  for (const std::size_t axis : {0, 1, 2}) {
    for (const std::uint64_t byte : {0, 4, 12, 30}) {
      const SmallStore small;
      std::uint64_t at = 0;
      {
        const StoreReader store(small.path);
        at = store.chunks().of(axis, 5).address + byte;
      }
      small.flip(at);
      const StoreReader store(small.path);
      CHECK_NOTHROW(read(store, 4));
      check_refused([&] { return read(store, 5); }, "a.h5 ... cell 5 ... at byte ... damaged");
      check_equal(store.cells_touched(), 1);
    }
  }
}

TEST_CASE("a store that was cut short while open is refused with the byte where it ends") {
  const SmallStore small;
  const StoreReader store(small.path);
  const auto cell = static_cast<std::uint32_t>(store.cells().size() - 1);
  const std::uint64_t end = store.chunks().of(kY, cell).address + 3;
  REQUIRE(::truncate(small.path.c_str(), static_cast<off_t>(end)) == 0);
  check_refused([&] { return read(store, cell); },
                std::string("a.h5 ... ends at byte ") + std::to_string(end));
}
