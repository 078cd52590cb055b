#include "cli/support/ignored_options.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>
#include <set>

#include "core/query/ignored_points.hpp"
#include "io/files/json.hpp"
#include "io/files/text_number.hpp"

namespace clearway::tool {
namespace {

constexpr std::uint64_t kGreatestClass = 255;

std::optional<std::uint64_t> parse_class(const std::string& text) {
  const auto number = parse_count(text);
  return number && *number <= kGreatestClass ? number : std::nullopt;
}

std::vector<std::string> words_of(const std::vector<std::string>& lists) {
  std::vector<std::string> words;
  for (const std::string& list : lists) {
    for (std::string& word : CLI::detail::split(list, ',')) words.push_back(std::move(word));
  }
  return words;
}

std::vector<std::uint8_t> parse_classes(const std::string& option,
                                        const std::vector<std::string>& lists) {
  std::set<std::uint8_t> classes;
  for (const std::string& word : words_of(lists)) {
    const std::size_t dash = std::min(word.find('-'), word.size());
    const auto first = parse_class(word.substr(0, dash));
    const auto last = dash < word.size() ? parse_class(word.substr(dash + 1)) : first;
    if (!first || !last || *last < *first) {
      throw CLI::ValidationError(option,
                                 "'" + word + "': expected numbers of classes from 0 to " +
                                     std::to_string(kGreatestClass) +
                                     ", for example 2,7 or 3-5; clearway info lists those of a "
                                     "store");
    }
    for (std::uint64_t i = *first; i <= *last; ++i) classes.insert(static_cast<std::uint8_t>(i));
  }
  return {classes.begin(), classes.end()};
}

Box parse_box(const std::string& option, const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    throw CLI::ValidationError(option, text + ": " + why);
  };
  std::vector<double> numbers;
  for (const std::string& field : CLI::detail::split(text, ',')) {
    const auto number = parse_whole_number(field);
    if (!number || !std::isfinite(*number)) refuse("'" + field + "' is no number");
    numbers.push_back(*number);
  }
  if (numbers.size() != 6) {
    refuse("expected six numbers with commas: least x, y and z, then greatest x, y and z");
  }
  const Box box{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
  for (int k = 0; k < 3; ++k) {
    if (box.lo[k] > box.hi[k]) {
      refuse("its corners are the wrong way round: expected the least x, y and z first");
    }
  }
  return box;
}

}  // namespace

CLI::Option* add_class_option(CLI::App& command, const std::string& name,
                              std::vector<std::uint8_t>& classes, const std::string& help) {
  return command
      .add_option_function<std::vector<std::string>>(
          name,
          [&classes, name](const std::vector<std::string>& lists) {
            classes = parse_classes(name, lists);
          },
          help)
      ->allow_extra_args(false)
      ->type_name("N,...");
}

CLI::Option* add_box_option(CLI::App& command, const std::string& name, std::vector<Box>& boxes,
                            const std::string& help) {
  return command
      .add_option_function<std::vector<std::string>>(
          name,
          [&boxes, name](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) boxes.push_back(parse_box(name, text));
          },
          help)
      ->allow_extra_args(false)
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
}

nlohmann::ordered_json ignored_json(const Answer& answer) {
  const QueryParameters& query = answer.parameters;
  const IgnoredPointCounts& counts = answer.ignored;
  nlohmann::ordered_json classes = nlohmann::ordered_json::array();
  nlohmann::ordered_json boxes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < query.ignore_classes.size(); ++i) {
    classes.push_back({{"class", query.ignore_classes[i]}, {"points", counts.of_classes[i]}});
  }
  for (std::size_t i = 0; i < query.ignore_boxes.size(); ++i) {
    const Box& box = query.ignore_boxes[i];
    boxes.push_back({{"lo", box.lo}, {"hi", box.hi}, {"points", counts.in_boxes[i]}});
  }
  return {{"points", counts.points},
          {"colliding", answer.ignored_colliding},
          {"classes", std::move(classes)},
          {"boxes", std::move(boxes)}};
}

}  // namespace clearway::tool
