#include "core/messages/messages.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "clearway/error.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kMostOfACode = 3;

}  // namespace

Message note(NoteCode code, std::string text, MessageNumbers numbers) {
  return {Message::Severity::kNote, std::string(code.view()), std::move(text), std::move(numbers)};
}

Message warning(WarningCode code, std::string text, MessageNumbers numbers,
                std::vector<PoseRange> stretches) {
  return {Message::Severity::kWarning, std::string(code.view()), std::move(text),
          std::move(numbers), std::move(stretches)};
}

Message warning_or_note(bool warns, EitherCode code, std::string text, MessageNumbers numbers,
                        std::vector<PoseRange> stretches) {
  return {warns ? Message::Severity::kWarning : Message::Severity::kNote, std::string(code.view()),
          std::move(text), std::move(numbers), std::move(stretches)};
}

Message plain_note(std::string text, MessageNumbers numbers) {
  return {Message::Severity::kNote, {}, std::move(text), std::move(numbers)};
}

void refuse_warnings(const std::vector<Message>& warnings) {
  std::size_t count = 0;
  std::vector<std::string> codes;
  for (const Message& warning : warnings) {
    if (warning.code.starts_with(kStorePrefix)) continue;
    ++count;
    if (std::find(codes.begin(), codes.end(), warning.code) == codes.end()) {
      codes.push_back(warning.code);
    }
  }
  if (count == 0) return;
  std::string text =
      "strict: " + std::to_string(count) + (count == 1 ? " warning (" : " warnings (");
  for (const std::string& code : codes) text += (&code == codes.data() ? "" : ", ") + code;
  throw InputError(text + "), expected none; no output was written");
}

void shorten_notes(std::vector<Message>& messages) {
  std::map<std::string, std::uint64_t> counts;
  std::erase_if(messages, [&](const Message& message) {
    return message.severity == Message::Severity::kNote && ++counts[message.code] > kMostOfACode;
  });
  for (const auto& [code, count] : counts) {
    if (count <= kMostOfACode) continue;
    const std::uint64_t more = count - kMostOfACode;
    Message rest = plain_note(format_count(more) + " more notes like these (" + code + ")",
                              {{"more", static_cast<double>(more)}});
    rest.code = code;
    messages.push_back(std::move(rest));
  }
}

bool may_miss(std::string_view code) {
  const MessageEffect effect = effect_of(code);
  return effect.doubt != Doubt::kNone || effect.missing != Missing::kNothing;
}

bool have_same_fault(const Message& a, const Message& b) {
  const auto side = [](const Message& message) {
    const auto found = std::ranges::find(message.numbers, "side",
                                         [](const auto& n) { return std::string_view(n.first); });
    return found == message.numbers.end() ? 0 : found->second;
  };
  return a.code == b.code && side(a) == side(b);
}

}  // namespace clearway
