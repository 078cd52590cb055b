#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// Passes on what a long operation tells its caller: notes at once, warnings at once and in the
/// report. For one thread.
class MessageLog {
 public:
  /// Tell and warnings must outlive this object.
  MessageLog(const MessageCallback& tell, std::vector<Message>& warnings)
      : callback_(tell), warnings_(warnings) {}

  void note(std::string text) const {
    if (callback_) callback_({Message::Severity::kNote, {}, std::move(text)});
  }
  void warn(std::string code, std::string text,
            std::vector<std::pair<std::string, double>> numbers = {},
            std::vector<PoseRange> stretches = {}) {
    add({Message::Severity::kWarning, std::move(code), std::move(text), std::move(numbers),
         std::move(stretches)});
  }
  void add(Message message) {
    if (callback_) callback_(message);
    if (message.severity == Message::Severity::kWarning) warnings_.push_back(std::move(message));
  }

 private:
  const MessageCallback& callback_;
  std::vector<Message>& warnings_;
};

/// Throws InputError for a strict call that has warnings, with their number and their codes, each
/// code once, in the order of the warnings; does nothing if there are none. Warnings that a store
/// repeats from its conversion ("store-...") do not count, because its strictness was decided
/// there. To be called when all warnings have been told and nothing has been published.
inline void refuse_warnings(const std::vector<Message>& warnings) {
  std::size_t count = 0;
  std::vector<std::string> codes;
  for (const Message& warning : warnings) {
    if (warning.code.starts_with("store-")) continue;
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

/// Keeps the first three notes of each code, and appends how many more there were. Warnings stay.
void shorten_notes(std::vector<Message>& messages);

}  // namespace clearway
