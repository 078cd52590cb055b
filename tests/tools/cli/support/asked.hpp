#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "tools/cli/support/program.hpp"

namespace clearway::test {

/// A scene that is dense enough to cause no warnings, and its store.
class Scene {
 public:
  Scene(const std::string& kind, const std::string& sizes);
  /// The hall, made once for all tests of this program.
  static const Scene& hall();

  std::string store() const { return quoted(folder / "site.h5"); }
  /// A store in `to` of the points of the scan for which `keep` holds.
  std::string changed_store(const ScratchFolder& to,
                            const std::function<bool(const Vec3&)>& keep) const;

  /// A store in `to` of all points of the scan at the places where `move` puts them.
  std::string moved_store(const ScratchFolder& to,
                          const std::function<Vec3(const Vec3&)>& move) const;

  ScratchFolder folder;
  std::vector<Vec3> model;
  std::vector<Pose> poses;
};

/// The question of the hall, which tests spoil. It is asked with --strict, so that the program
/// refuses to search where it warns.
struct Asked {
  std::vector<Vec3> model = Scene::hall().model;
  std::vector<Pose> poses = Scene::hall().poses;
  std::string radius = "0.1";
  std::string options = "";

  void move_model(const std::function<Vec3(const Vec3&)>& change);
  void move_path(const std::function<Vec3(const Vec3&)>& change);
  void turn(const std::function<void(double*)>& change);

  Outcome ask(const std::string& environment) const;
  Outcome ask() const { return ask(Scene::hall().store()); }
};

/// The codes in the refusal of a strict call, such as "strict: 2 warnings (a, b), expected none".
std::string codes_of(const Outcome& outcome);

}  // namespace clearway::test
