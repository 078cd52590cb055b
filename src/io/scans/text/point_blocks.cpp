#include "io/scans/text/point_blocks.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <span>

#include "io/files/parallel_loop.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

/// Bytes read after a block to find the end of its last line; a longer line takes a second read.
constexpr std::uint64_t kUsualLine = 1 << 10;

}  // namespace

LineBlocks::LineBlocks(const InputBuffer& input)
    : input_(input), begin_(input.position()), end_(*input.size()) {}

std::string_view LineBlocks::read(std::size_t block, std::vector<char>& room) const {
  const std::uint64_t first = begin_ + block * kBlockBytes;
  const std::uint64_t last = std::min(end_, first + kBlockBytes);
  // Includes the byte before, to see whether a line ends there.
  const std::uint64_t from = block == 0 ? first : first - 1;
  std::uint64_t loaded = from;
  const auto load_to = [&](std::uint64_t to) {
    room.resize(to - from);
    input_.read_at(loaded, std::as_writable_bytes(std::span(room).subspan(loaded - from)));
    loaded = to;
  };
  /// Finds the end of the line to which the byte before `at` belongs; npos where it is not loaded.
  const auto line_end = [&](std::uint64_t at) {
    const char* const loaded_end = room.data() + room.size();
    const char* const stop = find_line_end(room.data() + (at - 1 - from), loaded_end);
    const std::size_t bytes = line_break_bytes(stop, loaded_end);
    const bool is_half = bytes == 1 && *stop == '\r' && stop + 1 == loaded_end && loaded < end_;
    return bytes == 0 || is_half ? std::string_view::npos
                                 : static_cast<std::size_t>(stop - room.data()) + bytes;
  };
  load_to(std::min(end_, last + kUsualLine));
  std::size_t end = line_end(last);
  if (end == std::string_view::npos && loaded < end_) {
    load_to(std::min(end_, last + InputBuffer::kLongestLine + 1));
    end = line_end(last);
  }
  end = std::min(end, room.size());
  const std::size_t begin = block == 0 ? 0 : std::min(line_end(first), end);
  return {room.data() + begin, end - begin};
}

namespace {

/// Whether a field is digits with one comma between them, perhaps after a sign.
bool has_decimal_comma(std::string_view field) {
  if (field.starts_with('-') || field.starts_with('+')) field.remove_prefix(1);
  const std::size_t comma = field.find(',');
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || c == ','; };
  return comma != std::string_view::npos && comma > 0 && comma + 1 < field.size() &&
         field.find(',', comma + 1) == std::string_view::npos &&
         std::all_of(field.begin(), field.end(), is_digit);
}

}  // namespace

bool parse_point(std::string_view line, Vec3& point) {
  const char* at = line.data();
  const char* const end = at + line.size();
  char first = 0;
  if (!parse_number(at, end, point.x) || (first = skip_separator(at, end)) == 0 ||
      !parse_number(at, end, point.y) || skip_separator(at, end) != first ||
      !parse_number(at, end, point.z)) {
    return false;
  }
  if (at == end) return true;
  const char behind = skip_separator(at, end);
  return behind == first || behind == ' ';
}

std::optional<std::uint64_t> count_in(std::string_view line) {
  return parse_count(line.substr(0, line.find_last_not_of(" \t") + 1));
}

std::uint64_t most_points_in_rest(const InputBuffer& input) {
  // Bytes of "0 0 0" and a line break, which the last line may lack.
  constexpr std::uint64_t kShortest = 6;
  return (*input.size() - input.position() + 1) / kShortest;
}

bool PointLine::parse(std::string_view line, Vec3& point) {
  if (columns_ == kFirstThree) return parse_point(line, point);
  split_fields(line, separator_, fields_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns_[axis] >= fields_.size()) return false;
    const auto value = parse_whole_number(fields_[columns_[axis]]);
    if (!value) return false;
    point[static_cast<int>(axis)] = *value;
  }
  return true;
}

std::string_view without_leading_blanks(std::string_view line) {
  const char* const end = line.data() + line.size();
  const char* const start = skip_blanks(line.data(), end);
  return {start, static_cast<std::size_t>(end - start)};
}

bool is_text_comment(std::string_view line) {
  return line.empty() || line.front() == '#' || line.starts_with("//");
}

bool next_data_line(InputBuffer& input, std::string_view& line) {
  do {
    if (!input.next_line(line)) return false;
    line = without_leading_blanks(line);
  } while (is_text_comment(line));
  return true;
}

char separator_of(std::string_view line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  double number = 0;
  if (parse_number(at, end, number)) {
    if (const char separator = skip_separator(at, end)) return separator;
  }
  return line.find(';') != std::string_view::npos   ? ';'
         : line.find(',') != std::string_view::npos ? ','
                                                    : ' ';
}

std::size_t count_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  split_fields(line, separator_of(line), fields);
  return fields.size();
}

std::string decimal_commas_in(std::string_view line) {
  std::vector<std::string_view> fields;
  split_fields(line, line.find(';') != std::string_view::npos ? ';' : ' ', fields);
  const auto found = std::count_if(fields.begin(), fields.end(), has_decimal_comma);
  return found > 1 ? " has decimal commas, which are not read; write decimal points" : "";
}

std::optional<std::uint64_t> PointLineBlocks::read(InputBuffer& input, const ParseBlock& parse,
                                                   std::uint64_t most) {
  parts_.clear();
  part_ = point_ = 0;
  if (!input.can_seek()) return std::nullopt;
  const LineBlocks blocks(input);
  const auto threads =
      static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
  std::vector<Part> parts(std::min(threads, blocks.count()));
  tbb::enumerable_thread_specific<std::vector<char>> rooms;
  const auto read_one = [&](std::size_t i) {
    const std::string_view block = blocks.read(i, rooms.local());
    Part& part = parts[i];
    part.bytes = block.size();
    part.lines = count_line_breaks(block);
    part.points.reserve(part.lines);
    part.good = (block.empty() || is_line_end(block.back())) && parse(block, part.points);
  };
  for_each_nested(parts.size(), read_one);  // in a stage of a pipeline
  std::uint64_t read = 0;
  InputBuffer::Mark end = input.mark();
  for (Part& part : parts) {
    if (!part.good || part.points.size() > most - read) break;
    read += part.points.size();
    end.position += part.bytes;
    end.line += part.lines;
    parts_.push_back(std::move(part));
  }
  if (parts_.empty()) return std::nullopt;
  input.return_to(end);
  return read;
}

std::size_t PointLineBlocks::take(std::vector<Vec3>& out, std::size_t size) {
  const std::size_t before = out.size();
  for (; part_ < parts_.size() && out.size() < size; point_ = 0, ++part_) {
    const std::vector<Vec3>& points = parts_[part_].points;
    const std::size_t count = std::min(points.size() - point_, size - out.size());
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(point_);
    out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(count));
    point_ += count;
    if (point_ < points.size()) break;
  }
  return out.size() - before;
}

}  // namespace clearway
