#pragma once

#include <fmt/format.h>

#include <string>

#include "core/describe/labels.hpp"

/// Labels of poses in words.
namespace clearway {

/// A label of a pose with its title and unit, such as "station 12.50 m".
inline std::string label_text(const PoseLabel<double>& label, double number) {
  if (label.has_scale_of_file) return fmt::format("{} {}", label.title, number);
  const char* const blank = symbol_of(label.unit).empty() ? "" : " ";
  return fmt::format("{} {:.2f}{}{}", label.title, number, blank, symbol_of(label.unit));
}

/// A label that is a text, such as a name.
inline std::string label_text(const PoseLabel<std::string>& label, const std::string& text) {
  return *label.title == '\0' ? text : fmt::format("{} {}", label.title, text);
}

}  // namespace clearway
