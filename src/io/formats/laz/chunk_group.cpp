#include "io/formats/laz/chunk_group.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <optional>

#include "core/util/tsan_annotations.hpp"
#include "io/system/input_error.hpp"

namespace clearway::laz {
namespace {

constexpr std::uint64_t kMostPointsOfChunk = 1 << 18;  // 3 MiB
constexpr std::uint64_t kPointsPerThread = 1 << 17;    // two chunks of the usual size
constexpr std::uint16_t kMostRecordBytes = 1 << 10;    // a decoder takes 1.6 KB for each extra byte

std::uint64_t threads() {
  return static_cast<std::uint64_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
}

}  // namespace

ChunkGroups::ChunkGroups(const Scheme& scheme)
    : one_at_a_time_(scheme.record_bytes > kMostRecordBytes),
      decoders_([scheme] { return make_chunk_decoder(scheme); }) {}

bool ChunkGroups::takes(const Chunk& chunk) const {
  return !one_at_a_time_ && chunk.points <= kMostPointsOfChunk;
}

void ChunkGroups::decode_alone(const InputBuffer& input, const Chunk& chunk, PointRoom points) {
  ChunkDecoder& decoder = *decoders_.local();
  decoder.begin(input, chunk);
  decoder.decode(points);
  decoder.finish();
}

std::size_t ChunkGroups::decode(const InputBuffer& input, std::span<const Chunk> chunks,
                                std::size_t first, std::size_t count) {
  const std::uint64_t most = threads() * kPointsPerThread;
  std::vector<std::uint64_t> begins{0};
  for (const Chunk& chunk : chunks) {
    if (!takes(chunk) || (begins.size() > 1 && begins.back() + chunk.points > most)) break;
    begins.push_back(begins.back() + chunk.points);
  }
  const std::size_t taken = begins.size() - 1;
  points_.resize(begins.back());
  classes_.resize(begins.back());
  std::vector<std::optional<DamagedChunk>> damages(taken);
  const auto decode_one = [&](std::size_t i) {
    try {
      decode_alone(
          input, chunks[i],
          PointRoom{points_.data(), classes_.data(), points_.size()}.behind(begins[i]).first(
              chunks[i].points));
    } catch (const DamagedChunk& damage) {
      damages[i] = damage;
    }
  };
  // Reading happens in a stage of a pipeline, so a thread that waits here must not begin another
  // stage.
  tbb::this_task_arena::isolate([&] {
    const ParallelScope scope;
    const auto piece = piece_of(scope, decode_one);
    scope.begin();
    tbb::parallel_for(std::size_t{0}, taken, piece);
  });
  for (std::size_t i = 0; i < taken; ++i) {
    if (damages[i]) refuse_chunk(input.name(), first + i, count, *damages[i]);
  }
  return taken;
}

void refuse_chunk(const std::string& name, std::uint64_t index, std::uint64_t count,
                  const DamagedChunk& damage) {
  refuse(name, "chunk " + std::to_string(index + 1) +
                   (count > 0 ? " of " + std::to_string(count) : std::string()) + ": " +
                   damage.what +
                   "; expected compressed points as a LAZ writer leaves them. The file was cut or "
                   "damaged: copy it again");
}

}  // namespace clearway::laz
