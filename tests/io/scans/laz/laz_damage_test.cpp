// LAZ has no checksums, so a flipped byte may give other points; but reading ends, with as many
// points as declared or with a refusal that names the file.
#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Outcomes {
  int refused = 0, same = 0, other = 0;
};

Outcomes flip_every_byte(const LazBytes& laz) {
  const std::string sound = laz.build();
  const auto expected = positions_of(laz.points);
  ScratchFolder scratch;
  Outcomes outcomes;
  for (std::size_t at = 0; at < sound.size(); ++at) {
    std::string bytes = sound;
    bytes[at] = static_cast<char>(bytes[at] ^ (at % 3 == 0 ? 0xFF : 1 << at % 8));
    const auto path = scratch.write("a.laz", bytes);
    try {
      const ReadCloud cloud = read_all(path);
      if (cloud.size() != cloud.info.declared_points) FAIL("another count after byte " << at);
      ++(cloud.quanta == expected ? outcomes.same : outcomes.other);
    } catch (const InputError& error) {
      if (std::string(error.what()).find(path.string()) == std::string::npos) FAIL(error.what());
      ++outcomes.refused;
    }
  }
  return outcomes;
}

}  // namespace

TEST_CASE("every byte of a LAZ file flipped: refused, or as many points as declared") {
  const unsigned format = GENERATE(from_range(std::begin(kLazFormats), std::end(kLazFormats)));
  CAPTURE(format);
  LazBytes laz = laz_bytes(format, 40);
  laz.chunks = {25};
  if (format == 1 || format == 7) laz.table = LazBytes::Table::kAtEnd;
  if (format == 2 || format == 8) laz.table = LazBytes::Table::kNone;
  if (format == 3 || format == 6) {
    laz.variable = true;
    laz.chunks = {10, 1, 29};
  }
  const Outcomes outcomes = flip_every_byte(laz);
  CHECK(outcomes.refused > 0);
  CHECK(outcomes.same > 0);
}

TEST_CASE("a LAZ file cut at any byte is refused, or has all its points") {
  const unsigned format = GENERATE(from_range(std::begin(kLazFormats), std::end(kLazFormats)));
  LazBytes laz = laz_bytes(format, 30);
  // Some bytes may be missing at the end only where no place of a table stands before the points.
  std::size_t spare = 0;
  const std::size_t whole = laz.build().size();
  SECTION("a table") {}
  SECTION("records behind the points") {
    if (format < 6) return;
    laz.las.evlrs = {{"someone", 1, "payload"}};
  }
  SECTION("the place of the table at the end") {
    laz.table = LazBytes::Table::kAtEnd;
    spare = laz.build().size() - whole + 30;
  }
  const std::string bytes = laz.build();
  ScratchFolder scratch;
  const auto expected = positions_of(laz.points);
  for (std::size_t size = bytes.size(); size-- > 0;) {
    const auto path = scratch.write("a.laz", std::string_view(bytes).substr(0, size));
    const std::string message = refusal_of(path);
    if (message.empty()) {
      CHECK(size + spare >= bytes.size());
      CHECK(read_all(path).quanta == expected);
    } else if (message.find(path.string()) == std::string::npos) {
      FAIL(message);
    }
  }
}
