#include "io/scans/laz/chunk_table.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "io/files/bytes.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/laz/coding/entropy_models.hpp"

namespace clearway::laz {
namespace {

constexpr std::uint64_t kPointerBytes = 8;
constexpr std::uint64_t kHeadBytes = 8;  ///< version, number of chunks

template <typename Number>
Number number_at(const InputBuffer& input, std::uint64_t position) {
  std::array<std::byte, sizeof(Number)> bytes;
  input.read_at(position, bytes);
  return load<Number>(bytes.data());
}

/// Position of the table; nullopt where there is none.
std::optional<std::uint64_t> find_table(const InputBuffer& input, const PointBytes& bytes) {
  const std::uint64_t first_chunk = bytes.begin + kPointerBytes;
  if (bytes.end < first_chunk) {
    refuse(input.name(), "ends at byte {}; expected the place of its chunk table at byte {}",
           bytes.end, bytes.begin);
  }
  auto table = number_at<std::uint64_t>(input, bytes.begin);
  // The table was not written, because the writer was interrupted.
  if (table == bytes.begin || table == 0) return std::nullopt;
  if (table == ~std::uint64_t{0}) {
    // A writer that cannot go back puts the position after the table, at the end of the file.
    const std::uint64_t size = *input.size();
    if (size < first_chunk + kHeadBytes + kPointerBytes) return std::nullopt;
    table = number_at<std::uint64_t>(input, size - kPointerBytes);
    const bool inside = table >= first_chunk && table <= size - kPointerBytes - kHeadBytes;
    return inside ? std::optional(table) : std::nullopt;
  }
  if (table < first_chunk || table > bytes.end || bytes.end - table < kHeadBytes) {
    refuse_byte(input.name(), bytes.begin,
                "its chunk table is to begin at byte " + std::to_string(table) +
                    "; expected it between the points, from byte " + std::to_string(first_chunk) +
                    ", and byte " + std::to_string(bytes.end) + ". A copy that was cut ends so");
  }
  return table;
}

/// Decodes the entries of a table one after the other.
class Entries {
 public:
  Entries(const InputBuffer& input, std::uint64_t begin, std::uint64_t end, const Scheme& scheme)
      : fixed_points_(scheme.chunk_points),
        model_(std::make_unique<IntegerModel<32, 2>>(fresh<IntegerModel<32, 2>>())),
        decoder_(window_.open(input, begin, end, kMostBytes)) {}

  /// The numbers of points and bytes of the next chunk.
  std::pair<std::uint32_t, std::uint32_t> next() {
    decoder_.move_to(window_.ahead(decoder_.cursor()));
    points_ = fixed_points_ ? *fixed_points_ : model_->decode(decoder_, points_, 0);
    bytes_ = model_->decode(decoder_, bytes_, 1);
    return {points_, bytes_};
  }
  void check_end() {
    window_.ahead(decoder_.cursor());
    if (decoder_.damaged()) throw DamagedChunk{"holds bits that no encoder writes"};
  }

 private:
  static constexpr std::ptrdiff_t kMostBytes = 64;

  std::optional<std::uint32_t> fixed_points_;
  std::unique_ptr<IntegerModel<32, 2>> model_;
  ByteWindow window_;
  ArithmeticDecoder decoder_;
  std::uint32_t points_ = 0, bytes_ = 0;
};

std::string chunk_of(std::uint64_t index, std::uint64_t count) {
  return "chunk " + std::to_string(index + 1) + " of " + std::to_string(count);
}

[[noreturn]] void refuse_count(const InputBuffer& input, std::uint64_t table_points, bool at_least,
                               std::uint64_t header_points) {
  refuse(input.name(),
         "its chunk table has {}{} points; expected {} as its header says. Its writer was "
         "interrupted, or wrote into a pipe: write the file again",
         at_least ? "at least " : "", table_points, header_points);
}

std::vector<Chunk> read_entries(const InputBuffer& input, const Scheme& scheme,
                                const PointBytes& bytes, std::uint64_t table, std::uint32_t count) {
  Entries entries(input, table + kHeadBytes, bytes.end, scheme);
  std::vector<Chunk> chunks;
  std::uint64_t position = bytes.begin + kPointerBytes;
  std::uint64_t points = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    auto [chunk_points, chunk_bytes] = entries.next();
    // Where chunks have a fixed number of points, the last one has the rest.
    if (scheme.chunk_points && points < bytes.points) {
      chunk_points =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(chunk_points, bytes.points - points));
    }
    if (chunk_bytes < scheme.record_bytes || chunk_bytes > table - position || chunk_points == 0) {
      refuse(input.name(),
             "{} has {} points in {} bytes from byte {}; expected at least one, in {} bytes or "
             "more that end before the chunk table at byte {}",
             chunk_of(i, count), chunk_points, chunk_bytes, position, scheme.record_bytes, table);
    }
    points += chunk_points;
    if (points > bytes.points) refuse_count(input, points, i + 1 < count, bytes.points);
    chunks.push_back({position, position + chunk_bytes, chunk_points, true});
    position += chunk_bytes;
  }
  entries.check_end();
  if (points != bytes.points) refuse_count(input, points, false, bytes.points);
  if (position != table) {
    refuse(input.name(), "its chunks end at byte " + std::to_string(position) +
                             "; expected them to end where the chunk table begins, at byte " +
                             std::to_string(table));
  }
  return chunks;
}

}  // namespace

std::optional<std::vector<Chunk>> read_chunk_table(const InputBuffer& input, const Scheme& scheme,
                                                   const PointBytes& bytes) {
  const auto table = find_table(input, bytes);
  if (!table) return std::nullopt;
  const auto version = number_at<std::uint32_t>(input, *table);
  const auto count = number_at<std::uint32_t>(input, *table + 4);
  const std::uint64_t room = *table - bytes.begin - kPointerBytes;
  // Some files list an empty chunk.
  if (room == 0 && bytes.points == 0) return std::vector<Chunk>{};
  if (version != 0 || count > room / scheme.record_bytes) {
    refuse_byte(input.name(), *table,
                "a chunk table of version " + std::to_string(version) + " with " +
                    std::to_string(count) + " chunks; expected version 0, and chunks that fit " +
                    std::to_string(room) + " bytes");
  }
  if (count == 0) {
    if (bytes.points != 0) refuse_count(input, 0, false, bytes.points);
    return std::vector<Chunk>{};
  }
  try {
    return read_entries(input, scheme, bytes, *table, count);
  } catch (const DamagedChunk& damage) {
    refuse_byte(input.name(), *table,
                "its chunk table " + damage.what + "; expected " + std::to_string(count) +
                    " chunks. The file was cut or damaged: copy it again");
  }
}

}  // namespace clearway::laz
