#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "core/util/tsan_annotations.hpp"
#include "io/formats/text/text_buffer.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// Number of rows that a thread works on at a time.
inline constexpr std::size_t kBlockRows = 1 << 12;

/// Calls work(block, first row, end) for each block of rows, with many threads.
template <typename Work>
void for_each_block(std::size_t rows, Work work) {
  const ParallelScope scope;
  const auto run_block = piece_of(scope, [&](std::size_t block) {
    work(block, block * kBlockRows, std::min(rows, (block + 1) * kBlockRows));
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, (rows + kBlockRows - 1) / kBlockRows, run_block);
}

/// Appends rows to a file. Many threads make the texts by write_rows(text, first row, end).
template <typename WriteRows>
void write_blocks(const File& file, std::size_t rows, WriteRows write_rows) {
  std::vector<TextBuffer> blocks((rows + kBlockRows - 1) / kBlockRows);
  for_each_block(rows, [&](std::size_t block, std::size_t first, std::size_t end) {
    write_rows(blocks[block], first, end);
  });
  for (const TextBuffer& block : blocks) file.write(std::as_bytes(std::span(block.text())));
}

}  // namespace clearway
