#pragma once

#include <nlohmann/json.hpp>

namespace clearway::bench {

/// Processor, cores, memory, GPUs and system of this machine.
nlohmann::ordered_json machine_description();

/// Version and commit of this program, how it was built, compiler and libraries.
nlohmann::ordered_json program_description();

}  // namespace clearway::bench
