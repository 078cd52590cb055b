#include "io/scans/laz/laz_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "clearway/error.hpp"
#include "core/messages/messages.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/laz/chunk_table.hpp"
#include "io/scans/laz/copc_hierarchy.hpp"

namespace clearway {
namespace {

using laz::Chunk;
using laz::Quanta;
using laz::Scheme;

/// Makes room in the batch for `count` points from index `first` on, as the scheme asks for them.
laz::PointRoom room_in(PointBatch& batch, std::size_t first, std::size_t count,
                       const Scheme& scheme) {
  batch.quanta.resize(first + count);
  batch.classes.resize(first + count);
  batch.flags.resize(scheme.with_flags ? first + count : 0);
  batch.times.resize(scheme.with_times ? first + count : 0);
  std::uint8_t* const flags = scheme.with_flags ? batch.flags.data() + first : nullptr;
  double* const times = scheme.with_times ? batch.times.data() + first : nullptr;
  return {batch.quanta.data() + first, batch.classes.data() + first, flags, times, count};
}

/// Reads a file with a chunk table.
class TabledReader final : public PointReader {
 public:
  /// cubes: that of each chunk, where the file is COPC; otherwise empty.
  TabledReader(InputBuffer input, const Scheme& scheme, std::vector<Chunk> chunks,
               std::vector<Box> cubes, CloudInfo info)
      : input_(std::move(input)),
        chunks_(std::move(chunks)),
        cubes_(std::move(cubes)),
        info_(std::move(info)),
        scheme_(scheme),
        groups_(scheme) {
    find_pieces();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.positions.clear();
    batch.quanta.clear();
    batch.classes.clear();
    batch.flags.clear();
    batch.times.clear();
    while (batch.quanta.size() < kBatchPoints) {
      if (!ready_.empty()) {
        const auto part = ready_.first(std::min(ready_.size(), kBatchPoints - batch.quanta.size()));
        const auto classes = groups_.classes().last(ready_.size()).first(part.size());
        batch.quanta.insert(batch.quanta.end(), part.begin(), part.end());
        batch.classes.insert(batch.classes.end(), classes.begin(), classes.end());
        if (scheme_.with_flags) {
          const auto flags = groups_.flags().last(ready_.size()).first(part.size());
          batch.flags.insert(batch.flags.end(), flags.begin(), flags.end());
        }
        if (scheme_.with_times) {
          const auto times = groups_.times().last(ready_.size()).first(part.size());
          batch.times.insert(batch.times.end(), times.begin(), times.end());
        }
        ready_ = ready_.subspan(part.size());
      } else if (next_ == chunks_.size()) {
        break;
      } else if (groups_.takes(chunks_[next_])) {
        next_ += groups_.decode(input_, std::span(chunks_).subspan(next_), next_, chunks_.size());
        ready_ = groups_.points();
      } else {
        read_large(batch);
      }
    }
    return !batch.quanta.empty();
  }

  void rewind() override {
    next_ = 0;
    left_ = 0;
    ready_ = {};
  }

  std::size_t pieces() const override { return piece_ends_.size(); }

  std::uint64_t points_of_piece(std::size_t piece) const override {
    std::uint64_t points = 0;
    for (const Chunk& chunk : chunks_of(piece)) points += chunk.points;
    return points;
  }

