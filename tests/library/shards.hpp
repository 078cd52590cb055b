#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "library/api_scene.hpp"
#include "support/catch.hpp"

namespace clearway::test {

/// Searches of the whole query and of its shards, all with the same options, and merges of the
/// parts.
struct Shards {
  explicit Shards(SearchOptions with = {}) : options(std::move(with)) {
    options.threads = 2;
    options.overwrite = true;
    options.device = Device::kCpu;
    Query& query = scene.query;
    query.poses[50].translation[1] = 0.5;  // away from the wall, so that some poses meet nothing
  }

  /// The bytes of the result of the whole search.
  std::string whole() {
    options.shard.reset();
    search(Store(scene.folder / store), scene.query, scene.folder / "whole.h5", options);
    return bytes_of(scene.folder / "whole.h5");
  }

  std::vector<std::filesystem::path> parts(std::uint32_t count, const std::string& name = "part") {
    std::vector<std::filesystem::path> out;
    for (std::uint32_t number = 1; number <= count; ++number) {
      options.shard = Shard{number, count};
      out.push_back(scene.folder / (name + std::to_string(number) + ".h5"));
      search(Store(scene.folder / store), scene.query, out.back(), options);
    }
    return out;
  }

  std::string merged(const std::vector<std::filesystem::path>& parts,
                     const MergeOptions& how = {.overwrite = true}) {
    report = merge(parts, scene.folder / "merged.h5", how);
    return bytes_of(scene.folder / "merged.h5");
  }

  /// The message with which merging is refused; empty where it is not.
  std::string refusal(const std::vector<std::filesystem::path>& parts,
                      const MergeOptions& how = {}) const {
    try {
      merge(parts, scene.folder / "merged.h5", how);
    } catch (const InputError& error) {
      CHECK(!std::filesystem::exists(scene.folder / "merged.h5"));
      CHECK(!std::filesystem::exists(scene.folder / "merged.h5.partial"));
      return error.what();
    }
    return {};
  }

  ApiScene scene;
  std::string store = "wall.h5";
  MergeReport report;
  SearchOptions options;
};

}  // namespace clearway::test
