#include "findings/ledger/ledger_places.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "findings/conflict_rank.hpp"
#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"
#include "io/files/table_file.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

constexpr TableFileKind kKind{"clearway ledger places", 3, "a file of the places of a ledger",
                              "clearway conflicts --ledger", "begin a new ledger"};

double or_nan(const std::optional<double>& value) { return value.value_or(std::nan("")); }
std::optional<double> not_nan(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

std::uint64_t as_number(const Day& day) {
  return static_cast<std::uint64_t>(day.year * 10'000 + day.month * 100 + day.day);
}
Day as_day(std::uint64_t number) {
  return {static_cast<int>(number / 10'000), static_cast<int>(number / 100 % 100),
          static_cast<int>(number % 100)};
}

/// What a row is, as the file stores it: a number that is not known is NaN.
struct RowNumbers {
  Vec3 middle, size;  ///< of its cells
  double gap, least;
  std::array<double, 2> shifts;
  std::array<double, 4> trims;
  double radius, reach, floor;  ///< of its question
  Quantisation quantisation;    ///< of its places
};

/// The counts, hashes and days of a row; 0 for a day that is not known.
struct RowCounts {
  std::uint64_t min_points, model_hash, floors_hash, first_seen, last_seen, places, gone_on,
      scanned;
};

}  // namespace

template <>
struct NumbersOf<RowNumbers> {
  using Number = double;
  static constexpr std::uint32_t kCount = 23;
};
template <>
struct NumbersOf<RowCounts> {
  using Number = std::uint64_t;
  static constexpr std::uint32_t kCount = 8;
};
template <>
struct NumbersOf<QuantumPoint> {
  using Number = std::int32_t;
  static constexpr std::uint32_t kCount = 3;
};

namespace {

/// The rows as the columns of the file.
struct PlacesColumns {
  std::vector<std::uint8_t> keys;  ///< all of them, one after another
  std::vector<std::uint32_t> key_bytes;
  std::vector<RowNumbers> numbers;
  std::vector<RowCounts> counts;
  std::vector<QuantumPoint> places;

  void add(const LedgerPlaces& row) {
    const auto& [key, cells, gap, min_points, values, question, steps, gone_on, scanned, quanta] =
        row;
    keys.insert(keys.end(), key.begin(), key.end());
    key_bytes.push_back(static_cast<std::uint32_t>(key.size()));
    numbers.push_back({cells.middle, cells.size, gap, or_nan(values.least), values.shifts,
                       values.trims, question.radius, question.reach, or_nan(question.floor),
                       steps});
    counts.push_back({min_points, question.model_hash, question.floors_hash,
                      as_number(cells.first_seen), as_number(cells.last_seen), quanta.size(),
                      gone_on ? as_number(*gone_on) : 0, scanned ? as_number(*scanned) : 0});
    places.insert(places.end(), quanta.begin(), quanta.end());
  }

  /// The rows of the columns, whose sizes agree.
  std::vector<LedgerPlaces> rows() const {
    const auto day_or_none = [](std::uint64_t day) {
      return day == 0 ? std::nullopt : std::optional(as_day(day));
    };
    std::vector<LedgerPlaces> out;
    auto key = keys.begin();
    auto place = places.begin();
    for (std::size_t i = 0; i < key_bytes.size(); ++i) {
      const RowNumbers& n = numbers[i];
      const RowCounts& c = counts[i];
      const auto key_end = key + key_bytes[i];
      const auto place_end = place + static_cast<std::ptrdiff_t>(c.places);
      out.push_back({.key = {key, key_end},
                     .cells = {n.middle, n.size, as_day(c.first_seen), as_day(c.last_seen)},
                     .gap = n.gap,
                     .min_points = c.min_points,
                     .values = {not_nan(n.least), n.shifts, n.trims},
                     .question = {n.radius, n.reach, c.model_hash, not_nan(n.floor), c.floors_hash},
                     .quantisation = n.quantisation,
                     .gone_on = day_or_none(c.gone_on),
                     .scanned = day_or_none(c.scanned),
                     .quanta = {place, place_end}});
      key = key_end;
      place = place_end;
    }
    return out;
  }

  /// Whether the columns have the rows, the bytes of keys and the places that they say.
  bool is_whole() const {
    std::uint64_t bytes = 0, left = places.size();
    for (const std::uint32_t of_key : key_bytes) bytes += of_key;
    for (const RowCounts& row : counts) {
      if (row.places > left) return false;
      left -= row.places;
    }
    return left == 0 && bytes == keys.size() && numbers.size() == key_bytes.size() &&
           counts.size() == key_bytes.size();
  }
};

}  // namespace

LedgerValues values_of(const Conflict& c) {
  const auto or_none = [](const std::optional<double>& v) {
    return v.value_or(LedgerValues::kNone);
  };
  return {
      c.least_distance,
      {or_none(c.own_shift_left), or_none(c.own_shift_right)},
      {or_none(c.trim_left), or_none(c.trim_right), or_none(c.trim_above), or_none(c.trim_below)}};
}

LedgerQuestion question_of(const ResultHeader& header) {
  std::vector<double> floors;
  for (const std::optional<double>& floor : header.body_floors) floors.push_back(or_nan(floor));
  return {header.radius, header.budget ? header.budget->near_radius(header.radius) : header.radius,
          header.model_hash, header.floor, xxh64(std::as_bytes(std::span(floors)))};
}

std::filesystem::path places_of(const std::filesystem::path& table) {
  std::filesystem::path out = table;
  return out.replace_extension(".places.h5");
}

void write_places(const std::filesystem::path& path, const std::vector<LedgerPlaces>& rows,
                  const std::string& unit) {
  PlacesColumns columns;
  for (const LedgerPlaces& row : rows) columns.add(row);
  TableFileWriter file(path, kKind);
  file.add_column("", "keys", columns.keys);
  file.add_column("", "key_bytes", columns.key_bytes);
  file.add_column("", "numbers", columns.numbers);
  file.add_column("", "counts", columns.counts);
  file.add_column("", "places", columns.places);
  file.finish({{"unit", unit}});
}

std::vector<LedgerPlaces> read_places(const std::filesystem::path& path, const std::string& unit) {
  const TableFile file(path, kKind);
  PlacesColumns columns;
  columns.keys = file.all<std::uint8_t>("keys");
  columns.key_bytes = file.all<std::uint32_t>("key_bytes");
  columns.numbers = file.all<RowNumbers>("numbers");
  columns.counts = file.all<RowCounts>("counts");
  columns.places = file.all<QuantumPoint>("places");
  if (!columns.is_whole()) {
    refuse(file.name(), "is damaged: the sizes of its columns contradict each other");
  }
  std::string own;
  HeaderValues(file.header(), file.name()).add("unit", own);
  if (own != unit) {
    refuse(file.name(), "has lengths in " + own + ", and the result in " + unit +
                            "; expected scans in one unit");
  }
  return columns.rows();
}

}  // namespace clearway