  void read_piece(std::size_t piece, PointBatch& batch, PieceBytes* bytes) override {
    const std::span<const Chunk> chunks = chunks_of(piece);
    laz::PointRoom room = room_in(batch, 0, points_of_piece(piece), scheme_);
    for (const Chunk& chunk : chunks) {
      try {
        groups_.decode_alone(input_, chunk, room.first(chunk.points));
      } catch (const laz::DamagedChunk& damage) {
        const auto index = static_cast<std::uint64_t>(&chunk - chunks_.data());
        laz::refuse_chunk(input_.name(), index, chunks_.size(), damage);
      }
      room = room.behind(chunk.points);
    }
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
  /// Forms pieces of several chunks each, and of one each where it has a cube; none where a chunk
  /// is too large to be decoded as a whole.
  void find_pieces() {
    std::uint64_t points = 0, bytes = 0;
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
      const std::uint64_t size = chunks_[i].end - chunks_[i].begin;
      if (!groups_.takes(chunks_[i]) || size > kMostChunkBytes) {
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

  static constexpr std::uint64_t kMostChunkBytes = std::uint64_t{4} << 20;
  /// Appends points of a chunk that is too large for a group, as many as there is room for.
  void read_large(PointBatch& batch) {
    try {
      const Chunk& chunk = chunks_[next_];
      if (left_ == 0) {
        if (!stream_) stream_ = laz::make_chunk_decoder(scheme_);
        stream_->begin(input_, chunk);
        left_ = chunk.points;
      }
      const std::size_t before = batch.quanta.size();
      const auto points = std::min<std::uint64_t>(kBatchPoints - before, left_);
      stream_->decode(room_in(batch, before, points, scheme_));
      left_ -= points;
      if (left_ > 0) return;
      stream_->finish();
      ++next_;
    } catch (const laz::DamagedChunk& damage) {
      laz::refuse_chunk(input_.name(), next_, chunks_.size(), damage);
    }
  }

  InputBuffer input_;
  std::vector<Chunk> chunks_;
  std::vector<Box> cubes_;
  /// Index of the chunk after each piece; empty where only read() works.
  std::vector<std::size_t> piece_ends_;
  CloudInfo info_;
  Scheme scheme_;
  laz::ChunkGroups groups_;
  std::span<const Quanta> ready_;  ///< points of the last decoded group that are not delivered yet
  std::size_t next_ = 0;           ///< chunk to decode next
  /// Decoder of large chunks; null before it is first needed.
  std::unique_ptr<laz::ChunkDecoder> stream_;
  std::uint64_t left_ = 0;  ///< points left in the large chunk that stream_ is decoding
};

/// Reads a file without a chunk table, where the position of a chunk is known only once the one
/// before was decoded.
class UntabledReader final : public PointReader {
 public:
  UntabledReader(InputBuffer input, const Scheme& scheme, const laz::PointBytes& bytes,
                 CloudInfo info)
      : input_(std::move(input)),
        scheme_(scheme),
        bytes_(bytes),
        info_(std::move(info)),
        decoder_(laz::make_chunk_decoder(scheme)) {
    rewind();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.positions.clear();
    const auto points = std::min<std::uint64_t>(kBatchPoints, bytes_.points - read_);
    try {
      for (laz::PointRoom room = room_in(batch, 0, points, scheme_); room.count > 0;) {
        room = room.behind(read_chunk(room));
      }
    } catch (const laz::DamagedChunk& damage) {
      laz::refuse_chunk(input_.name(), chunk_, 0, damage);
    }
    if (read_ == bytes_.points) check_end();
    return points > 0;
  }

  void rewind() override {
    position_ = bytes_.begin + (scheme_.chunks == Scheme::Chunks::kNone ? 0 : kPointerBytes);
    chunk_ = read_ = left_ = 0;
  }

 private:
  static constexpr std::uint64_t kPointerBytes = 8;

  /// Reads some points of the current chunk, or of the next one. Returns their number.
  std::size_t read_chunk(laz::PointRoom room) {
    if (left_ == 0) {
      left_ = bytes_.points - read_;
      if (scheme_.chunk_points && scheme_.chunks != Scheme::Chunks::kNone) {
        left_ = std::min<std::uint64_t>(left_, *scheme_.chunk_points);
      }
      decoder_->begin(input_, {position_, bytes_.end, left_, false});
    }
    const auto points = std::min<std::uint64_t>(room.count, left_);
    decoder_->decode(room.first(points));
    read_ += points;
    left_ -= points;
    if (left_ == 0) {
      position_ = decoder_->finish();
      ++chunk_;
    }
    return points;
  }

  /// Throws InputError where more points may follow: a whole record, unless it may be a chunk table
  /// to which nothing points.
  void check_end() const {
    const std::uint64_t left = bytes_.end - std::min(bytes_.end, position_);
    if (left < scheme_.record_bytes) return;
    std::array<std::byte, 8> head{};
    if (left >= head.size()) input_.read_at(position_, head);
    const bool is_table = load<std::uint32_t>(head.data()) == 0 &&
                          load<std::uint32_t>(head.data() + 4) == chunk_ &&
                          scheme_.chunks != Scheme::Chunks::kNone;
    if (is_table) return;
    refuse(input_.name(),
           "has " + std::to_string(left) + " bytes behind the " + std::to_string(bytes_.points) +
               " points that its header declares, from byte " + std::to_string(position_) +
               "; expected no more points. Its writer was interrupted, or wrote "
               "into a pipe: write the file again");
  }

  InputBuffer input_;
  Scheme scheme_;
  laz::PointBytes bytes_;
  CloudInfo info_;
  std::unique_ptr<laz::ChunkDecoder> decoder_;
  std::uint64_t position_ = 0;  ///< position of the chunk to read next
  std::uint64_t chunk_ = 0;
  std::uint64_t read_ = 0;  ///< number of points read
  std::uint64_t left_ = 0;  ///< points left in the current chunk
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
  if (scheme.chunks != Scheme::Chunks::kNone) {
    auto chunks = laz::read_chunk_table(input, scheme, bytes);
    if (chunks) {
      std::vector<Box> cubes = cubes_of(input, copc, *chunks, info);
      return std::make_unique<TabledReader>(std::move(input), scheme, std::move(*chunks),
                                            std::move(cubes), std::move(info));
    }
    if (!scheme.chunk_points && bytes.points > 0) {
      refuse(input.name(),
             "has no chunk table, and its chunks differ in size; expected a table. Its writer was "
             "interrupted: write the file again");
    }
    info.remarks.push_back(plain_note(input.name() + ": has no chunk table; its " +
                                      std::to_string(bytes.points) +
                                      " points are read one chunk after the other"));
  }
  return std::make_unique<UntabledReader>(std::move(input), scheme, bytes, std::move(info));
}

}  // namespace clearway
