#include "io/scans/laz/copc_hierarchy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway::laz {
namespace {

constexpr std::size_t kInfoBytes = 160, kEntryBytes = 32;
constexpr std::int32_t kPage = -1;  ///< in place of a number of points
/// The deepest level at which coordinates of nodes still fit their 32 bits.
constexpr std::int32_t kDeepest = 31;

/// The cube that the octree divides.
struct Root {
  double centre[3], half;

  explicit Root(std::span<const std::byte> info) {
    for (int k = 0; k < 3; ++k) centre[k] = load<double>(info.data() + 8 * k);
    half = load<double>(info.data() + 24);
  }

  bool is_sound() const {
    return std::isfinite(centre[0]) && std::isfinite(centre[1]) && std::isfinite(centre[2]) &&
           std::isfinite(half) && half > 0;
  }

  Box cube(std::int32_t level, const std::int32_t* key) const {
    const double side = std::ldexp(2 * half, -level);
    Box box;
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = centre[k] - half + key[k] * side;
      box.hi[k] = centre[k] - half + (key[k] + 1.0) * side;
    }
    return box;
  }
};

/// A page of the hierarchy: a run of entries.
struct Page {
  std::uint64_t begin, bytes;
};

[[noreturn]] void refuse_hierarchy(const InputBuffer& input, const std::string& what) {
  refuse(input.name(), "its COPC hierarchy is damaged: " + what);
}

}  // namespace

std::vector<Box> read_copc_cubes(const InputBuffer& input, std::span<const std::byte> info,
                                 std::span<const Chunk> chunks) {
  if (info.size() < kInfoBytes) {
    refuse_hierarchy(input, fmt::format("its record has {} bytes, expected 160", info.size()));
  }
  const Root root(info);
  if (!root.is_sound()) refuse_hierarchy(input, "expected a cube of finite size above 0");
  std::unordered_map<std::uint64_t, std::size_t> chunk_at;
  for (std::size_t i = 0; i < chunks.size(); ++i) chunk_at.emplace(chunks[i].begin, i);
  std::vector<Box> cubes(chunks.size());
  std::vector<bool> named(chunks.size());
  std::size_t left = chunks.size();
  // Every page names a node of its own at least, so damage cannot make them more than this.
  std::size_t most_pages = 2 * chunks.size() + 16;
  std::vector<Page> pages{
      {load<std::uint64_t>(info.data() + 40), load<std::uint64_t>(info.data() + 48)}};
  while (!pages.empty()) {
    const Page page = pages.back();
    pages.pop_back();
    const std::uint64_t size = *input.size();
    if (most_pages-- == 0 || page.bytes % kEntryBytes != 0 || page.begin > size ||
        page.bytes > size - page.begin) {
      refuse_hierarchy(input, fmt::format("a page of {} bytes at byte {}", page.bytes, page.begin));
    }
    for (std::uint64_t at = 0; at < page.bytes; at += kEntryBytes) {
      std::array<std::byte, kEntryBytes> entry;
      input.read_at(page.begin + at, entry);
      std::int32_t key[4];
      for (int k = 0; k < 4; ++k) key[k] = load<std::int32_t>(entry.data() + 4 * k);
      const auto offset = load<std::uint64_t>(entry.data() + 16);
      const auto bytes = load<std::int32_t>(entry.data() + 24);
      const auto points = load<std::int32_t>(entry.data() + 28);
      if (points == kPage && bytes > 0) {
        pages.push_back({offset, static_cast<std::uint64_t>(bytes)});
        continue;
      }
      if (points == 0) continue;
      const auto chunk = chunk_at.find(offset);
      const auto is_outside = [&](std::int32_t index) {
        return index < 0 || std::int64_t{index} >> key[0] > 0;
      };
      if (key[0] < 0 || key[0] > kDeepest || std::any_of(key + 1, key + 4, is_outside) ||
          points < 0 || chunk == chunk_at.end() || named[chunk->second] ||
          chunks[chunk->second].points != static_cast<std::uint64_t>(points)) {
        refuse_hierarchy(input, "an entry at byte " + std::to_string(page.begin + at) +
                                    " that is not of one of its chunks");
      }
      cubes[chunk->second] = root.cube(key[0], key + 1);
      named[chunk->second] = true;
      --left;
    }
  }
  if (left > 0) refuse_hierarchy(input, std::to_string(left) + " of its chunks have no entry");
  return cubes;
}

}  // namespace clearway::laz
