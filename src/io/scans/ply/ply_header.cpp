#include "io/scans/ply/ply_header.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "io/files/text_number.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kLongestPlyHeader = std::uint64_t{1} << 20;  // bytes
constexpr std::size_t kLargestElement = std::size_t{1} << 16;        // bytes

/// The types by PlyType, with the name of 1994 and the later one.
constexpr struct {
  std::string_view name, later_name;
  std::size_t bytes;
} kTypes[] = {{"char", "int8", 1},     {"uchar", "uint8", 1},   {"short", "int16", 2},
              {"ushort", "uint16", 2}, {"int", "int32", 4},     {"uint", "uint32", 4},
              {"float", "float32", 4}, {"double", "float64", 8}};

std::optional<PlyType> type_named(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kTypes); ++i) {
    if (name == kTypes[i].name || name == kTypes[i].later_name) return static_cast<PlyType>(i);
  }
  return std::nullopt;
}

class PlyHeaderParser {
 public:
  explicit PlyHeaderParser(InputBuffer& input) : input_(input) {}

  PlyHeader parse() {
    if (next() != std::vector<std::string_view>{"ply"}) fail("expected `ply`");
    read_format();
    for (;;) {
      const auto words = next();
      if (is_remark(words)) continue;
      if (words[0] == "end_header" && words.size() == 1) break;
      if (words[0] == "element") {
        add_element(words);
      } else if (words[0] == "property") {
        add_property(words);
      } else {
        fail(excerpt(words[0]) + "; expected element, property, comment, obj_info or end_header");
      }
    }
    input_.end_text();
    check_elements();
    find_vertices();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  std::vector<std::string_view> next() {
    std::string_view line;
    if (input_.position() > kLongestPlyHeader)
      fail("header longer than 1 MiB; expected end_header");
    if (!input_.next_line(line) || !input_.line_terminated()) {
      refuse(input_.name(), "ends at byte {} within the header; expected {}", input_.position(),
             input_.line() <= 1 ? "`ply`" : "`end_header`");
    }
    std::vector<std::string_view> words;
    split_fields(line, ' ', words);
    return words;
  }

  /// Whether a line is a comment or remark, which describes no element. Takes the spacing and the
  /// unit from comments that give them, and the name of one that places the points, as 8i and MPEG
  /// write it.
  bool is_remark(const std::vector<std::string_view>& words) {
    if (words.empty() || words[0] == "obj_info") return true;
    if (words[0] != "comment") return false;
    if (words.size() > 2 && words[1].starts_with("frame_to_world_")) {
      const double still = words[1].ends_with("scale") ? 1 : 0;
      const bool moves = std::any_of(words.begin() + 2, words.end(), [still](auto word) {
        return parse_whole_number(word) != still;
      });
      if (moves) header_.unplaced = "its comment " + std::string(words[1]) + " is not applied";
    }
    if (words.size() == 5 && words[1] == "clearway" && words[2] == "model" &&
        words[3] == "spacing") {
      const std::optional<double> metres = parse_whole_number(words[4]);
      if (!metres || !(*metres > 0) || !std::isfinite(*metres)) {
        fail("comment of a model spacing of " + excerpt(words[4]) + "; expected metres above 0");
      }
      header_.model_spacing = *metres;
    }
    if (words.size() == 4 && words[1] == "clearway" && words[2] == "unit") {
      header_.unit = find_unit(words[3]);
      if (!header_.unit || header_.unit->environment == LengthUnit::kUnknown) {
        fail("comment of a unit " + excerpt(words[3]) + "; expected m, ft, ift or us-ft");
      }
    }
    return true;
  }

  void read_format() {
    auto words = next();
    while (is_remark(words)) words = next();
    if (words.size() == 3 && words[0] == "format" && words[2] == "1.0") {
      header_.format = words[1] == "binary_little_endian" ? PlyFormat::kLittleEndian
                       : words[1] == "binary_big_endian"  ? PlyFormat::kBigEndian
                                                          : PlyFormat::kAscii;
      if (header_.format != PlyFormat::kAscii || words[1] == "ascii") return;
    }
    fail(
        "expected `format ascii 1.0`, `format binary_little_endian 1.0` or "
        "`format binary_big_endian 1.0`");
  }

  void add_element(const std::vector<std::string_view>& words) {
    const auto count = words.size() == 3 ? parse_count(words[2]) : std::nullopt;
    if (!count) fail("expected `element NAME COUNT`");
    header_.elements.push_back({std::string(words[1]), *count, {}});
  }

  void add_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("a property before the first element");
    const bool list = words.size() > 1 && words[1] == "list";
    if (words.size() != (list ? 5u : 3u)) {
      fail("expected `property TYPE NAME` or `property list TYPE TYPE NAME`");
    }
    const auto type = type_named(words[list ? 3 : 1]);
    const auto count = list ? type_named(words[2]) : std::nullopt;
    if (!type || (list && !count)) {
      fail(
          "unknown type; expected char, uchar, short, ushort, int, uint, float, double or int8 to "
          "float64");
    }
    if (count == PlyType::kFloat32 || count == PlyType::kFloat64) {
      fail("a list counted by " + std::string(words[2]) + "; expected an integer type");
    }
    header_.elements.back().properties.push_back({std::string(words.back()), *type, count});
  }

  void check_elements() const {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty() && element.count > 0) {
        fail("element " + excerpt(element.name) + " has no property; expected one at least");
      }
      if (element.least_bytes() > kLargestElement) {
        fail("element " + excerpt(element.name) + " has " + std::to_string(element.least_bytes()) +
             " bytes; expected at most " + std::to_string(kLargestElement));
      }
      if (element.count >
          static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / kLargestElement) {
        fail("element " + excerpt(element.name) + " counts " + std::to_string(element.count) +
             "; expected a number that a file can hold");
      }
    }
  }

  /// The index of the only element or property of a name. what: the words for it.
  template <typename Named>
  std::size_t only(const std::vector<Named>& all, std::string_view name,
                   const std::string& what) const {
    const auto found = std::ranges::find(all, name, &Named::name);
    const auto count = std::ranges::count(all, name, &Named::name);
    if (count != 1) fail((count == 0 ? "no " : "more than one ") + what);
    return static_cast<std::size_t>(found - all.begin());
  }

  void find_vertices() {
    header_.vertex =
        only(header_.elements, "vertex", "element named vertex; expected one with x, y and z");
    const std::vector<PlyProperty>& properties = header_.vertices().properties;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, static_cast<char>('x' + axis));
      const std::string what = "property " + name + " of the element vertex; expected x, y and z";
      header_.coordinates[axis] = only(properties, name, what);
      if (properties[header_.coordinates[axis]].list_count) fail("a list as " + what);
    }
  }

  InputBuffer& input_;
  PlyHeader header_{};
};

}  // namespace

std::size_t size_bytes(PlyType type) { return kTypes[static_cast<std::size_t>(type)].bytes; }

std::optional<std::size_t> PlyElement::fixed_bytes() const {
  for (const PlyProperty& property : properties) {
    if (property.list_count) return std::nullopt;
  }
  return least_bytes();
}

std::size_t PlyElement::least_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += size_bytes(property.list_count.value_or(property.type));
  }
  return bytes;
}

PlyHeader read_ply_header(InputBuffer& input) { return PlyHeaderParser(input).parse(); }

}  // namespace clearway
