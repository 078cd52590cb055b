#include "search/checks/warning_stretches.hpp"

#include <algorithm>
#include <optional>

#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "search/checks/question.hpp"

namespace clearway {

WarningStretches::WarningStretches(const Question& question, const PathLooks& looks,
                                   const std::vector<LookRun>& runs)
    : longest(*std::ranges::max_element(runs, {},
                                        [&](const LookRun& run) { return looks.length(run); })) {
  const Look &first = looks.all()[longest.first], &last = looks.all()[longest.last];
  const double from = question.chainage(first.pose), to = question.chainage(last.pose);
  double sum = 0;
  for (const LookRun& run : runs) {
    sum += looks.length(run);
    stretches.push_back({question.number_of(looks.all()[run.first].pose),
                         question.number_of(looks.all()[run.last].pose)});
  }
  where = "between pose " + std::to_string(question.number_of(first.pose)) + " and pose " +
          std::to_string(question.number_of(last.pose)) + " (" + question.length(from) + " to " +
          question.length(to) + " along the path)";
  if (runs.size() > 1) {
    others = ". The same holds for " +
             counted(runs.size() - 1, "other stretch", "other stretches") + ", " +
             question.length(sum - looks.length(longest)) + " long in all";
  }
  numbers = {{"first_pose", static_cast<double>(question.number_of(first.pose))},
             {"last_pose", static_cast<double>(question.number_of(last.pose))},
             {"chainage_from", from},
             {"chainage_to", to},
             {"stretches", static_cast<double>(runs.size())},
             {"length", sum},
             {"share", sum / looks.all().back().along}};
}

std::optional<double> number_in(const Message& message, std::string_view name) {
  const auto found =
      std::ranges::find(message.numbers, name, [](const auto& n) { return n.first; });
  return found == message.numbers.end() ? std::nullopt : std::optional(found->second);
}

bool is_of_stretch(const Message& message) {
  return number_in(message, "chainage_from").has_value();
}

double length_of_stretch(const Message& message) {
  return number_in(message, "chainage_to").value_or(0) -
         number_in(message, "chainage_from").value_or(0);
}

}  // namespace clearway
