#include "core/query/verdict_words.hpp"

#include "core/util/format.hpp"

namespace clearway {

std::string verdict_words(Verdict verdict, bool has_warnings) {
  const bool is_warned_of = verdict == Verdict::kClear && has_warnings;
  return is_warned_of ? "clear with warnings" : name_of(verdict);
}

std::string reason_words(Reason reason, std::span<const std::string> doubts) {
  switch (reason) {
    case Reason::kNear:
      return "points are near";
    case Reason::kFew:
      return "too few points that are certainly too close hang together";
    case Reason::kErrorsExceedMargin:
      return "the errors exceed the margin";
    case Reason::kNotScanned:
      return "parts of the way were not scanned";
    case Reason::kQuestionInDoubt:
      break;
  }
  return "the question is in doubt (" + with_commas(doubts) + ")";
}

std::string doubt_words(std::span<const std::string> doubts) {
  return reason_words(Reason::kQuestionInDoubt, doubts) +
         ", so what stands in the way may not have been found";
}

}  // namespace clearway
