#include "clearway/options.hpp"

#include <cstdio>

namespace clearway::tool {
namespace {

/// Unsigned numbers would wrap round.
std::string refuse_minus(const std::string& size) {
  return size.find('-') == std::string::npos ? "" : size + " is not a size";
}

}  // namespace

void add_memory_option(CLI::App& command, std::uint64_t& bytes) {
  command.add_option("--memory", bytes, "Bound of the working memory, for example 512M or 4G")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->transform(CLI::Validator(refuse_minus, ""))  // runs first
      ->default_str(format_size(bytes));
}

void add_threads_option(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
}

std::string format_size(std::uint64_t bytes) {
  const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto value = static_cast<double>(bytes);
  int unit = 0;
  for (; value >= 1024 && unit < 4; ++unit) value /= 1024;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

std::string format_count(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) {
    at -= 3;
    text.insert(at, 1, ',');
  }
  return text;
}

}  // namespace clearway::tool
