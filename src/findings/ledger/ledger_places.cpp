#include "findings/ledger/ledger_places.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "clearway/error.hpp"
#include "findings/conflict_rank.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

constexpr const char* kFormat = "clearway ledger places";
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kNumbers = 23, kCounts = 8;

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

/// The rows as the columns of the file.
struct PlacesColumns {
  std::vector<std::uint8_t> keys;  ///< all of them, one after another
  std::vector<std::uint32_t> key_bytes;
  std::vector<double> numbers;        ///< kNumbers of each row
  std::vector<std::uint64_t> counts;  ///< kCounts of each row
  std::vector<std::int32_t> places;

  void add(const LedgerPlaces& row) {
    keys.insert(keys.end(), row.key.begin(), row.key.end());
    key_bytes.push_back(static_cast<std::uint32_t>(row.key.size()));
    const LedgerCells& cells = row.cells;
    const Quantisation& steps = row.quantisation;
    for (const Vec3& v : {cells.middle, cells.size}) numbers.insert(numbers.end(), {v.x, v.y, v.z});
    numbers.insert(numbers.end(), {row.gap, or_nan(row.values.least)});
    numbers.insert(numbers.end(), row.values.shifts.begin(), row.values.shifts.end());
    numbers.insert(numbers.end(), row.values.trims.begin(), row.values.trims.end());
    numbers.insert(numbers.end(),
                   {row.question.radius, row.question.reach, or_nan(row.question.floor)});
    numbers.insert(numbers.end(), std::begin(steps.scale), std::end(steps.scale));
    numbers.insert(numbers.end(), std::begin(steps.offset), std::end(steps.offset));
    counts.insert(counts.end(), {row.min_points, row.question.model_hash, row.question.floors_hash,
                                 as_number(cells.first_seen), as_number(cells.last_seen),
                                 row.quanta.size(), row.gone_on ? as_number(*row.gone_on) : 0,
                                 row.scanned ? as_number(*row.scanned) : 0});
    for (const QuantumPoint& point : row.quanta) {
      places.insert(places.end(), std::begin(point.q), std::end(point.q));
    }
  }

  std::uint64_t hash() const {
    ColumnHashes hashes;
    hashes.add(keys);
    hashes.add(key_bytes);
    hashes.add(numbers);
    hashes.add(counts);
    hashes.add(places);
    return hashes.digest();
  }

  /// The rows of the columns, whose sizes agree.
  std::vector<LedgerPlaces> rows() const {
    std::vector<LedgerPlaces> out(key_bytes.size());
    std::size_t key = 0, place = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      LedgerPlaces& row = out[i];
      for (std::uint32_t byte = 0; byte < key_bytes[i]; ++byte) {
        row.key += static_cast<char>(keys[key++]);
      }
      const double* n = &numbers[i * kNumbers];
      const std::uint64_t* c = &counts[i * kCounts];
      row.cells = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, as_day(c[3]), as_day(c[4])};
      row.gap = n[6];
      row.values = {not_nan(n[7]), {n[8], n[9]}, {n[10], n[11], n[12], n[13]}};
      row.question = {n[14], n[15], c[1], not_nan(n[16]), c[2]};
      for (int k = 0; k < 3; ++k) {
        row.quantisation.scale[k] = n[17 + k];
        row.quantisation.offset[k] = n[20 + k];
      }
      row.min_points = c[0];
      if (c[6] != 0) row.gone_on = as_day(c[6]);
      if (c[7] != 0) row.scanned = as_day(c[7]);
      for (std::uint64_t p = 0; p < c[5]; ++p, place += 3) {
        row.quanta.push_back({{places[place], places[place + 1], places[place + 2]}});
      }
    }
    return out;
  }
};

/// The values of the columns of a row that has so many.
template <typename Number>
std::vector<Number> read_column(const hdf5::Id& file, const char* column, std::uint64_t columns,
                                const std::string& name) {
  const std::uint64_t rows = hdf5::dataset_rows(file, column, name);
  return hdf5::read_dataset<Number>(file, column, rows, columns, name);
}

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
  hdf5::naming(path.string(), [&] {
    hdf5::Id file = hdf5::create_file(path);
    hdf5::write_attribute(file, "format", std::string(kFormat));
    hdf5::write_number<std::uint32_t>(file, "version", kVersion);
    hdf5::write_attribute(file, "unit", unit);
    hdf5::write_number<std::uint64_t>(file, "hash", columns.hash());
    hdf5::write_dataset<std::uint8_t>(file, "keys", columns.keys);
    hdf5::write_dataset<std::uint32_t>(file, "key_bytes", columns.key_bytes);
    hdf5::write_dataset<double>(file, "numbers", columns.numbers, kNumbers);
    hdf5::write_dataset<std::uint64_t>(file, "counts", columns.counts, kCounts);
    hdf5::write_dataset<std::int32_t>(file, "places", columns.places, 3);
    file.close("close");
  });
}

std::vector<LedgerPlaces> read_places(const std::filesystem::path& path, const std::string& unit) {
  const std::string name = path.string();
  return hdf5::naming(name, [&] {
    const hdf5::Id file = hdf5::open_file(path);
    if (!hdf5::has_attribute(file, "format", name) ||
        hdf5::read_text_attribute(file, "format", name) != kFormat) {
      throw InputError(name + ": is no file of the places of a ledger");
    }
    if (hdf5::read_number<std::uint32_t>(file, "version", name) != kVersion) {
      throw InputError(name + ": is of another version of Clearway");
    }
    PlacesColumns columns;
    columns.keys = read_column<std::uint8_t>(file, "keys", 0, name);
    columns.key_bytes = read_column<std::uint32_t>(file, "key_bytes", 0, name);
    columns.numbers = read_column<double>(file, "numbers", kNumbers, name);
    columns.counts = read_column<std::uint64_t>(file, "counts", kCounts, name);
    columns.places = read_column<std::int32_t>(file, "places", 3, name);
    if (columns.hash() != hdf5::read_number<std::uint64_t>(file, "hash", name)) {
      throw InputError(name + ": is damaged: its contents do not have the recorded hash");
    }
    // From here on the file holds what a program wrote, except that anybody can make such a hash.
    const std::size_t rows = columns.key_bytes.size();
    std::uint64_t keys = 0, places = 0;
    for (const std::uint32_t bytes : columns.key_bytes) keys += bytes;
    const bool is_whole =
        columns.numbers.size() == rows * kNumbers && columns.counts.size() == rows * kCounts;
    for (std::size_t i = 0; is_whole && i < rows; ++i) {
      const std::uint64_t count = columns.counts[i * kCounts + 5];
      places = count > columns.places.size() ? ~std::uint64_t{0} / 4 : places + count;
      if (places > columns.places.size()) break;
    }
    if (!is_whole || keys != columns.keys.size() || 3 * places != columns.places.size()) {
      throw InputError(name + ": is damaged: the sizes of its columns contradict each other");
    }
    if (const std::string own = hdf5::read_text_attribute(file, "unit", name); own != unit) {
      throw InputError(name + ": has lengths in " + own + ", and the result in " + unit +
                       "; expected scans in one unit");
    }
    return columns.rows();
  });
}

}  // namespace clearway
