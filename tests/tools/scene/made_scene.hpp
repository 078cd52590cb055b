#pragma once

#include <charconv>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/predicate.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "io/files/file.hpp"
#include "scene/scene.hpp"
#include "scene/write.hpp"

namespace clearway::test {

using Bytes = std::vector<std::byte>;

template <typename Value>
Value value_at(const Bytes& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <typename Write>
Bytes written(Write&& write) {
  const File file = File::create_temporary(std::filesystem::temp_directory_path());
  write(file);
  Bytes out(file.size_bytes());
  file.read_at(0, out);
  return out;
}

inline Bytes environment_bytes(const scene::Scene& made, std::uint64_t seed, int threads) {
  return written([&](const File& file) {
    NoProgress progress;
    scene::write_environment(made, seed, file, threads, progress);
  });
}

inline Bytes model_bytes(const scene::Scene& made) {
  return written([&](const File& file) { scene::write_model(made, file); });
}

inline Bytes trajectory_bytes(const scene::Scene& made) {
  return written([&](const File& file) { scene::write_trajectory(made, file); });
}

/// The positions of a LAS 1.2 file with point format 0.
inline std::vector<Vec3> las_positions(const Bytes& bytes) {
  Quantisation quantisation{};
  for (std::size_t k = 0; k < 3; ++k) {
    quantisation.scale[k] = value_at<double>(bytes, 131 + 8 * k);
    quantisation.offset[k] = value_at<double>(bytes, 155 + 8 * k);
  }
  std::vector<Vec3> out(value_at<std::uint32_t>(bytes, 107));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t at = 227 + 20 * i;
    out[i] = position(quantisation, value_at<std::int32_t>(bytes, at),
                      value_at<std::int32_t>(bytes, at + 4), value_at<std::int32_t>(bytes, at + 8));
  }
  return out;
}

/// The positions, as float, behind the header of a binary PLY.
inline std::vector<Vec3> ply_positions(const Bytes& bytes) {
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string end = "end_header\n";
  std::vector<Vec3> out;
  for (std::size_t at = text.find(end) + end.size(); at < bytes.size(); at += 12) {
    out.push_back({value_at<float>(bytes, at), value_at<float>(bytes, at + 4),
                   value_at<float>(bytes, at + 8)});
  }
  return out;
}

inline std::vector<Pose> text_poses(const Bytes& bytes) {
  std::vector<Pose> out;
  const char* at = reinterpret_cast<const char*>(bytes.data());
  const char* const end = at + bytes.size();
  while (at < end) {
    Pose pose{};
    for (int i = 0; i < 12; ++i) {
      double value = 0;
      at = std::from_chars(at, end, value).ptr + 1;
      if (i % 4 < 3)
        pose.rotation[3 * (i / 4) + i % 4] = value;
      else
        pose.translation[i / 4] = value;
    }
    out.push_back(pose);
  }
  return out;
}

struct MadeScene {
  std::vector<Vec3> environment, model;
  std::vector<Pose> poses;
};

/// A scene as its files describe it.
inline MadeScene made_scene(scene::Kind kind, const scene::Sizes& sizes, std::uint64_t seed = 1) {
  const auto made = scene::make_scene(kind, sizes, seed);
  return {las_positions(environment_bytes(*made, seed, 2)), ply_positions(model_bytes(*made)),
          text_poses(trajectory_bytes(*made))};
}

}  // namespace clearway::test
