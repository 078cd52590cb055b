#pragma once

#include <tuple>

#include "clearway/smooth.hpp"
#include "core/describe/field.hpp"

namespace clearway {

/// How a path is smoothed.
inline constexpr std::tuple kSmoothFields{
    Field{.member = &SmoothParameters::within,
          .key = "within",
          .option = "--within",
          .group = OptionGroup::kInputs,
          .help = "The farthest that a model point may be from where the given path has it",
          .doc = "The farthest that a model point may be from where the given path has it.",
          .is_required = true},
    Field{.member = &SmoothParameters::step,
          .key = "step",
          .option = "--step",
          .group = OptionGroup::kPath,
          .help = "The most that a model point may move from one new pose to the next",
          .usual = "0.1 m",
          .doc = "The most that a model point may move from one new pose to the next; 0: 0.1."}};

}  // namespace clearway
