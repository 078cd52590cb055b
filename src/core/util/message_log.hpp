#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"

namespace clearway {

/// What a long operation tells its caller: notes at once, warnings at once and in the report.
/// Of one thread.
class MessageLog {
 public:
  /// Both outlive it.
  MessageLog(const MessageCallback& tell, std::vector<Message>& warnings)
      : callback_(tell), warnings_(warnings) {}

  void note(std::string text) const {
    if (callback_) callback_({Message::Severity::kNote, {}, std::move(text)});
  }
  void warn(std::string code, std::string text,
            std::vector<std::pair<std::string, double>> numbers = {}) {
    add({Message::Severity::kWarning, std::move(code), std::move(text), std::move(numbers)});
  }
  void add(Message message) {
    if (callback_) callback_(message);
    if (message.severity == Message::Severity::kWarning) warnings_.push_back(std::move(message));
  }

 private:
  const MessageCallback& callback_;
  std::vector<Message>& warnings_;
};

}  // namespace clearway
