#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/report.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {

std::vector<NamedObstacle> read_obstacles(const std::filesystem::path& path) {
  constexpr std::size_t kMostObstacles = 1'000'000;
  constexpr const char* kExpected = "; expected the CSV file that clearway conflicts writes";
  constexpr std::string_view kCorners[] = {"lo_x", "lo_y", "lo_z", "hi_x", "hi_y", "hi_z"};
  TextTable table(InputBuffer::open_regular(path), ',');
  if (!table.next()) refuse(table.name(), std::string("is empty") + kExpected);
  table.take_header();
  const TextColumn id = table.needed("id", kExpected);
  std::array<TextColumn, 6> corners;
  for (std::size_t i = 0; i < 6; ++i) corners[i] = table.needed(kCorners[i], kExpected);
  const auto name = table.column("name");
  std::vector<NamedObstacle> out;
  while (table.next()) {
    table.take_row(kMostObstacles, "conflicts");
    NamedObstacle& obstacle = out.emplace_back();
    Box& box = obstacle.box;
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = table.number(corners[static_cast<std::size_t>(k)]);
      box.hi[k] = table.number(corners[static_cast<std::size_t>(k + 3)]);
      if (box.lo[k] > box.hi[k]) table.refuse_here("its box ends before it begins");
    }
    if (name) obstacle.name = table.text(*name);
    if (obstacle.name.empty()) obstacle.name = "conflict " + table.text(id);
  }
  return out;
}

}  // namespace clearway
