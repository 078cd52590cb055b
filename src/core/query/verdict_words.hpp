#pragma once

#include <span>
#include <string>

#include "clearway/answer.hpp"

/// The words for a verdict that terminal, pages and campaigns share.
namespace clearway {

/// "clear", "clear with warnings", "conflict", "undecided" or "unknown".
std::string verdict_words(Verdict verdict, bool has_warnings);

/// Why an answer is undecided, as a clause, such as "points are near". doubts: the codes of the
/// warnings that put the question in doubt, which the clause about it names.
std::string reason_words(Reason reason, std::span<const std::string> doubts);

/// What a question in doubt means for an answer that found nothing, with the codes: "the question
/// is in doubt (model-unit), so what stands in the way may not have been found".
std::string doubt_words(std::span<const std::string> doubts);

}  // namespace clearway
