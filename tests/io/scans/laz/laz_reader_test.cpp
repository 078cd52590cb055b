// LAZ made by an encoder of the tests. Reading files of LASzip and laz-perf showed that the encoder
// writes what others do (docs/design/inputs.md).
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <random>

#include "io/files/thread_limit.hpp"
#include "io/scans/laz/items/gps_time11.hpp"
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

unsigned any_format() {
  return GENERATE(from_range(std::begin(kLazFormats), std::end(kLazFormats)));
}

/// Reads the file, the file again, and the bytes as a stream; each must give the points.
void check_reads(const LazBytes& laz) {
  CAPTURE(laz.las.format, laz.chunks, laz.variable, laz.chunked);
  const ScratchFolder scratch;
  const auto path = scratch.write("a.laz", laz.build());
  const auto reader = open_point_file(path);
  CHECK(reader->info().declared_points == laz.points.size());
  CHECK(*reader->info().quantisation == Quantisation{{0.001, 0.01, 0.1}, {100, -200, 0}});
  const auto check = [&](const ReadCloud& read) {
    CHECK(read.quanta == positions_of(laz.points));
    CHECK(read.classes == classes_of(laz));
    CHECK(read.flags == flags_of(laz));
  };
  check(read_all(*reader));
  reader->rewind();
  check(read_all(*reader));
  const auto stream = open_las_stream(File::open_for_reading(path), scratch.folder());
  CHECK(stream->can_rewind());
  check(read_all(*stream));
}

}  // namespace

TEST_CASE("LAZ holds the integers of its points, in every format and division into chunks") {
  const LazBytes laz = laz_bytes(any_format(), 3000);
  LazBytes other = laz;
  for (const std::uint32_t points : {1000u, 50000u, 701u}) {
    other.chunks = {points};
    check_reads(other);
  }
  for (const auto table : {LazBytes::Table::kAtEnd, LazBytes::Table::kNone}) {
    other.table = table;
    check_reads(other);
  }
  other = laz;
  other.variable = true;
  other.chunks = {1, 700, 2, 3, 1200, 1};
  check_reads(other);
  if (laz.las.format < 6) {
    other = laz;
    other.chunked = false;
    check_reads(other);
  }
  other = laz;
  other.chunks = {500};
  for (std::size_t i = 0; i < other.points.size(); ++i) {  // one class in each chunk
    other.points[i].classification = static_cast<std::uint8_t>(i / 500 + 1);
  }
  check_reads(other);
  for (const bool often : {true, false}) {  // flags that change often or once
    for (std::size_t i = 0; i < other.points.size(); ++i) {
      const std::size_t bits = often ? i * 7 / 3 % 16 : i < 1000 ? 4 : 2;
      other.points[i].flags = static_cast<std::uint8_t>(bits);
      other.points[i].classification = static_cast<std::uint8_t>(bits << 5 | 12);
    }
    check_reads(other);
  }
  other.points.resize(7);
  other.chunks = {1};
  check_reads(other);
  other.points.clear();
  check_reads(other);
}

TEST_CASE("GPS times of LAZ are those of its points, where they are asked for") {
  const unsigned format = any_format();
  const bool has_times = format != 0 && format != 2;
  std::vector<LazBytes> files(3, laz_bytes(format, 3000));
  files[0].chunks = {701};
  files[1] = files[0];
  files[1].table = LazBytes::Table::kNone;
  files[2].chunks = {1000};
  for (std::size_t i = 0; i < 3000; ++i) files[2].points[i].gps_time = i / 1000;
  files.push_back(laz_bytes(format, 300000));  // in a chunk that is too large to be kept
  files[3].chunks = {300000};
  for (const LazBytes& laz : files) {
    CAPTURE(format, laz.chunks);
    const ScratchFolder scratch;
    const auto path = scratch.write("a.laz", laz.build());
    const auto reader = open_point_file(path, {.with_times = true});
    CHECK((reader->info().gps_times == GpsTimes::kWeekSeconds) == has_times);
    PointBatch batch;
    std::vector<double> times, of_pieces;
    while (reader->read(batch)) times.insert(times.end(), batch.times.begin(), batch.times.end());
    for (std::size_t piece = 0; piece < reader->pieces(); ++piece) {
      reader->read_piece(piece, batch, nullptr);
      of_pieces.insert(of_pieces.end(), batch.times.begin(), batch.times.end());
    }
    REQUIRE(times.size() == (has_times ? laz.points.size() : 0));
    for (std::size_t i = 0; i < times.size(); ++i) {
      REQUIRE(std::bit_cast<std::uint64_t>(times[i]) == laz.points[i].gps_time);
    }
    if (reader->pieces() > 0) {
      CHECK((std::ranges::equal(times, of_pieces, {}, std::bit_cast<std::uint64_t, double>,
                                std::bit_cast<std::uint64_t, double>)));
    }
    const auto without = open_point_file(path);
    while (without->read(batch)) CHECK(batch.times.empty());
  }
}

