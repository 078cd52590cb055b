#include "io/scans/ply/ply_body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text_copy.hpp"

namespace clearway {
namespace {

/// Calls use(number) with a zero of the C++ type for `type`.
template <typename Use>
auto with_type(PlyType type, Use use) {
  using Number = std::variant<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                              std::uint32_t, float, double>;
  constexpr Number kZeros[] = {std::int8_t{},  std::uint8_t{},  std::int16_t{}, std::uint16_t{},
                               std::int32_t{}, std::uint32_t{}, float{},        double{}};
  return std::visit(use, kZeros[static_cast<std::size_t>(type)]);
}

/// Decodes one coordinate of many vertices that lie `stride` bytes apart.
void decode_axis(const std::byte* bytes, std::size_t stride, PlyType type, bool swapped, int axis,
                 std::span<Vec3> out) {
  with_type(type, [&]<typename Number>(Number) {
    const auto decode = [&](auto load_one) {
      const std::byte* at = bytes;
      for (Vec3& point : out) {
        point[axis] = static_cast<double>(load_one(at));
        at += stride;
      }
    };
    if (swapped) {
      decode([](const std::byte* at) { return load_swapped<Number>(at); });
    } else {
      decode([](const std::byte* at) { return load<Number>(at); });
    }
  });
}

/// Parses the number at `at`, behind blanks; returns false where none stands alone there.
bool next_number(const char*& at, const char* end, double& value) {
  at = skip_blanks(at, end);
  return parse_number(at, end, value) && (at == end || is_blank(*at));
}

}  // namespace

PlyBody::PlyBody(InputBuffer file)
    : input_(std::move(file)),
      header_(read_ply_header(input_)),
      swapped_(header_.format == PlyFormat::kBigEndian) {
  if (is_text()) return;
  refuse_if_copied_as_text(input_);
  refuse_seven_bits(input_);
}

bool PlyBody::next_line() {
  std::string_view line;
  do {
    if (!input_.next_line(line)) return false;
    at_ = line.data();
    end_ = at_ + line.size();
  } while (skip_blanks(at_, end_) == end_);
  return true;
}

void PlyBody::refuse_cut() const {
  const bool text = is_text();
  refuse(input_.name(), (text ? "ends after line " + std::to_string(input_.line()) + " with "
                              : fmt::format("ends at byte {}, within ", input_.end_position())) +
                            std::to_string(row_) + " of element " + excerpt(element_->name) +
                            "; expected " + std::to_string(element_->count) + " of them");
}

void PlyBody::refuse_number(const std::string& what, std::size_t bytes) const {
  if (is_text()) refuse_line(input_.name(), input_.line(), what);
  refuse_byte(input_.name(), input_.position() - bytes, what);
}

void PlyBody::begin_row(const PlyElement& element, std::uint64_t row) {
  element_ = &element;
  row_ = row;
  start_.number = input_.position();
  if (is_text() && !next_line()) refuse_cut();
}

double PlyBody::next(PlyType type, const std::string& property) {
  if (is_text()) {
    double value = 0;
    if (next_number(at_, end_, value)) return value;
    refuse_number("expected a number for property " + excerpt(property), 0);
  }
  const auto bytes = input_.take(size_bytes(type));
  if (bytes.empty()) refuse_cut();
  return with_type(type, [&]<typename Number>(Number) {
    return static_cast<double>(swapped_ ? load_swapped<Number>(bytes.data())
                                        : load<Number>(bytes.data()));
  });
}

void PlyBody::skip_items(const PlyProperty& property, std::uint64_t count) {
  if (is_text()) {
    for (std::uint64_t i = 0; i < count; ++i) next(property.type, property.name);
  } else if (!input_.skip(count * size_bytes(property.type))) {
    refuse_cut();
  }
}

void PlyBody::read_row(const PlyElement& element, std::uint64_t row,
                       std::optional<std::size_t> list) {
  begin_row(element, row);
  numbers_.clear();
  items_.clear();
  for (const PlyProperty& property : element.properties) {
    const PlyType type = property.list_count.value_or(property.type);
    const double number = numbers_.emplace_back(next(type, property.name));
    if (!property.list_count) continue;
    if (!(number >= 0 && number <= 0xFFFFFFFFp0 && number == std::floor(number))) {
      refuse_number("a list of " + format_number(number) + " items; expected a whole number from 0",
                    size_bytes(type));
    }
    const auto count = static_cast<std::uint64_t>(number);
    if (list != numbers_.size() - 1) {
      skip_items(property, count);
      continue;
    }
    while (items_.size() < count) items_.push_back(next(property.type, property.name));
  }
  if (is_text() && skip_blanks(at_, end_) != end_) {
    refuse_number("more than the " + std::to_string(element.properties.size()) +
                      " properties of element " + excerpt(element.name) +
                      "; expected the end of the line",
                  0);
  }
}

void PlyBody::skip(const PlyElement& element) {
  const auto bytes = is_text() ? std::nullopt : element.fixed_bytes();
  const std::uint64_t start = input_.position();
  if (!bytes) {
    for (std::uint64_t row = 0; row < element.count; ++row) read_row(element, row);
  } else if (!input_.skip(*bytes * element.count)) {
    element_ = &element;
    row_ = (input_.end_position() - start) / *bytes;
    refuse_cut();
  }
}

Vec3 PlyBody::vertex() const {
  const auto& [x, y, z] = header_.coordinates;
  return {numbers_[x], numbers_[y], numbers_[z]};
}

bool PlyBody::parse_vertex(std::string_view line, Vec3& point) const {
  const std::vector<PlyProperty>& properties = vertices().properties;
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t i = 0; i < properties.size(); ++i) {
    double value = 0;
    if (properties[i].list_count || !next_number(at, end, value)) return false;
    for (int axis = 0; axis < 3; ++axis) {
      if (header_.coordinates[axis] == i) point[axis] = value;
    }
  }
  return skip_blanks(at, end) == end;
}

bool PlyBody::take_vertices(std::uint64_t first, std::uint64_t most, std::vector<Vec3>& out) {
  const auto stride = vertices().fixed_bytes();
  if (!stride) return false;
  const std::size_t count = std::min<std::uint64_t>(InputBuffer::kCapacity / *stride, most);
  const auto bytes = input_.take(count * *stride);
  element_ = &vertices();
  row_ = first;
  if (bytes.empty()) refuse_cut();
  out.resize(out.size() + count);
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t offset = 0;
    const std::size_t property = header_.coordinates[axis];
    for (std::size_t k = 0; k < property; ++k) offset += size_bytes(vertices().properties[k].type);
    decode_axis(bytes.data() + offset, *stride, vertices().properties[property].type, swapped_,
                axis, std::span(out).last(count));
  }
  return true;
}

void PlyBody::check_end() {
  constexpr const char* kMore = " more than the header declares; expected the file's end";
  if (is_text()) {
    if (next_line()) refuse_number(excerpt({at_, end_}) + " is" + kMore, 0);
    return;
  }
  const std::uint64_t end = input_.position(), more = *input_.size() - end;
  const auto bytes = more <= 2 ? input_.take(more) : std::span<const std::byte>();
  const auto is_break = [](std::byte b) { return b == std::byte{'\n'} || b == std::byte{'\r'}; };
  if (more == 0 || (!bytes.empty() && std::ranges::all_of(bytes, is_break))) return;
  refuse_byte(input_.name(), end, counted(more, "byte") + kMore);
}

}  // namespace clearway
