#include <map>

#include "bench/experiments/bench.hpp"

namespace clearway::bench {

scene::Sizes scene_size(const std::string& name, const std::string& size) {
  static const std::map<std::string, scene::Sizes> kSmall{{"mine", {4'000'000, 10'000, 1'800}},
                                                          {"hall", {1'110'000, 20'000, 1'700}},
                                                          {"plant", {2'000'000, 40'000, 8'000}},
                                                          {"tunnel", {500'000, 5'000, 1'900}}};
  if (size == "smoke") return {20'000, 500, 100};
  if (size == "small") return kSmall.at(name);
  if (size == "equality") return {1'000'000, 20'000, 4'000};
  scene::Sizes sizes = scene::full_sizes(scene::kind_named(name));
  if (size == "tenth") sizes.points /= 10;
  if (size == "hard") sizes.points = 1'000'000;
  return sizes;
}

}  // namespace clearway::bench
