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
  MessageLog(const CallOptions& options, std::vector<Message>& warnings)
      : options_(options), warnings_(warnings) {}

  void note(std::string text) const {
    if (options_.message) options_.message({Message::Severity::kNote, {}, std::move(text)});
  }
  void warn(std::string code, std::string text) {
    warnings_.push_back({Message::Severity::kWarning, std::move(code), std::move(text)});
    if (options_.message) options_.message(warnings_.back());
  }

 private:
  const CallOptions& options_;
  std::vector<Message>& warnings_;
};

}  // namespace clearway
