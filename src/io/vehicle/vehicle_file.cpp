#include "io/vehicle/vehicle_file.hpp"

#include <algorithm>
#include <set>

#include "clearway/body.hpp"
#include "io/formats/length_unit.hpp"
#include "io/formats/text/length_text.hpp"
#include "io/system/file_text.hpp"

namespace clearway {
namespace {

/// The length at a key: a number, or a text with a unit such as "10m".
double length_at(const KeyReader& key, double environment_unit) {
  const auto& value = key.value();
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) key.refuse(R"(expected a length, for example 10.5 or "10.5m")");
  if (const auto length = length_of(key.text())) return length->in_units_of(environment_unit);
  key.refuse("is \"" + key.text() + R"(", expected a length, for example 10.5 or "10.5m")");
}

BodyMount pivots_of(const KeyReader& key, double environment_unit) {
  const std::vector<KeyReader> both = key.elements();
  if (both.size() != 2) {
    key.refuse("expected two lengths, the front pivot and the rear one, for example [10, -10]");
  }
  const BodyPivots pivots{length_at(both[0], environment_unit),
                          length_at(both[1], environment_unit)};
  if (pivots.front == pivots.rear) key.refuse("expected two different places");
  return pivots;
}

FileUnit unit_of(const KeyReader& key) {
  const std::string name = key.text();
  if (const auto unit = file_unit_of(name)) return *unit;
  key.refuse("is \"" + name + "\", expected " + file_unit_list());
}

std::string name_of(const KeyReader& key, std::set<std::string>& names) {
  std::string name = key.text();
  const bool control = std::ranges::any_of(
      name, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; });
  if (control || name.size() > kMostNameBytes) {
    key.refuse("expected at most 100 bytes without control characters");
  }
  if (!names.insert(name).second) key.refuse("\"" + name + "\" names another body too");
  return name;
}

void set_motion(const KeyReader& body, const std::filesystem::path& folder, double environment_unit,
                BodyEntry& entry) {
  const bool has_at = body.has("at"), has_pivots = body.has("pivots");
  if (has_at + has_pivots + body.has("trajectory") > 1) {
    body.refuse("a body moves in one way: expected one of at, pivots and trajectory, or none");
  }
  if (has_at) entry.mount = BodyStation{length_at(body.at("at"), environment_unit)};
  if (has_pivots) entry.mount = pivots_of(body.at("pivots"), environment_unit);
  if (body.has("trajectory")) entry.trajectory = folder / body.at("trajectory").text();
}

}  // namespace

std::vector<BodyEntry> read_vehicle_file(const std::filesystem::path& path,
                                         double environment_unit) {
  const KeyReader file = KeyReader::parse(path, text_of_file(path));
  file.allow({"bodies"});
  const std::vector<KeyReader> bodies = file.at("bodies").elements(kMostBodies);
  std::vector<BodyEntry> entries;
  std::set<std::string> names;
  const std::filesystem::path folder = path.parent_path();
  for (const KeyReader& body : bodies) {
    body.allow({"name", "model", "model_unit", "at", "pivots", "trajectory"});
    BodyEntry entry{.at = body,
                    .name = name_of(body.at("name"), names),
                    .model = folder / body.at("model").text(),
                    .trajectory = {}};
    if (body.has("model_unit")) entry.model_unit = unit_of(body.at("model_unit"));
    set_motion(body, folder, environment_unit, entry);
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace clearway
