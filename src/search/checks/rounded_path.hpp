#pragma once

#include "core/messages/messages.hpp"
#include "search/checks/question.hpp"

namespace clearway {

/// Warns where all positions of the path are multiples of a step that is coarser than the radius,
/// although the poses are mostly closer together than that: "lost-digits".
void warn_of_rounded_path(const Question& question, MessageLog& log);

}  // namespace clearway
