#pragma once

#include <tuple>

#include "clearway/session.hpp"
#include "core/describe/search.hpp"

namespace clearway {

/// How one question of a session is asked.
inline constexpr std::tuple kQuestionFields{kEngine<QuestionOptions>, kStrict<QuestionOptions>,
                                            kModelIsCut<QuestionOptions>};

}  // namespace clearway
