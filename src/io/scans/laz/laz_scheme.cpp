#include "io/scans/laz/laz_scheme.hpp"

#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"

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
constexpr ItemKind kKinds[] = {{"POINT10", 6, 20, 1, 2, 0, Scheme::kPoint},
                               {"GPSTIME11", 7, 8, 1, 2, 0, Scheme::kGpsTime},
                               {"RGB12", 8, 6, 1, 2, 0, Scheme::kRgb},
                               {"WAVEPACKET13", 9, 29, 1, 1, 0, Scheme::kWavePacket},
                               {"BYTE", 0, 0, 1, 2, 0, Scheme::kBytes},
                               {"POINT14", 10, 30, 2, 4, 9, Scheme::kPoint},
                               {"RGB14", 11, 6, 2, 4, 1, Scheme::kRgb},
                               {"RGBNIR14", 12, 8, 2, 4, 2, Scheme::kRgb},
                               {"WAVEPACKET14", 13, 29, 3, 4, 1, Scheme::kWavePacket},
                               {"BYTE14", 14, 0, 2, 4, kEveryByte, Scheme::kBytes}};

constexpr std::size_t kFixedBytes = 34;
constexpr std::size_t kItemBytes = 6;

template <typename... Args>
[[noreturn]] void refuse_scheme(const std::string& name, fmt::format_string<const Args&...> what,
                                const Args&... args) {
  refuse(name, "its LAZ record (laszip encoded) {}", fmt::format(what, args...));
}

const ItemKind& kind_of(const std::string& name, const DeclaredItem& item) {
  const std::string shown =
      fmt::format("item of type {}, {} bytes, version {}", item.type, item.bytes, item.version);
  for (const ItemKind& kind : kKinds) {
    if (kind.type != item.type) continue;
    if (item.bytes == 0 || (kind.bytes != 0 && kind.bytes != item.bytes) ||
        item.version < kind.least_version || item.version > kind.greatest_version) {
      refuse_scheme(name, "has an {}; expected {} of {} bytes, version {} to {}", shown, kind.name,
                    kind.bytes != 0 ? std::to_string(kind.bytes) : "1 or more", kind.least_version,
                    kind.greatest_version);
    }
    return kind;
  }
  refuse_scheme(name, "has an {}; expected a type of the LAZ specification, 0 or 6 to 14", shown);
}

void note_item(Scheme& scheme, const ItemKind& kind, const DeclaredItem& item) {
  scheme.versions[kind.place] = item.version;
  if (kind.place == Scheme::kBytes) scheme.bytes = static_cast<std::uint16_t>(item.bytes);
  scheme.layers += kind.layers == kEveryByte ? item.bytes : kind.layers;
}

void read_items(const std::string& name, std::span<const std::byte> items, unsigned point_format,
                std::uint16_t record_bytes, Scheme& scheme) {
  const bool layered = scheme.chunks == Scheme::Chunks::kLayered;
  unsigned bytes = 0;
  unsigned next_place = Scheme::kPoint;
  for (std::size_t at = 0; at < items.size(); at += kItemBytes) {
    const std::byte* fields = items.data() + at;
    const DeclaredItem item{load<std::uint16_t>(fields), load<std::uint16_t>(fields + 2),
                            load<std::uint16_t>(fields + 4)};
    const ItemKind& kind = kind_of(name, item);
    if ((kind.layers != 0) != layered || kind.place < next_place ||
        (next_place == Scheme::kPoint && kind.place != Scheme::kPoint)) {
      refuse_scheme(
          name, "has the item {} as number {}, expected the items of a point format in their order",
          kind.name, at / kItemBytes + 1);
    }
    next_place = kind.place + 1;
    note_item(scheme, kind, item);
    bytes += item.bytes;
  }
  if (bytes != record_bytes || layered != (point_format >= 6)) {
    refuse_scheme(name, "has items of {} bytes{}; expected those of point format {} with {} bytes",
                  bytes, layered ? " in layers" : "", point_format, record_bytes);
  }
  scheme.record_bytes = record_bytes;
}

}  // namespace

Scheme read_scheme(const std::string& name, std::span<const std::byte> payload,
                   unsigned point_format, std::uint16_t record_bytes) {
  if (payload.size() < kFixedBytes + kItemBytes) {
    refuse_scheme(name, "has {} bytes; expected at least {}", payload.size(),
                  kFixedBytes + kItemBytes);
  }
  const unsigned compressor = load<std::uint16_t>(payload.data());
  const unsigned coder = load<std::uint16_t>(payload.data() + 2);
  if (compressor < 1 || compressor > 3) {
    refuse_scheme(name, "names compressor {}; expected 1 to 3", compressor);
  }
  if (coder != 0) {
    refuse_scheme(name, "names coder {}; expected 0, arithmetic", coder);
  }
  Scheme scheme;
  scheme.chunks = static_cast<Scheme::Chunks>(compressor - 1);
  const auto points = load<std::uint32_t>(payload.data() + 12);
  if (points != 0 && points != 0xFFFFFFFF) scheme.chunk_points = points;
  const std::size_t items = load<std::uint16_t>(payload.data() + 32);
  if (items == 0 || payload.size() != kFixedBytes + items * kItemBytes) {
    refuse_scheme(name, "has {} bytes for {} items; expected {} bytes, and at least one item",
                  payload.size(), items, kFixedBytes + items * kItemBytes);
  }
  read_items(name, payload.subspan(kFixedBytes), point_format, record_bytes, scheme);
  return scheme;
}

}  // namespace clearway::laz
