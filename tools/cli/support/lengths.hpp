#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/store.hpp"
#include "clearway/vec3.hpp"
#include "core/describe/field.hpp"
#include "io/files/text_number.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace clearway {
struct ResultHeader;
}

namespace clearway::tool {

/// What an option for a length expects, for errors: "expected a finite number of metres ...".
std::string expected_length(FieldRange range = FieldRange::kAboveZero);

/// Reads a length such as "0.1" or "10cm". A decimal becomes the nearest double, and "10cm" the
/// same as "0.1". Throws CLI::ValidationError naming the option where the text is not a finite
/// length of the range.
ParsedLength parse_length(const std::string& option, const std::string& text,
                          FieldRange range = FieldRange::kAboveZero);

/// The symbol that follows a length in the unit of a store's coordinates, given the unit's name.
/// Degrees count as metres here; other code warns of them.
std::string symbol_of_unit(const std::string& length_unit);

/// Sets the environment's unit in the given options of model and trajectory readers.
template <typename... Options>
void set_environment_unit(const Store& store, Options&... options) {
  ((options.environment_unit = store.metres_per_unit()), ...);
  ((options.environment_unit_is_assumed = store.length_unit() == "unknown"), ...);
}

/// Adds an option that takes the name of a file's unit.
CLI::Option* add_unit_option(CLI::App& command, const std::string& names, FileUnit& unit,
                             const std::string& description);

/// The name in help texts for the value of an option that takes one length.
inline constexpr const char* kLengthType = "METRES";

/// The lengths of a command line. Those given with a unit are converted once the environment's unit
/// is known.
class LengthOptions {
 public:
  /// Adds an option that takes a length, or several with commas between them. range: of a length
  /// that stands alone; each of several may be 0 or negative. This object and `lengths` outlive the
  /// command; optional ones are set once they are given.
  template <typename Lengths>
  CLI::Option* add(CLI::App& command, const std::string& name, Lengths& lengths,
                   const std::string& description, FieldRange range = FieldRange::kAboveZero) {
    Lengths any{};
    return add_numbers(
        command, name, numbers_of(any).size(), [&lengths] { return numbers_of(lengths); },
        description, range);
  }

  /// Converts the lengths that were given with a unit into units of `metres` metres.
  void convert(double metres) const;
  /// Converts the lengths that were given with a unit into the unit of a store. Where the store
  /// names no unit, returns a warning if a length was in feet or inches, since that suggests that
  /// the scan is not in metres.
  std::optional<Message> convert_for(const Store& store) const;
  /// Converts the lengths that were given with a unit into the unit of a result or section, and
  /// returns the metres of that unit. Where the file names none, its CRS does; warns where there is
  /// no CRS either and a length was given with a unit, since the scan may have another unit.
  /// file: its name, for the warning. length_unit: as Store::length_unit() names it
  double convert_for(const std::string& file, const std::string& crs_wkt,
                     const std::string& length_unit) const;
  /// Takes CRS and unit from the header of a result. file: the result, for the warning.
  double convert_for(const std::filesystem::path& file, const ResultHeader& header) const;

  /// Whether every length that was given names its unit; 0 needs none.
  bool all_have_units() const { return !lacks_unit_; }

 private:
  using Numbers = std::vector<double*>;

  static Numbers numbers_of(double& length) { return {&length}; }
  static Numbers numbers_of(Vec3& lengths) { return {&lengths.x, &lengths.y, &lengths.z}; }
  template <std::size_t kCount>
  static Numbers numbers_of(std::array<double, kCount>& lengths) {
    Numbers numbers;
    for (double& length : lengths) numbers.push_back(&length);
    return numbers;
  }
  template <typename Lengths>
  static Numbers numbers_of(std::optional<Lengths>& lengths) {
    return numbers_of(lengths.emplace());
  }

  CLI::Option* add_numbers(CLI::App& command, const std::string& name, std::size_t count,
                           const std::function<Numbers()>& numbers, const std::string& description,
                           FieldRange range);

  std::vector<std::pair<double*, ParsedLength>> with_unit_;
  bool lacks_unit_ = false;
};

/// Whether the unit of a file is known: by its option, or because a message of reading it names a
/// unit.
bool names_unit(const FileUnit& option, std::span<const Message> messages);

/// The note "feet" about a store in feet where all inputs name their units, so that nothing is
/// assumed to be in feet and the search need not warn of it; none for other stores.
std::optional<Message> note_on_feet(const Store& store);

/// Adds --chainage-start.
void add_chainage_option(CLI::App& command, LengthOptions& lengths, double& start);

}  // namespace clearway::tool
