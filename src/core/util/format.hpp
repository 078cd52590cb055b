#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// A number of bytes for messages, such as "1.5 GiB".
std::string format_size(std::uint64_t bytes);

/// A number for messages, such as "78,439".
std::string format_count(std::uint64_t count);

/// A number with its noun, such as "1 point" or "78,439 points". many: the plural, if it is not
/// `one` with an s.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many = {});

/// The shortest decimal that reads back as the same number; without an exponent from 1e-4 to 1e16.
std::string format_number(double value);

/// A number with four digits, for messages.
std::string format_brief(double value);

}  // namespace clearway
