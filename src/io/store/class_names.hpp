#pragma once

#include <array>
#include <cstdint>

namespace clearway {

/// The ASPRS name of a class of points (LAS 1.4, point formats 6 to 10); "" for reserved and
/// user-defined classes.
constexpr const char* class_name(std::uint8_t value) {
  constexpr std::array kNames{"never classified",
                              "unclassified",
                              "ground",
                              "low vegetation",
                              "medium vegetation",
                              "high vegetation",
                              "building",
                              "low point (noise)",
                              "",
                              "water",
                              "rail",
                              "road surface",
                              "",
                              "wire, guard",
                              "wire, conductor",
                              "transmission tower",
                              "wire connector",
                              "bridge deck",
                              "high noise"};
  return value < kNames.size() ? kNames[value] : "";
}

}  // namespace clearway
