#pragma once

#include <cstdint>

#include "io/journal/journal.hpp"

namespace clearway {

/// What a record of a search's journal holds; its first byte.
enum class JournalRecordKind : std::uint8_t {
  kCell = 1,
  kMarks = 2,
  kFinishedPoses = 3,
  kProfile = 4
};

/// How far the run of a journal came. Throws InputError for a record that is none of a run.
struct JournalledWork {
  std::uint64_t cells = 0;  ///< finished, or
  std::uint64_t poses = 0;
};
JournalledWork journalled_work(const JournalReader& journal);

}  // namespace clearway
