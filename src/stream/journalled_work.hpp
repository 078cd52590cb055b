#pragma once

#include <cstdint>

#include "io/journal/journal.hpp"

namespace clearway {

/// The kind of a record in a search's journal; its first byte.
enum class JournalRecordKind : std::uint8_t {
  kCell = 1,
  kMarks = 2,
  kFinishedPoses = 3,
  kProfile = 4
};

/// How much of a run a journal holds. Throws InputError for a record that is not of a run.
struct JournalledWork {
  std::uint64_t cells = 0;  ///< finished cells, for engines that work on pages
  std::uint64_t poses = 0;
};
JournalledWork journalled_work(const JournalReader& journal);

}  // namespace clearway
