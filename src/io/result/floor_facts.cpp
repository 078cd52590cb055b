#include "io/result/floor_facts.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/util/format.hpp"

namespace clearway {
namespace {

/// "front 0.3 m, rear none"; of many bodies "0.2 m to 0.4 m" and how many have none.
std::string body_heights(const Json& bodies, const std::string& unit) {
  constexpr std::size_t kMostNamed = 6;
  const auto words = [&](double height) { return format_brief(height) + " " + unit; };
  std::string text;
  std::vector<double> known;
  for (const auto& [name, height] : bodies.items()) {
    text += (text.empty() ? "" : ", ") + name + " ";
    text += height.is_null() ? "none" : words(height.get<double>());
    if (!height.is_null()) known.push_back(height.get<double>());
  }
  if (bodies.size() <= kMostNamed) return text;
  const auto [least, greatest] = std::ranges::minmax(known);
  const std::size_t without = bodies.size() - known.size();
  text = words(least) + (greatest > least ? " to " + words(greatest) : "");
  return without == 0 ? text : text + ", " + counted(without, "body", "bodies") + " without";
}

/// The height that all bodies share, or that of the only model; null where they differ.
Json shared_height(const Json& floor) {
  const Json bodies = floor.value("bodies", Json::object());
  if (bodies.empty()) return floor.at("height");
  const Json first = bodies.front();
  return std::ranges::count(bodies, first) == std::ssize(bodies) ? first : Json();
}

}  // namespace

Json floor_json(const Answer& answer) {
  if (!answer.floor_colliding) return nullptr;
  Json out{{"height", or_null(answer.parameters.floor)}, {"colliding", *answer.floor_colliding}};
  if (answer.budget) out["lowered_by"] = answer.budget->clear();
  for (std::size_t i = 0; i < answer.body_floors.size(); ++i) {
    out["bodies"][answer.bodies[i]] = or_null(answer.body_floors[i]);
  }
  return out;
}

std::string floor_words(const Json& floor, const std::string& unit) {
  const double lower = floor.value("lowered_by", 0.0);
  const Json height = shared_height(floor);
  if (height.is_null()) {
    return "the floors of the vehicle's bodies (" + body_heights(floor.at("bodies"), unit) +
           (lower > 0 ? "; with the errors " + format_brief(lower) + " " + unit + " lower" : "") +
           ")";
  }
  const std::string text = format_brief(height.get<double>()) + " " + unit + " of the vehicle";
  if (!(lower > 0)) return text;
  return text + " (" + format_brief(height.get<double>() - lower) + " " + unit +
         " with the errors)";
}

}  // namespace clearway
