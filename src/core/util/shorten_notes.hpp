#pragma once

#include <vector>

#include "clearway/progress.hpp"

namespace clearway {

/// Keeps the first three notes of each code, and appends how many more there were. Warnings stay.
void shorten_notes(std::vector<Message>& messages);

}  // namespace clearway
