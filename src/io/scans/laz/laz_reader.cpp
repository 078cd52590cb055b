#include "io/scans/laz/laz_reader.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/bytes.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/laz/chunk_table.hpp"
#include "io/scans/laz/copc_hierarchy.hpp"

namespace clearway {
namespace {

using laz::Chunk;
using laz::Scheme;

/// Reads the chunks of a file. Where it has a chunk table, several of them are decoded at once, and
/// it has pieces. Otherwise the place of a chunk is known only once the one before was decoded.
class LazReader final : public PointReader {
 public:
  /// chunks: nullopt where there is no table. cubes: that of each chunk, where the file is COPC;
  /// otherwise empty.
  LazReader(InputBuffer input, const Scheme& scheme, const laz::PointBytes& bytes,
            std::optional<std::vector<Chunk>> chunks, std::vector<Box> cubes, CloudInfo info)
      : input_(std::move(input)),
        scheme_(scheme),
        bytes_(bytes),
        has_table_(chunks.has_value()),
        chunks_(std::move(chunks).value_or(std::vector<Chunk>{})),
        cubes_(std::move(cubes)),
        info_(std::move(info)),
        decoders_([scheme] { return laz::make_chunk_decoder(scheme); }) {
    find_pieces();
    rewind();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.clear();
    while (batch.size() < kBatchPoints) {
      if (taken_ < ready_.size()) {
        const std::size_t count = std::min(ready_.size() - taken_, kBatchPoints - batch.size());
        append(ready_, taken_, count, batch);
        taken_ += count;
      } else if (left_ == 0 && next_ < chunks_.size() && is_small(chunks_[next_])) {
        decode_group();
      } else if (!decode_some(batch)) {
        break;
      }
    }
    return batch.size() > 0;
  }

  void rewind() override {
    position_ = bytes_.begin + (scheme_.chunks == Scheme::Chunks::kNone ? 0 : kPointerBytes);
    next_ = begun_ = left_ = 0;
    ready_.clear();
    taken_ = 0;
  }

  std::size_t pieces() const override { return piece_ends_.size(); }

  std::uint64_t points_of_piece(std::size_t piece) const override {
    return points_of(chunks_of(piece));
  }

  void read_piece(std::size_t piece, PointBatch& batch, PieceBytes* bytes) override {
    batch.clear();
    decode(chunks_of(piece), batch);
    if (!bytes) return;
    *bytes = place_of_piece(piece);
    bytes->bytes = std::make_unique_for_overwrite<std::byte[]>(bytes->count);
    input_.read_at(bytes->first, bytes->span());
  }

  std::optional<Box> bounds_of_piece(std::size_t piece) const override {
    if (cubes_.empty()) return std::nullopt;
    return cubes_[piece];  // a piece is one chunk
  }

  PieceBytes place_of_piece(std::size_t piece) const override {
    const std::span<const Chunk> chunks = chunks_of(piece);
    return {chunks.front().begin, chunks.back().end - chunks.front().begin, nullptr};
  }

 private:
  static constexpr std::uint64_t kPointerBytes = 8;
  static constexpr std::uint64_t kMostPointsOfChunk = 1 << 18;  // 3 MiB
  static constexpr std::uint64_t kPointsPerThread = 1 << 17;    // two chunks of the usual size
  static constexpr std::uint64_t kMostChunkBytes = std::uint64_t{4} << 20;
  /// A decoder takes 1.6 KB for each extra byte.
  static constexpr std::uint16_t kMostRecordBytes = 1 << 10;

  /// Whether a chunk has few enough points to be decoded beside others, and so to be kept in memory
  /// as a whole.
  bool is_small(const Chunk& chunk) const {
    return scheme_.record_bytes <= kMostRecordBytes && chunk.points <= kMostPointsOfChunk;
  }

  /// Forms pieces of several chunks each, and of one each where it has a cube; none where a chunk
  /// is too large to be decoded as a whole.
  void find_pieces() {
    std::uint64_t points = 0, bytes = 0;
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
      const std::uint64_t size = chunks_[i].end - chunks_[i].begin;
      if (!is_small(chunks_[i]) || size > kMostChunkBytes) {
        piece_ends_.clear();
        return;
      }
      points += chunks_[i].points;
      bytes += size;
      const bool full = points >= kBatchPoints / 2 || bytes >= kMostChunkBytes / 4;
      if (cubes_.empty() && !full && i + 1 < chunks_.size()) continue;
      piece_ends_.push_back(i + 1);
      points = bytes = 0;
    }
  }

