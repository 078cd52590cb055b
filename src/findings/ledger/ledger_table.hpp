#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/ledger.hpp"
#include "findings/ledger/ledger_date.hpp"

namespace clearway {

/// The columns of a ledger, in the order in which a new one has them.
enum class LedgerColumn {
  kKey,
  kStatus,
  kOwner,
  kComment,
  kUntil,
  kX,
  kY,
  kZ,
  kSizeX,
  kSizeY,
  kSizeZ,
  kSide,
  kLeast,
  kTrim,
  kFirstSeen,
  kLastSeen
};
inline constexpr std::size_t kLedgerColumns = 16;

/// The name of a column, as its header has it.
const char* name_of(LedgerColumn column);

/// The table of a ledger: CSV as spreadsheets write it, with commas, semicolons or tabs, with or
/// without a byte order mark, with any order of the columns and further ones. What is not changed
/// is written as it was read, byte for byte.
class LedgerTable {
 public:
  /// A table without rows.
  LedgerTable();
  /// Reads a table. name: the file's, for messages. Throws InputError, which names line and column,
  /// where a column is missing or there twice, a key is there twice, or a status is none of the
  /// four.
  LedgerTable(std::string text, std::string name);

  std::size_t rows() const { return rows_.size(); }

  /// What a cell says, without quotes and without blanks around it.
  std::string get(std::size_t row, LedgerColumn column) const;
  LedgerStatus status(std::size_t row) const;
  /// A length or coordinate; none where the cell is empty. Throws InputError for anything else.
  std::optional<double> number(std::size_t row, LedgerColumn column) const;
  /// A day; none where the cell is empty. Throws InputError for anything else.
  std::optional<Day> day(std::size_t row, LedgerColumn column) const;

  /// Changes a cell unless it says the same already.
  void set(std::size_t row, LedgerColumn column, const std::string& value);
  /// Writes a length or coordinate with so many digits after the point, or nothing.
  void set(std::size_t row, LedgerColumn column, std::optional<double> number, int digits);
  /// Writes a day in the form of the table's other days.
  void set(std::size_t row, LedgerColumn column, const Day& day);

  /// Adds an empty row with a key that no other row has, and returns its index.
  std::size_t add_row();

  /// The whole table.
  std::string text() const;

  const std::string& name() const { return name_; }

 private:
  /// A line: its cells with their quotes, as they were read.
  struct Line {
    std::vector<std::string> cells;
    std::string end;  ///< the line break, which the last line may lack
  };

  void parse(std::string_view text);
  void find_columns();
  void check_rows();
  void find_forms();
  [[noreturn]] void refuse(std::size_t row, LedgerColumn column, const std::string& why) const;
  const std::string* raw(std::size_t row, LedgerColumn column) const;
  std::string as_cell(const std::string& value) const;

  std::string name_;
  bool has_mark_ = false;  ///< whether it begins with a byte order mark
  char separator_ = ',';
  bool has_decimal_commas_ = false;
  DayForm form_ = DayForm::kIso;
  std::string line_end_ = "\n";
  std::vector<Line> lines_;                          ///< the header first; also empty lines
  std::array<std::size_t, kLedgerColumns> place_{};  ///< the cell of each column
  std::vector<std::size_t> rows_;                    ///< the line of each row
};

}  // namespace clearway
