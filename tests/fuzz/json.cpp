// Any bytes as the JSON files that people write. The first byte chooses a vehicle's file, a
// campaign's, or any value, which has to be what the JSON library reads.
#include "io/files/json.hpp"

#include <cstdlib>

#include "campaign/campaign_file.hpp"
#include "io/models/vehicle_file.hpp"
#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Checks that the JSON library takes what parse_json() takes, with the same value, and that what
/// parse_json() refuses alone is nested too deep or has a key twice.
void compare_with_library(const std::string& text) {
  using nlohmann::ordered_json;
  try {
    const ordered_json read = parse_json(text);
    if (!ordered_json::accept(text)) std::abort();
    if (read != ordered_json::parse(text)) std::abort();
  } catch (const JsonError& error) {
    const std::string what = error.what();
    if (what.starts_with("is no JSON") && ordered_json::accept(text)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 3 == 0) {
    compare_with_library(text);
    return 0;
  }
  const MemoryFile input({data + 1, size - 1});
  may_refuse([&] {
    if (data[0] % 3 == 1) {
      for (const BodyEntry& entry : read_vehicle_file(input.path(), 0.3048)) {
        if (entry.name.empty()) std::abort();
      }
    } else if (text.find('/') == std::string::npos) {  // patterns with a slash would search folders
      const campaign::Campaign read = campaign::read_campaign(input.path());
      if (read.radii.size() != read.radius_names.size() || read.routes.empty()) std::abort();
    }
  });
  return 0;
}
