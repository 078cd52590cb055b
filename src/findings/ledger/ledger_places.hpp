#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "findings/ledger/ledger_date.hpp"
#include "findings/point_blocks.hpp"
#include "io/result/result_header.hpp"

namespace clearway {

/// What a row's values are compared by: those of its conflict, the greatest of several.
struct LedgerValues {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  std::optional<double> least = {};            ///< least distance; none without clearances
  std::array<double, 2> shifts{kNone, kNone};  ///< own shifts to the left and right
  std::array<double, 4> trims{kNone, kNone, kNone, kNone};  ///< left, right, above, below

  double shift() const { return shifts[0] < shifts[1] ? shifts[0] : shifts[1]; }
  friend bool operator==(const LedgerValues&, const LedgerValues&) = default;
};

LedgerValues values_of(const Conflict& conflict);

/// What a conflict was found for, as far as another one shows less or more.
struct LedgerQuestion {
  double radius = 0;
  double reach = 0;  ///< the greatest distance that counts, which is more with an error budget
  std::uint64_t model_hash = 0;
  std::optional<double> floor = {};
  std::uint64_t floors_hash = 0;  ///< of the floors of all bodies

  friend bool operator==(const LedgerQuestion&, const LedgerQuestion&) = default;
};

LedgerQuestion question_of(const ResultHeader& header);

/// A day of a scan, as ScanDates has it; none where the files do not say.
inline std::optional<Day> day_of_scan(const std::string& day) {
  const auto written = day_of(day);
  return written ? std::optional(written->day) : std::nullopt;
}

/// What the places file remembers of the cells of a row, so that a table of another run is noticed.
struct LedgerCells {
  Vec3 middle{}, size{};
  Day first_seen{}, last_seen{};
  friend bool operator==(const LedgerCells&, const LedgerCells&) = default;
};

/// The places of a row.
struct LedgerPlaces {
  std::string key;
  LedgerCells cells;
  double gap = 0;
  std::uint64_t min_points = 0;
  LedgerValues values;
  LedgerQuestion question;
  Quantisation quantisation{};
  std::optional<Day> gone_on = {};  ///< the day on which an update found it gone
  /// The first day, by the dates of its files, of the latest scan that showed the row; none where
  /// the files do not say
  std::optional<Day> scanned = {};
  std::vector<QuantumPoint> quanta;  ///< one of each cube of 5 cm

  Vec3 place(std::size_t i) const {
    const std::int32_t* q = quanta[i].q;
    return position(quantisation, q[0], q[1], q[2]);
  }
};

/// Where the places of a table are: beside it, with .places.h5 in the place of its ending.
std::filesystem::path places_of(const std::filesystem::path& table);

/// Writes a places file. unit: the name of the unit of all lengths.
void write_places(const std::filesystem::path& path, const std::vector<LedgerPlaces>& rows,
                  const std::string& unit);

/// Reads a places file. Throws InputError where it is damaged, of another kind, or in another unit.
std::vector<LedgerPlaces> read_places(const std::filesystem::path& path, const std::string& unit);

}  // namespace clearway
