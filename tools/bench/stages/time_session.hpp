#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace clearway::bench {

struct SessionTimes {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  double distance = 1;  ///< distance up to which the least distance of a pose is asked for; 0: not
  int threads = 0;      ///< threads of each question; 0: all cores
  int askers = 1;       ///< threads that ask at the same time
  std::uint64_t questions = 1000;
  std::string device = "auto";
  std::uint64_t device_memory_bytes = 0;  ///< as in SessionOptions
  bool one_run = false;  ///< whether the whole trajectory is searched too, in one question
  bool peer = false;     ///< whether nanoflann answers some of the questions, too
  std::uint64_t repeat_memory = 0;  ///< further questions, after which the memory is compared
};

/// Asks a session one pose after another, spread over the trajectory, for the colliding points and
/// the least distance. Returns the times of questions and their parts, which are means, and the
/// memory of the process.
nlohmann::ordered_json time_session(const SessionTimes& options);

}  // namespace clearway::bench
