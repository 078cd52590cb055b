#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "core/messages/message_table.hpp"

namespace clearway {

using MessageNumbers = std::vector<std::pair<std::string, double>>;

Message note(NoteCode code, std::string text, MessageNumbers numbers = {});
Message warning(WarningCode code, std::string text, MessageNumbers numbers = {},
                std::vector<PoseRange> stretches = {});
/// A warning if `warns`, otherwise a note.
Message warning_or_note(bool warns, EitherCode code, std::string text, MessageNumbers numbers = {},
                        std::vector<PoseRange> stretches = {});
/// A note without a code, which says what an input contains or how it was read.
Message plain_note(std::string text, MessageNumbers numbers = {});

/// Passes on the messages of a long operation: notes at once, warnings at once and in the
/// report. For one thread.
class MessageLog {
 public:
  /// Callback and warnings must outlive this object.
  MessageLog(const MessageCallback& callback, std::vector<Message>& warnings)
      : callback_(callback), warnings_(warnings) {}
  MessageLog(MessageCallback&& callback, std::vector<Message>& warnings) = delete;

  void note(std::string text) const {
    if (callback_) callback_(plain_note(std::move(text)));
  }
  void warn(WarningCode code, std::string text, MessageNumbers numbers = {},
            std::vector<PoseRange> stretches = {}) {
    add(warning(code, std::move(text), std::move(numbers), std::move(stretches)));
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
/// there. To be called when all warnings have been reported and nothing has been published.
void refuse_warnings(const std::vector<Message>& warnings);

/// Keeps the first three notes of each code, and appends how many more there were. Warnings stay.
void shorten_notes(std::vector<Message>& messages);

/// Whether a search that gave a warning with this code may have missed points: they may be missing
/// from the scan, or the model may not have been where they are. So what an earlier search found
/// there may be there still. Every doubt is such a code, and every code that lacks_points().
bool may_miss(std::string_view code);

/// Whether two warnings name the same fault, wherever on the path it is: they have the same code
/// and, where they are about one side of the path, the same side.
bool have_same_fault(const Message& a, const Message& b);

}  // namespace clearway
