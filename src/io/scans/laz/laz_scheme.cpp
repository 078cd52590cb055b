#include "io/scans/laz/laz_scheme.hpp"

#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"

namespace clearway::laz {
namespace {

struct DeclaredItem {
  unsigned type, bytes, version;
};

/// An item type: its size (0: any), the versions that are read, the layers of a chunk (0: not
/// layered; kEveryByte: one for each byte), and its place in the order of a record.
struct ItemKind {
  const char* name;
  unsigned type, bytes;
  unsigned least_version, greatest_version;
  unsigned layers;
  unsigned place;
};

constexpr unsigned kEveryByte = ~0u;
constexpr unsigned kPointPlace = 0, kGpsPlace = 1, kRgbPlace = 2, kWavePlace = 3, kBytesPlace = 4;
constexpr ItemKind kKinds[] = {{"POINT10", 6, 20, 1, 2, 0, kPointPlace},
                               {"GPSTIME11", 7, 8, 1, 2, 0, kGpsPlace},
                               {"RGB12", 8, 6, 1, 2, 0, kRgbPlace},
                               {"WAVEPACKET13", 9, 29, 1, 1, 0, kWavePlace},
                               {"BYTE", 0, 0, 1, 2, 0, kBytesPlace},
                               {"POINT14", 10, 30, 2, 4, 9, kPointPlace},
                               {"RGB14", 11, 6, 2, 4, 1, kRgbPlace},
                               {"RGBNIR14", 12, 8, 2, 4, 2, kRgbPlace},
                               {"WAVEPACKET14", 13, 29, 3, 4, 1, kWavePlace},
                               {"BYTE14", 14, 0, 2, 4, kEveryByte, kBytesPlace}};

constexpr std::size_t kFixedBytes = 34;
constexpr std::size_t kItemBytes = 6;

[[noreturn]] void refuse_scheme(const std::string& name, const std::string& what) {
  refuse(name, "its LAZ record (laszip encoded) " + what);
}

const ItemKind& kind_of(const std::string& name, const DeclaredItem& item) {
  const std::string shown = "item of type " + std::to_string(item.type) + ", " +
                            std::to_string(item.bytes) + " bytes, version " +
                            std::to_string(item.version);
  for (const ItemKind& kind : kKinds) {
    if (kind.type != item.type) continue;
    if (item.bytes == 0 || (kind.bytes != 0 && kind.bytes != item.bytes) ||
        item.version < kind.least_version || item.version > kind.greatest_version) {
      refuse_scheme(name, "has an " + shown + "; expected " + kind.name + " of " +
                              (kind.bytes != 0 ? std::to_string(kind.bytes) : "1 or more") +
                              " bytes, version " + std::to_string(kind.least_version) + " to " +
                              std::to_string(kind.greatest_version));
    }
    return kind;
  }
  refuse_scheme(name,
                "has an " + shown + "; expected a type of the LAZ specification, 0 or 6 to 14");
}

void note_item(Scheme& scheme, const ItemKind& kind, const DeclaredItem& item) {
  unsigned* const versions[] = {&scheme.point_version, &scheme.gps_time_version,
                                &scheme.rgb_version, &scheme.wave_packet_version,
                                &scheme.bytes_version};
  *versions[kind.place] = item.version;
  if (kind.place == kBytesPlace) scheme.bytes = static_cast<std::uint16_t>(item.bytes);
  scheme.layers += kind.layers == kEveryByte ? item.bytes : kind.layers;
}

void read_items(const std::string& name, std::span<const std::byte> items, unsigned point_format,
                std::uint16_t record_bytes, Scheme& scheme) {
  const bool layered = scheme.chunks == Scheme::Chunks::kLayered;
  unsigned bytes = 0;
  unsigned next_place = kPointPlace;
  for (std::size_t at = 0; at < items.size(); at += kItemBytes) {
    const std::byte* fields = items.data() + at;
    const DeclaredItem item{load<std::uint16_t>(fields), load<std::uint16_t>(fields + 2),
                            load<std::uint16_t>(fields + 4)};
    const ItemKind& kind = kind_of(name, item);
    if ((kind.layers != 0) != layered || kind.place < next_place ||
        (next_place == kPointPlace && kind.place != kPointPlace)) {
      refuse_scheme(name, std::string("has the item ") + kind.name + " as number " +
                              std::to_string(at / kItemBytes + 1) +
                              ", expected the items of a point format in their order");
    }
    next_place = kind.place + 1;
    note_item(scheme, kind, item);
    bytes += item.bytes;
  }
  if (bytes != record_bytes || layered != (point_format >= 6)) {
    refuse_scheme(name, "has items of " + std::to_string(bytes) + " bytes" +
                            (layered ? " in layers" : "") + "; expected those of point format " +
                            std::to_string(point_format) + " with " + std::to_string(record_bytes) +
                            " bytes");
  }
  scheme.record_bytes = record_bytes;
}

}  // namespace

Scheme read_scheme(const std::string& name, std::span<const std::byte> payload,
                   unsigned point_format, std::uint16_t record_bytes) {
  if (payload.size() < kFixedBytes + kItemBytes) {
    refuse_scheme(name, "has " + std::to_string(payload.size()) + " bytes; expected at least " +
                            std::to_string(kFixedBytes + kItemBytes));
  }
  const unsigned compressor = load<std::uint16_t>(payload.data());
  const unsigned coder = load<std::uint16_t>(payload.data() + 2);
  if (compressor < 1 || compressor > 3) {
    refuse_scheme(name, "names compressor " + std::to_string(compressor) + "; expected 1 to 3");
  }
  if (coder != 0) {
    refuse_scheme(name, "names coder " + std::to_string(coder) + "; expected 0, arithmetic");
  }
  Scheme scheme;
  scheme.chunks = static_cast<Scheme::Chunks>(compressor - 1);
  const auto points = load<std::uint32_t>(payload.data() + 12);
  if (points != 0 && points != 0xFFFFFFFF) scheme.chunk_points = points;
  const std::size_t items = load<std::uint16_t>(payload.data() + 32);
  if (items == 0 || payload.size() != kFixedBytes + items * kItemBytes) {
    refuse_scheme(name, "has " + std::to_string(payload.size()) + " bytes for " +
                            std::to_string(items) + " items; expected " +
                            std::to_string(kFixedBytes + items * kItemBytes) +
                            " bytes, and at least one item");
  }
  read_items(name, payload.subspan(kFixedBytes), point_format, record_bytes, scheme);
  return scheme;
}

}  // namespace clearway::laz
