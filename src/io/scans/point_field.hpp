#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace clearway {

/// A number that each point of a written file has besides its coordinates.
struct PointField {
  /// kClass: the class of the point, for which LAS has a place.
  enum class Type { kUint32, kDouble, kUint64, kClass };

  std::string name;
  Type type = Type::kUint32;
  std::string description{};  ///< up to 31 characters, in formats that keep one
  /// The value of points that have none, for kDouble in formats that name one.
  std::optional<double> none{};

  std::size_t bytes() const { return type == Type::kUint32 ? 4 : type == Type::kClass ? 1 : 8; }
};

/// The values of a field for consecutive points.
using FieldValues = std::variant<std::span<const std::uint32_t>, std::span<const double>,
                                 std::span<const std::uint64_t>, std::span<const std::uint8_t>>;

/// Throws std::logic_error unless there are values of the right type for each field and point.
inline void check_fields(const std::vector<PointField>& fields, std::span<const FieldValues> values,
                         std::size_t points) {
  bool fit = fields.size() == values.size();
  for (std::size_t i = 0; fit && i < fields.size(); ++i) {
    fit = values[i].index() == static_cast<std::size_t>(fields[i].type) &&
          std::visit([](const auto& of_points) { return of_points.size(); }, values[i]) == points;
  }
  if (!fit) throw std::logic_error("the fields of the points do not match the header");
}

}  // namespace clearway
