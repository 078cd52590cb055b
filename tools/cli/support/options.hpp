#pragma once

#include <cstdint>
#include <string>

#include "clearway/model.hpp"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace clearway::tool {

class LengthOptions;

/// Accepts a finite length above 0 and turns it into metres. For Option::transform.
CLI::Validator positive_length();

/// Accepts a number of seconds from 0 to `most`.
CLI::Validator seconds_up_to(double most);

/// Adds an option that takes a size in bytes; "512M" and "4G" are multiples of powers of 1024.
void add_size_option(CLI::App& command, const std::string& name, std::uint64_t& bytes,
                     const std::string& description);

/// Adds an option that takes a whole number from `least` to `most`.
void add_count_option(CLI::App& command, const std::string& name, std::uint64_t& count,
                      std::uint64_t least, std::uint64_t most, const std::string& description);

/// Adds --memory, in bytes.
void add_memory_option(CLI::App& command, std::uint64_t& bytes);

/// Adds --threads; 0 stands for all cores.
void add_threads_option(CLI::App& command, int& threads);

/// Adds --model-unit under all of `names`.
void add_model_unit(CLI::App& command, const std::string& names, FileUnit& unit);

/// Adds --model-spacing, --model-unit, --model-vertices and --model-above.
void add_model_options(CLI::App& command, ModelOptions& options, LengthOptions& lengths);

/// The bytes of "512M", "1.5G", "4GiB" or "300000000". Throws CLI::ValidationError naming the
/// option.
std::uint64_t parse_size(const std::string& option, const std::string& text);

}  // namespace clearway::tool
