#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Names of columns, in lower case.
using ColumnNames = std::span<const std::string_view>;

inline constexpr std::string_view kLatitudeColumns[] = {"lat", "latitude"};
inline constexpr std::string_view kLongitudeColumns[] = {"lon", "long", "lng", "longitude"};
inline constexpr std::string_view kRollColumns[] = {"roll"};
inline constexpr std::string_view kPitchColumns[] = {"pitch"};
inline constexpr std::string_view kHeadingColumns[] = {"heading", "azimuth"};
inline constexpr std::string_view kYawColumns[] = {"yaw"};

/// A line that names the columns of a text table.
struct TableHeader {
  char separator = ' ';  ///< ',', ';' or ' ' for any blanks
  /// Names in lower case, without quotes, blanks and units: "X_ft" and "x [ft]" are both "x".
  std::vector<std::string> names;
  /// The unit of each column, given in brackets or after `_`, in lower case; or empty.
  std::vector<std::string> units;
  std::vector<std::string> written;  ///< the names with units after `_`, such as "x_ft"

  /// The index of the only column whose name is one of `prefixes` followed by `suffix`; nullopt
  /// where there is no such column or more than one.
  std::optional<std::size_t> find(ColumnNames prefixes, std::string_view suffix = {}) const;
  std::optional<std::size_t> find(std::string_view name) const { return find({&name, 1}); }
  bool has(ColumnNames any_of) const;
};

/// Splits a header line. A comment mark (#, // or %) and a label that ends in a colon are dropped.
/// separator: that of the table; 0 where the line decides.
TableHeader parse_table_header(std::string_view line, char separator = 0);

/// The names of the columns that are not among `used`, with their units after `_`.
std::vector<std::string> other_columns(const TableHeader& header,
                                       std::span<const std::size_t> used);

/// The text with small letters of ASCII.
std::string lower_case(std::string_view text);
/// The lower-case form of a name, as TableHeader holds it, with a unit after `_`.
std::string table_name(std::string_view field);

/// Splits a line of data in the same way as its header: at runs of blanks, or at every comma or
/// semicolon, except within a field in double quotes (RFC 4180). fields: views of `line`, including
/// blanks around them; the vector keeps its capacity.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// What a field says: without blanks around it, and without its double quotes, within which two of
/// them stand for one (RFC 4180).
std::string unquoted(std::string_view field);

/// Why a line has not as many fields as its table.
std::string objection_to_fields(std::string_view line, std::size_t found, std::size_t expected);

/// Why a field is no number. column: its index. expected: for the message, such as "a number".
std::string objection_to_number(std::string_view field, std::size_t column,
                                const std::string& expected);

/// Indices of the columns that hold x, y and z.
using CoordinateColumns = std::array<std::size_t, 3>;

/// The columns of x, y and z, or of easting, northing and height, in any order. Nullopt where one
/// is missing or named twice.
std::optional<CoordinateColumns> coordinate_columns(const TableHeader& header);

/// Indices of the columns of a line in plan, with or without heights.
struct PlanColumns {
  std::size_t x, y;
  std::optional<std::size_t> z;
};

/// The columns of x and y, or of easting and northing, and that of z or a height where the table
/// has one. Nullopt where x or y is missing or one of them is named twice.
std::optional<PlanColumns> plan_columns(const TableHeader& header);

/// What kind of table the names indicate if not one of points, for a message; otherwise empty.
std::string other_table(const TableHeader& header);

/// Takes the units of the columns x, y and z as the header gives them. Returns the unit that is not
/// read, or the two of x and y that differ, and takes none then; otherwise empty.
std::string take_units(const TableHeader& header, const CoordinateColumns& columns, StatedCrs& out);

/// A column of a table, and how its numbers are converted.
struct TextColumn {
  std::string name;       ///< as messages call it
  std::size_t index = 0;  ///< from 0
  bool has_unit = false;  ///< whether the header names its unit
  UnitFactor factor{1};
};

/// The unit of the lengths in a column, and the one in which they are wanted, in metres.
struct ColumnUnit {
  double unless_named;     ///< the unit where the header names none
  double environment = 1;  ///< the environment's unit, see FileUnit
  double wanted = 1;
};

/// Reads a table of text row by row: a header that names the columns, and rows with as many fields.
/// A reader declares its columns with column() or needed() after take_header().
/// All members throw InputError with the number of the line.
class TextTable {
 public:
  /// separator: the only one that the table may have; 0 where the header decides.
  explicit TextTable(InputBuffer input, char separator = 0);

  const std::string& name() const { return input_.name(); }
  InputBuffer& input() { return input_; }

  /// Advances to the next line that is not blank; returns false at the end.
  bool next();
  /// The line, without leading blanks. Valid until the next one is read.
  std::string_view line() const { return line_; }
  /// Whether the line starts with # or //.
  bool is_comment() const;
  bool starts_with_number() const;
  [[noreturn]] void refuse_here(const std::string& what, Remedy remedy = Remedy::kNone) const {
    refuse_line(name(), input_.line(), what, remedy);
  }
  /// Warns where the text ends without a line break in a number that may lack digits.
  void remark_cut(std::vector<Message>& remarks) const;

  /// Reads the line as the header.
  const TableHeader& take_header();
  /// Reads the line as the header, and returns whether it names these columns alone, in this order
  /// and without units.
  bool is_header(ColumnNames names);
  /// The column that has one of the names, of which the first is for messages; nullopt where none
  /// has. Throws where two have, and for a unit that is none of length.
  std::optional<TextColumn> column(ColumnNames names, const ColumnUnit& unit) const;
  std::optional<TextColumn> column(std::string_view name, const ColumnUnit& unit) const {
    return column(ColumnNames(&name, 1), unit);
  }
  /// The column of this name, which has no unit; `otherwise` says what is expected without it.
  TextColumn needed(std::string_view name, const char* otherwise) const;
  std::optional<TextColumn> column(std::string_view name) const;

  /// Reads the line as a row. most: number of rows that are allowed. rows: what they are, for the
  /// message.
  void take_row(std::size_t most, const char* rows);
  /// The number in a field of the row, which must be finite, as it is wanted.
  double number(const TextColumn& column) const;
  /// What a field of the row says, see unquoted().
  std::string text(const TextColumn& column) const;

 private:
  std::optional<TextColumn> find(std::span<const std::string> columns, ColumnNames names) const;

  InputBuffer input_;
  char separator_;
  std::string_view line_;
  TableHeader header_;
  std::size_t rows_ = 0;
  bool is_cut_ = false;  ///< whether the line ends the text within a number
  std::vector<std::string_view> fields_;
};

}  // namespace clearway
