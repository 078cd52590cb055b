#include "cli/vehicle/vehicle_inputs.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/models/vehicle_file.hpp"

namespace clearway::tool {

bool names_vehicle(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return false;
  const File input = File::open_regular(file);
  std::array<char, 256> piece{};
  while (const std::size_t bytes = input.read_some(std::as_writable_bytes(std::span(piece)))) {
    const std::string_view text(piece.data(), bytes);
    const std::size_t first = text.find_first_not_of(" \t\r\n\v\f");
    if (first != std::string_view::npos) return text[first] == '{';
  }
  return false;
}

std::vector<std::filesystem::path> vehicle_inputs(const std::filesystem::path& file,
                                                  std::vector<std::filesystem::path> others) {
  others.push_back(file);
  for (const BodyEntry& body : read_vehicle_file(file, 1)) {
    for (std::filesystem::path& one : body.files()) others.push_back(std::move(one));
  }
  return others;
}

void check_vehicle_search(const SearchOptions& options) {
  if (options.engine != Engine::kSweep) {
    throw UsageError(std::string("--vehicle: engine ") + clearway::name_of(options.engine) +
                         " searches one model, not a vehicle of several bodies",
                     Remedy::kSweepEngine);
  }
}

}  // namespace clearway::tool
