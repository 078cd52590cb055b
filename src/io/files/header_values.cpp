#include "io/files/header_values.hpp"

#include <algorithm>

namespace clearway {

void keep_facts(HeaderValues& values, Message& warning) {
  values.add("code", warning.code);
  values.add("message", warning.text);
  values.add("numbers", warning.numbers);
  values.add_if(!warning.stretches.empty(), "stretches", warning.stretches);
  if (!values.reads()) return;
  warning.severity = Message::Severity::kWarning;
  const auto& stretches = warning.stretches;
  const auto is_back = [](const PoseRange& range) { return range.first > range.last; };
  const auto meet = [](const PoseRange& a, const PoseRange& b) { return b.first <= a.last; };
  if (std::ranges::any_of(stretches, is_back) ||
      std::ranges::adjacent_find(stretches, meet) != stretches.end()) {
    values.refuse_fact("stretches", "stretches of poses that ascend");
  }
}

}  // namespace clearway
