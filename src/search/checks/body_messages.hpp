#pragma once

#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "core/util/message_log.hpp"

namespace clearway {

/// What the checks found about one body of a vehicle.
struct BodyMessages {
  std::string name;
  std::vector<Message> messages;
};

/// Tells what was found, with the names of the bodies: what several have in common once. That the
/// ground, or what is beside the way, is missing holds for the vehicle where it holds for all of
/// its bodies that the scan covers; otherwise it is not told.
void tell_of_bodies(const std::vector<BodyMessages>& bodies, MessageLog& log);

}  // namespace clearway
