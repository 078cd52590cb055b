#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/ply/ply_header.hpp"

namespace clearway {

/// The rows of a PLY file of any format, which are read one after the other. All functions throw
/// InputError, with line or byte, for what is malformed, cut or missing.
class PlyBody {
 public:
  /// Reads the header. Binary data that a program copied as text are refused.
  explicit PlyBody(InputBuffer file);

  const PlyHeader& header() const { return header_; }
  const PlyElement& vertices() const { return header_.vertices(); }
  InputBuffer& input() { return input_; }
  bool is_text() const { return header_.format == PlyFormat::kAscii; }

  /// Moves to a row of an element, the next one in the file; a text's next line that is not blank.
  void begin_row(const PlyElement& element, std::uint64_t row);
  /// Reads a row. list: the property whose items are kept; those of other lists are passed over.
  void read_row(const PlyElement& element, std::uint64_t row, std::optional<std::size_t> list = {});
  /// Passes over all rows of an element.
  void skip(const PlyElement& element);

  /// The row that was read: the number of each property, which is the number of items for a list,
  /// and the items that are kept.
  const std::vector<double>& numbers() const { return numbers_; }
  const std::vector<double>& items() const { return items_; }
  /// The coordinates in a row of vertices.
  Vec3 vertex() const;
  /// Where the row begins.
  FilePlace row_place() const { return is_text() ? FilePlace{"line", input_.line()} : start_; }
  /// Whether the row is a text without a line break, and the byte that ends it.
  bool ends_open() const { return is_text() && !input_.line_terminated(); }
  char last_char() const { return end_[-1]; }

  /// Parses a vertex without lists in a line; returns false for any other line.
  bool parse_vertex(std::string_view line, Vec3& point) const;
  /// Appends the next vertices of a binary file, from number `first` on, as many of at most `most`
  /// as the input holds at once. Returns false where lists make their sizes vary.
  bool take_vertices(std::uint64_t first, std::uint64_t most, std::vector<Vec3>& out);

  /// Refuses what follows the last row. A line break there is accepted.
  void check_end();

 private:
  double next(PlyType type, const std::string& property);
  void skip_items(const PlyProperty& property, std::uint64_t count);
  [[noreturn]] void refuse_cut() const;
  [[noreturn]] void refuse_number(const std::string& what, std::size_t bytes) const;
  bool next_line();

  InputBuffer input_;
  PlyHeader header_;
  bool swapped_;
  const PlyElement* element_ = nullptr;  ///< of the row
  std::uint64_t row_ = 0;
  FilePlace start_{"byte", 0};  ///< of a binary row
  const char* at_ = nullptr;    ///< within a row of text
  const char* end_ = nullptr;
  std::vector<double> numbers_, items_;
};

}  // namespace clearway