TEST_CASE("chunks larger than a group's are read in pieces, by any number of threads") {
  const unsigned format = GENERATE(1u, 6u);
  const int threads = GENERATE(1, 3);
  LazBytes laz = laz_bytes(format, 300000);
  laz.variable = true;
  laz.chunks = {100, 270000, 50, 20000};
  const ThreadLimit limit(threads);
  tbb::task_arena(threads).execute([&] { check_reads(laz); });
}

TEST_CASE("batches of LAZ have at most the usual size, and no fewer points than that") {
  LazBytes laz = laz_bytes(0, 200000);
  laz.chunks = {300};
  ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.laz", laz.build()));
  PointBatch batch;
  std::vector<std::size_t> sizes;
  while (reader->read(batch)) sizes.push_back(batch.size());
  CHECK(sizes == std::vector<std::size_t>{65536, 65536, 65536, 3392});
}

TEST_CASE("a CRS before and behind compressed points is read") {
  const LasBytes::Record crs{"LASF_Projection", 2112, R"(LOCAL_CS["a",UNIT["foot",0.3048]])"};
  LazBytes before = laz_bytes(6, 20), behind = before;
  before.las.vlrs = {crs};
  behind.las.evlrs = {{"copc", 1000, "any"}, crs};
  for (const LazBytes& laz : {before, behind}) {
    const ScratchFolder scratch;
    const ReadCloud cloud = read_all(scratch.write("a.laz", laz.build()));
    CHECK(cloud.info.crs_wkt == crs.payload);
    CHECK(cloud.info.unit == LengthUnit::kFoot);
    CHECK(cloud.quanta == positions_of(laz.points));
  }
}

TEST_CASE("a file without a chunk table says so, one with it says nothing") {
  LazBytes laz = laz_bytes(0, 20);
  const ScratchFolder scratch;
  CHECK(read_all(scratch.write("a.laz", laz.build())).info.remarks.empty());
  laz.table = LazBytes::Table::kNone;
  const auto remarks = read_all(scratch.write("b.laz", laz.build())).info.remarks;
  REQUIRE(remarks.size() == 1);
  CHECK(remarks[0].severity == Message::Severity::kNote);
  check_says(remarks[0].text, "b.laz ... 20 points");
}

TEST_CASE("GPS times of version 1 are decoded as they were encoded") {
  ArithmeticEncoder out;
  SymbolCoder multiple(512), after_none(3);
  IntegerCoder coder(32, 6);
  std::uint64_t time = std::bit_cast<std::uint64_t>(1234.5);
  std::int32_t usual = 0;
  unsigned extremes = 0;
  const auto encode = [&](std::uint64_t next) {
    const auto step = static_cast<std::int64_t>(next - time);
    const bool near = step == static_cast<std::int32_t>(step);
    time = next;
    if (usual == 0 || step == 0 || !near) {
      const bool none = usual == 0;
      const unsigned symbol = step == 0 ? (none ? 0 : 511) : near ? 1 : (none ? 2 : 510);
      out.symbol(none ? after_none : multiple, symbol);
      if (step == 0) return;
      if (!near) {
        out.bits(32, static_cast<std::uint32_t>(next));
        return out.bits(32, static_cast<std::uint32_t>(next >> 32));
      }
      usual = static_cast<std::int32_t>(step);
      return coder.encode(out, 0, step, 0);
    }
    const auto factor = static_cast<unsigned>(std::clamp<std::int64_t>(step / usual, 0, 509));
    out.symbol(multiple, factor);
    const std::int64_t prediction =
        factor == 0 ? usual / 4 : static_cast<std::int32_t>(factor * static_cast<unsigned>(usual));
    const unsigned context = factor == 0   ? 2
                             : factor == 1 ? 1
                             : factor < 10 ? 3
                             : factor < 50 ? 4
                                           : 5;
    coder.encode(out, prediction, step, context);
    if (factor == 1) extremes = 0;
    const bool extreme = (factor == 0 || factor == 509) && ++extremes > 3;
    if (extreme) extremes = 0;
    if (extreme || factor == 1) usual = static_cast<std::int32_t>(step);
  };
  std::mt19937_64 random(5);
  std::vector<std::uint64_t> times;
  std::uint64_t next = time;
  for (int i = 0; i < 5000; ++i) {
    const unsigned kind = random() % 16;
    if (kind == 0) next += random();
    if (kind > 2) next += 100000 + random() % 50;
    if (kind > 9) next += 100000 * (random() % 700);
    if (kind > 13) next -= 500000;
    times.push_back(next);
    encode(next);
  }
  const std::string bytes = out.finish() + std::string(64, '\0');
  laz::GpsTimeVersion1 decoded;
  decoded.begin(1234.5);
  laz::ArithmeticDecoder decoder(reinterpret_cast<const std::byte*>(bytes.data()));
  for (const std::uint64_t expected : times) {
    decoder = decoded.next(decoder);
    REQUIRE(std::bit_cast<std::uint64_t>(decoded.time()) == expected);
  }
  CHECK_FALSE(decoder.damaged());
}
