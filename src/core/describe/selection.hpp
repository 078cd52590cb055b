#pragma once

#include <tuple>

#include "core/describe/field.hpp"

/// What questions of a run and of a section have in common: the parts of the environment that they
/// consider.
namespace clearway {

/// The points that are left out of the search.
template <typename Question>
inline constexpr std::tuple kIgnoredFields{
    Field{.member = &Question::ignore_classes,
          .key = "ignore_classes",
          .topic = "ignored classes",
          .option = "--ignore-class",
          .group = OptionGroup::kIgnored,
          .help = "Leave points of these classes out of the search, for example 2,7 or 3-5; the "
                  "store has to have classes",
          .doc = "The numbers of the classes whose points are left out of the search, such as [2] "
                 "for the ground."},
    Field{.member = &Question::ignore_boxes,
          .key = "ignore_boxes",
          .topic = "ignored boxes",
          .option = "--ignore-box",
          .group = OptionGroup::kIgnored,
          .help = "Leave points in this box out of the search: its least and its greatest x, y and "
                  "z, in the environment's coordinates; may be given several times",
          .doc = "The boxes whose points are left out of the search, in the environment's "
                 "coordinates: a list of Box."}};

template <typename Question>
inline constexpr Field kSeenCube{
    .member = &Question::seen_cube,
    .key = "seen_cube",
    .topic = "cube of seen space",
    .option = "--seen-cube",
    .group = OptionGroup::kCertainty,
    .help = "Side of the cubes in which seen space is judged, for example 0.1",
    .usual = "0.2 m",
    .doc = "Side of the cubes in which seen space is judged; metres; 0: 0.2 m."};

}  // namespace clearway
