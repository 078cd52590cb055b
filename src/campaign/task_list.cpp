#include "campaign/task_list.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/util/number_ranges.hpp"

namespace clearway::campaign {
namespace {

constexpr std::size_t kMostTasks = 10'000'000;

std::optional<std::size_t> task_number(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number < kMostTasks ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string task_list_text(const TaskList& tasks) {
  std::string text;
  for (const std::string& range : number_ranges(tasks)) text += (text.empty() ? "" : ",") + range;
  return text;
}

std::optional<TaskList> parse_task_list(const std::string& text) {
  TaskList tasks;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view part = std::string_view(text).substr(begin, comma - begin);
    const std::size_t dash = std::min(part.find('-'), part.size());
    const auto first = task_number(part.substr(0, dash));
    const auto last = dash < part.size() ? task_number(part.substr(dash + 1)) : first;
    if (!first || !last || *last < *first) return std::nullopt;
    for (std::size_t task = *first; task <= *last; ++task) tasks.push_back(task);
    begin = comma + 1;
  }
  std::ranges::sort(tasks);
  tasks.erase(std::unique(tasks.begin(), tasks.end()), tasks.end());
  return tasks;
}

}  // namespace clearway::campaign
