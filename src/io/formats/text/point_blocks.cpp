#include "io/formats/text/point_blocks.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "core/util/tsan_annotations.hpp"

namespace clearway {

std::optional<std::uint64_t> PointBlocks::read(InputBuffer& input, const ParseBlock& parse,
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
    part.lines = static_cast<std::uint64_t>(std::ranges::count(block, '\n'));
    part.points.reserve(part.lines);
    part.good = (block.empty() || block.ends_with('\n')) && parse(block, part.points);
  };
  // Reading happens in a stage of a pipeline, so a thread that waits here must not begin another
  // stage.
  tbb::this_task_arena::isolate([&] {
    const ParallelScope scope;
    const auto piece = piece_of(scope, read_one);
    scope.begin();
    tbb::parallel_for(std::size_t{0}, parts.size(), piece);
  });
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

std::size_t PointBlocks::take(std::vector<Vec3>& out, std::size_t size) {
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