  std::span<const Chunk> chunks_of(std::size_t piece) const {
    const std::size_t first = piece == 0 ? 0 : piece_ends_[piece - 1];
    return std::span(chunks_).subspan(first, piece_ends_[piece] - first);
  }

  static std::uint64_t points_of(std::span<const Chunk> chunks) {
    std::uint64_t points = 0;
    for (const Chunk& chunk : chunks) points += chunk.points;
    return points;
  }

  /// Makes room behind the points of the batch, as the scheme asks for it.
  laz::PointRoom add_room(PointBatch& batch, std::size_t count) const {
    const std::size_t first = batch.quanta.size(), end = first + count;
    batch.quanta.resize(end);
    batch.classes.resize(end);
    if (scheme_.with_flags) batch.flags.resize(end);
    if (scheme_.with_times) batch.times.resize(end);
    return {batch.quanta.data() + first, batch.classes.data() + first,
            scheme_.with_flags ? batch.flags.data() + first : nullptr,
            scheme_.with_times ? batch.times.data() + first : nullptr, count};
  }

  /// Appends `count` points of a batch from number `first` on.
  static void append(const PointBatch& from, std::size_t first, std::size_t count,
                     PointBatch& out) {
    const auto add = [&](const auto& values, auto& to) {
      if (values.empty()) return;
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
      to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    };
    add(from.quanta, out.quanta);
    add(from.classes, out.classes);
    add(from.flags, out.flags);
    add(from.times, out.times);
  }

  /// Decodes chunks of the table at the same time, on the threads of the caller's oneTBB arena, and
  /// appends their points. Throws InputError for the first chunk that is damaged.
  void decode(std::span<const Chunk> chunks, PointBatch& out) {
    std::vector<laz::PointRoom> rooms{add_room(out, points_of(chunks))};
    for (const Chunk& chunk : chunks) rooms.push_back(rooms.back().behind(chunk.points));
    std::vector<std::optional<laz::DamagedChunk>> damages(chunks.size());
    // In a stage of a pipeline.
    for_each_nested(chunks.size(), [&](std::size_t i) {
      try {
        laz::ChunkDecoder& decoder = *decoders_.local();
        decoder.begin(input_, chunks[i]);
        decoder.decode(rooms[i].first(chunks[i].points));
        decoder.finish();
      } catch (const laz::DamagedChunk& damage) {
        damages[i] = damage;
      }
    });
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      if (damages[i]) refuse_chunk(&chunks[i] - chunks_.data(), *damages[i]);
    }
  }

  /// Decodes the next small chunks: as many as memory and threads suggest, at least one.
  void decode_group() {
    const int threads = std::max(1, tbb::this_task_arena::max_concurrency());
    const std::uint64_t most = static_cast<std::uint64_t>(threads) * kPointsPerThread;
    const std::size_t first = next_;
    std::uint64_t points = 0;
    do {
      points += chunks_[next_++].points;
    } while (next_ < chunks_.size() && is_small(chunks_[next_]) &&
             points + chunks_[next_].points <= most);
    ready_.clear();
    taken_ = 0;
    begun_ += points;
    decode(std::span(chunks_).subspan(first, next_ - first), ready_);
  }

  /// Appends points of the current chunk, or else of the next one, as many as there is room for.
  /// Returns false after the last chunk.
  bool decode_some(PointBatch& batch) {
    if (left_ == 0 && begun_ == bytes_.points) {
      if (!has_table_) check_end();
      return false;
    }
    try {
      if (left_ == 0) begin_chunk(has_table_ ? chunks_[next_] : next_chunk());
      const auto points = std::min<std::uint64_t>(kBatchPoints - batch.size(), left_);
      stream_->decode(add_room(batch, points));
      left_ -= points;
      if (left_ > 0) return true;
      position_ = stream_->finish();
      ++next_;
    } catch (const laz::DamagedChunk& damage) {
      refuse_chunk(next_, damage);
    }
    return true;
  }

  void begin_chunk(const Chunk& chunk) {
    if (!stream_) stream_ = laz::make_chunk_decoder(scheme_);
    stream_->begin(input_, chunk);
    left_ = chunk.points;
    begun_ += chunk.points;
  }

