#include "io/scans/pcd/pcd_header.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <utility>

#include "io/files/bytes.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kLongestPcdHeader = std::uint64_t{1} << 20;  // bytes
constexpr std::uint64_t kLargestPoint = std::uint64_t{1} << 16;      // bytes
constexpr std::uint64_t kMostOfAnAxis = 0xFFFFFFFF;                  // greatest WIDTH and HEIGHT

class PcdHeaderParser {
 public:
  explicit PcdHeaderParser(InputBuffer& input) : input_(input) {}

  PcdHeader parse() {
    input_.begin_text();
    do {
      next();
    } while (read_entry());
    input_.end_text();
    check_fields();
    check_counts();
    find_coordinates();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  /// Reads the words of the next line that is neither blank nor a comment.
  void next() {
    do {
      std::string_view line;
      if (input_.position() > kLongestPcdHeader) fail("header longer than 1 MiB; expected DATA");
      if (!input_.next_line(line) || !input_.line_terminated()) {
        refuse(input_.name(), "ends at byte " + std::to_string(input_.position()) +
                                  " within the header; expected a line that starts with DATA");
      }
      split_fields(line, ' ', words_);
    } while (words_.empty() || words_[0].starts_with('#'));
  }

  /// Reads an entry of the header; returns false for the last one.
  bool read_entry() {
    const std::string_view key = words_[0];
    const std::size_t values = words_.size() - 1;
    if (key == "FIELDS" || key == "COLUMNS") {
      read_names();
    } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
      if (values != header_.fields.size()) {
        fail(std::to_string(values) + " values of " + std::string(key) + "; expected " +
             std::to_string(header_.fields.size()) + ", one for each of FIELDS");
      }
      for (std::size_t i = 0; i < values; ++i) read_trait(key, words_[i + 1], header_.fields[i]);
    } else if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
      if (values != 1) fail("expected one number behind " + std::string(key));
      (key == "WIDTH" ? width_ : key == "HEIGHT" ? height_ : points_) = whole(words_[1]);
    } else if (key == "VIEWPOINT") {
      read_viewpoint();
    } else if (key == "DATA") {
      read_data();
      return false;
    } else if (key != "VERSION") {
      fail(excerpt(key) +
           "; expected VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or "
           "DATA");
    }
    return true;
  }

  std::uint64_t whole(std::string_view word) const {
    const auto value = parse_count(word);
    if (!value) fail(excerpt(word) + "; expected a whole number from 0");
    return *value;
  }

  void read_names() {
    if (!header_.fields.empty()) fail("FIELDS for a second time");
    for (std::size_t i = 1; i < words_.size(); ++i) {
      header_.fields.push_back({.name = std::string(words_[i])});
    }
  }

  void read_trait(std::string_view key, std::string_view word, PcdField& field) const {
    if (key == "TYPE") {
      if (word != "I" && word != "U" && word != "F") fail(excerpt(word) + "; expected I, U or F");
      field.type = word[0];
      return;
    }
    const std::uint64_t value = whole(word);
    if (key == "COUNT") {
      if (value > kLargestPoint) fail(fmt::format("COUNT {}; expected at most 65536", value));
      field.count = value;
    } else if (value == 1 || value == 2 || value == 4 || value == 8) {
      field.size = value;
    } else {
      fail("SIZE " + std::to_string(value) + "; expected 1, 2, 4 or 8 bytes");
    }
  }

  void read_viewpoint() {
    std::array<double, 7> numbers{};
    bool valid = words_.size() == 1 + numbers.size();
    for (std::size_t i = 0; valid && i < numbers.size(); ++i) {
      const auto number = parse_whole_number(words_[i + 1]);
      valid = number && std::isfinite(*number);
      if (valid) numbers[i] = *number;
    }
    if (!valid) fail("expected VIEWPOINT and seven numbers, x y z and a quaternion w x y z");
    header_.viewpoint = numbers;
  }

  void read_data() {
    const std::string_view kind = words_.size() == 2 ? words_[1] : std::string_view();
    if (kind == "ascii") {
      header_.data = PcdData::kAscii;
    } else if (kind == "binary") {
      header_.data = PcdData::kBinary;
    } else if (kind == "binary_compressed") {
      header_.data = PcdData::kCompressed;
    } else {
      fail("expected DATA ascii, DATA binary or DATA binary_compressed");
    }
  }

  void check_fields() const {
    if (header_.fields.empty()) fail("no FIELDS before DATA; expected their names");
    std::uint64_t bytes = 0;
    for (const PcdField& field : header_.fields) {
      if (field.type == 'F' && field.size < 4 && !field.padding()) {
        fail("field " + excerpt(field.name) + " is a number of " + std::to_string(field.size) +
             " bytes with TYPE F; expected 4 or 8");
      }
      bytes += field.bytes();
      if (bytes > kLargestPoint) fail("a point of more than 65536 bytes");
    }
  }

  /// Takes the number of points from POINTS or from WIDTH times HEIGHT, which must agree where both
  /// are given.
  void check_counts() {
    if (!points_ && !width_) fail("neither POINTS nor WIDTH before DATA");
    if (height_ && !width_) fail("HEIGHT without WIDTH");
    const std::uint64_t width = width_.value_or(points_.value_or(0));
    header_.height = height_.value_or(1);
    if (width > kMostOfAnAxis || header_.height > kMostOfAnAxis) {
      fail("WIDTH or HEIGHT above 4294967295");
    }
    header_.points = points_.value_or(width * header_.height);
    if (header_.points != width * header_.height) {
      fail("POINTS " + std::to_string(header_.points) + "; expected WIDTH times HEIGHT, " +
           std::to_string(width * header_.height));
    }
  }

  /// Finds the fields x, y and z, or those in capitals where no field has the small letter.
  void find_coordinates() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, static_cast<char>('x' + axis));
      auto found = find_only([&](const PcdField& f) { return f.name == name; });
      if (!found) found = find_only([&](const PcdField& f) { return lower_case(f.name) == name; });
      if (!found || header_.fields[*found].count == 0) {
        fail("expected one of FIELDS to be named " + name + ", with an element at least");
      }
      header_.coordinates[axis] = *found;
    }
  }

  template <typename Is>
  std::optional<std::size_t> find_only(Is is) const {
    const auto& fields = header_.fields;
    if (std::count_if(fields.begin(), fields.end(), is) != 1) return std::nullopt;
    return static_cast<std::size_t>(std::find_if(fields.begin(), fields.end(), is) -
                                    fields.begin());
  }

  InputBuffer& input_;
  std::vector<std::string_view> words_;
  PcdHeader header_;
  std::optional<std::uint64_t> width_, height_, points_;
};

template <typename Number>
double load_double(const std::byte* bytes) {
  return static_cast<double>(load<Number>(bytes));
}

}  // namespace

std::uint64_t PcdHeader::point_bytes(bool with_padding) const {
  std::uint64_t bytes = 0;
  for (const PcdField& field : fields) {
    if (with_padding || !field.padding()) bytes += field.bytes();
  }
  return bytes;
}

PcdHeader read_pcd_header(InputBuffer& input) { return PcdHeaderParser(input).parse(); }

PcdLoad load_of(const PcdField& field) {
  constexpr PcdLoad kLoads[][3] = {
      {load_double<std::int8_t>, load_double<std::uint8_t>, load_double<std::uint8_t>},
      {load_double<std::int16_t>, load_double<std::uint16_t>, load_double<std::uint16_t>},
      {load_double<std::int32_t>, load_double<std::uint32_t>, load_double<float>},
      {load_double<std::int64_t>, load_double<std::uint64_t>, load_double<double>}};
  return kLoads[std::bit_width(field.size) - 1][field.type == 'I' ? 0 : field.type == 'U' ? 1 : 2];
}

}  // namespace clearway
