#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// "1.5 GiB", for messages.
std::string format_size(std::uint64_t bytes);

/// "78,439", for messages.
std::string format_count(std::uint64_t count);

/// "1 point", "78,439 points". many: where it is not `one` with an s.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many = {});

/// The shortest decimal that reads back as the same number, without exponent from 1e-4 to 1e16.
std::string format_number(double value);

/// With four digits, for messages.
std::string format_brief(double value);

}  // namespace clearway