  /// The next chunk of a file without a table.
  Chunk next_chunk() const {
    std::uint64_t points = bytes_.points - begun_;
    if (scheme_.chunk_points && scheme_.chunks != Scheme::Chunks::kNone) {
      points = std::min<std::uint64_t>(points, *scheme_.chunk_points);
    }
    return {position_, bytes_.end, points, false};
  }

  /// Throws InputError where more points may follow: a whole record, unless it may be a chunk table
  /// to which nothing points.
  void check_end() const {
    const std::uint64_t left = bytes_.end - std::min(bytes_.end, position_);
    if (left < scheme_.record_bytes) return;
    std::array<std::byte, 8> head{};
    if (left >= head.size()) input_.read_at(position_, head);
    const bool is_table = load<std::uint32_t>(head.data()) == 0 &&
                          load<std::uint32_t>(head.data() + 4) == next_ &&
                          scheme_.chunks != Scheme::Chunks::kNone;
    if (is_table) return;
    refuse(input_.name(),
           "has {} bytes behind the {} points that its header declares, from byte {}; expected no "
           "more points. Its writer was interrupted, or wrote into a pipe: write the file again",
           left, bytes_.points, position_);
  }

  [[noreturn]] void refuse_chunk(std::uint64_t index, const laz::DamagedChunk& damage) const {
    refuse(input_.name(),
           "chunk {}{}: {}; expected compressed points as a LAZ writer leaves them. The file was "
           "cut or damaged: copy it again",
           index + 1, has_table_ ? " of " + std::to_string(chunks_.size()) : std::string(),
           damage.what);
  }

  InputBuffer input_;
  Scheme scheme_;
  laz::PointBytes bytes_;
  bool has_table_;
  std::vector<Chunk> chunks_;  ///< those of the table
  std::vector<Box> cubes_;
  /// Index of the chunk after each piece; empty where only read() works.
  std::vector<std::size_t> piece_ends_;
  CloudInfo info_;
  tbb::enumerable_thread_specific<std::unique_ptr<laz::ChunkDecoder>> decoders_;
  PointBatch ready_;         ///< points of the last decoded group
  std::size_t taken_ = 0;    ///< number of them that read() has delivered
  std::size_t next_ = 0;     ///< chunk to decode next
  std::uint64_t begun_ = 0;  ///< points of the chunks that were begun
  /// Decoder of large chunks and of files without a table; null before it is first needed.
  std::unique_ptr<laz::ChunkDecoder> stream_;
  std::uint64_t left_ = 0;      ///< points left in the chunk that stream_ is decoding
  std::uint64_t position_ = 0;  ///< end of the last chunk that stream_ decoded
};

/// The cubes of the chunks of a COPC file; none for other files, and where they are damaged.
std::vector<Box> cubes_of(const InputBuffer& input, std::span<const std::byte> copc,
                          std::span<const Chunk> chunks, CloudInfo& info) {
  if (copc.empty()) return {};
  try {
    return laz::read_copc_cubes(input, copc, chunks);
  } catch (const InputError& error) {
    info.remarks.push_back(
        plain_note(std::string(error.what()) + ". Its points are read without the hierarchy"));
    return {};
  }
}

}  // namespace

std::unique_ptr<PointReader> read_laz_points(InputBuffer input, const Scheme& scheme,
                                             const laz::PointBytes& bytes,
                                             std::span<const std::byte> copc, CloudInfo info) {
  std::optional<std::vector<Chunk>> chunks;
  std::vector<Box> cubes;
  if (scheme.chunks != Scheme::Chunks::kNone) {
    chunks = laz::read_chunk_table(input, scheme, bytes);
    if (chunks) {
      cubes = cubes_of(input, copc, *chunks, info);
    } else if (!scheme.chunk_points && bytes.points > 0) {
      refuse(input.name(),
             "has no chunk table, and its chunks differ in size; expected a table. Its writer was "
             "interrupted: write the file again");
    } else {
      info.remarks.push_back(plain_note(input.name() + ": has no chunk table; its " +
                                        std::to_string(bytes.points) +
                                        " points are read one chunk after the other"));
    }
  }
  return std::make_unique<LazReader>(std::move(input), scheme, bytes, std::move(chunks),
                                     std::move(cubes), std::move(info));
}

}  // namespace clearway
