#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"

namespace clearway {

/// Notes and warnings on a file that was read.
struct Remarks {
  std::vector<Message> remarks;

  void note(const char* code, std::string text,
            std::vector<std::pair<std::string, double>> numbers = {}) {
    remarks.push_back({Message::Severity::kNote, code, std::move(text), std::move(numbers)});
  }
  void warn(const char* code, std::string text,
            std::vector<std::pair<std::string, double>> numbers = {}) {
    remarks.push_back({Message::Severity::kWarning, code, std::move(text), std::move(numbers)});
  }
};

}  // namespace clearway
