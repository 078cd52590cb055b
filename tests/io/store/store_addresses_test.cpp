#include "core/cloud/packed_cloud.hpp"
#include "io/store/store_writer.hpp"
#include "support/catch.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;

namespace {

PackedCell one_point() {
  PackedCell packed{.cell = {1, {{7, 8, 9}, {7, 8, 9}}}, .chunks = {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<std::int32_t> values(64, static_cast<std::int32_t>(7 + axis));
    append_packed_chunk<std::int32_t>(values, packed.chunks[axis]);
  }
  append_packed_chunk<std::uint64_t>(std::vector<std::uint64_t>(64, 0), packed.chunks[3]);
  const BlockBox block = encode_block_box(packed.cell.box, packed.cell.box);
  seal_cell(packed, std::span(&block, 1), 64);
  return packed;
}

}  // namespace

TEST_CASE("chunks are found whatever the length of the metadata before them") {
  const test::ScratchFolder scratch;
  const auto path = scratch.folder() / "s.h5";
  const std::uint64_t cells = GENERATE(1, 2, 300);
  for (std::size_t length = 0; length < 2200; length += 7) {
    StoreMetadata metadata{};
    metadata.point_count = metadata.input_points = cells;
    metadata.cell_points = 64;
    metadata.quantisation = {{1, 1, 1}, {0, 0, 0}};
    metadata.layout = "adaptive";
    metadata.crs_wkt.assign(length, 'x');
    StoreWriter writer(path, metadata, cells);
    for (std::uint64_t cell = 0; cell < cells; ++cell) writer.append(one_point());
    INFO(cells << " cells, " << length << " bytes");
    writer.finish({{0, static_cast<std::uint32_t>(cells), 0}});
    CHECK_NOTHROW(writer.confirm());
    std::filesystem::remove(path);
  }
}
