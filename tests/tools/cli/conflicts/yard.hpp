#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/cli/support/program.hpp"

namespace clearway::test {

/// A truck on a path along x, and a crane 10 m to its left that looks backwards. Ten points stand
/// 0.3 m to the right of each of them; the crane's right is the path's left.
struct Yard : Workplace {
  Yard() {
    std::string scan, box, path, crane;
    for (int i = 0; i < 10; ++i) {
      const std::string rest = " " + std::to_string(0.3 + i * 0.05) + "\n";
      scan += "5 -0.3" + rest + "8 10.3" + rest;
    }
    for (const char* x : {"-0.5", "0.5"}) {
      for (const char* y : {"-0.2", "0.2"}) {
        for (int k = 0; k <= 10; ++k) {
          box += std::string(x) + " " + y + " " + std::to_string(k * 0.1) + "\n";
        }
      }
    }
    for (int i = 0; i <= 100; ++i) {
      const std::string x = std::to_string(i * 0.1);
      path += "1 0 0 " + x + " 0 1 0 0 0 0 1 0\n";
      crane += "-1 0 0 " + x + " 0 -1 0 10 0 0 1 0\n";
    }
    put("scan.xyz", scan);
    put("box.xyz", box);
    put("path.txt", path);
    put("crane.txt", crane);
    put_vehicle("wagon.json", "crane");
    put_vehicle("other.json", "lift");
    require_success(run("convert scan.xyz -o site.h5"));
    search("out.h5", "--vehicle wagon.json");
    search("plain.h5", "--model box.xyz");
    put("box.off",
        "OFF\n8 6 0\n-.5 -.2 0\n.5 -.2 0\n.5 .2 0\n-.5 .2 0\n-.5 -.2 1\n.5 -.2 1\n.5 .2 1\n"
        "-.5 .2 1\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
    search("mesh.h5", "--model box.off");
  }

  void put_vehicle(const std::string& file, const std::string& second) const {
    put(file, R"({"bodies": [{"name": "truck", "model": "box.xyz"}, {"name": ")" + second +
                  R"(", "model": "box.xyz", "trajectory": "crane.txt"}]})");
  }
  void search(const std::string& result, const std::string& model) const {
    require_success(run(
        "run --env site.h5 --trajectory path.txt --radius 0.15 --first-pose --clearance 0.3 -o " +
        result + " " + model));
  }
  Outcome conflicts(const std::string& options, const std::string& result = "out.h5") const {
    return run("conflicts " + result + " --trajectory path.txt " + options);
  }
  nlohmann::json listed(const std::string& options) const {
    require_success(conflicts("--force -o listed.json " + options));
    return nlohmann::json::parse(bytes("listed.json"))["conflicts"];
  }
};

inline const Yard& yard() {
  static const Yard made;
  return made;
}

}  // namespace clearway::test
