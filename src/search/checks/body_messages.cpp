#include "search/checks/body_messages.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "search/checks/told_stretches.hpp"

namespace clearway {
namespace {

/// Codes of warnings that concern the vehicle and not a single body: a roof is always above the
/// ground, and in a cutting a bogie has a wall on its own side only.
constexpr std::array<std::string_view, 4> kOfVehicle{"floats", "nothing-below", "nothing-beside",
                                                     "one-side"};

bool has(const BodyMessages& body, std::string_view code) {
  return std::ranges::any_of(body.messages, [&](const Message& m) { return m.code == code; });
}

bool is_of_vehicle(const Message& message) {
  return std::ranges::find(kOfVehicle, message.code) != kOfVehicle.end();
}

/// Whether every body that is near the scan has a warning with this code. For a body that is
/// nowhere near the scan, another warning says so.
bool holds_for_vehicle(const std::vector<BodyMessages>& bodies, std::string_view code) {
  return std::ranges::all_of(bodies, [&](const BodyMessages& body) {
    return has(body, code) || has(body, "out-of-reach") || has(body, "no-poses");
  });
}

/// Whether a warning about a stretch of the path matters for the vehicle. Ground that is missing
/// there is missing below every body, whereas beside a low body there may be walls that a high one
/// does not have.
bool stretch_matters(const std::vector<BodyMessages>& bodies, const Message& message) {
  return message.code == "nothing-below" || message.code == "floats" ||
         holds_for_vehicle(bodies, message.code);
}

/// Whether a warning about the whole path matters for the vehicle. A vehicle above the ground need
/// not have anything beside it.
bool path_matters(const std::vector<BodyMessages>& bodies, const Message& message) {
  return holds_for_vehicle(bodies, message.code) &&
         (message.code != "nothing-beside" || !holds_for_vehicle(bodies, "floats"));
}

/// The warning that the vehicle gets for one code: the one about its whole path, or else the one
/// about the longest stretch that a body names.
struct OfVehicle {
  const BodyMessages* body = nullptr;
  /// nullptr where the warning does not matter for the vehicle.
  const Message* message = nullptr;

  OfVehicle(const std::vector<BodyMessages>& bodies, std::string_view code) {
    for (const BodyMessages& candidate : bodies) {
      for (const Message& other : candidate.messages) {
        if (other.code != code || (message != nullptr && !is_better(other))) continue;
        body = &candidate;
        message = &other;
      }
    }
    const bool matters = is_of_stretch(*message) ? stretch_matters(bodies, *message)
                                                 : path_matters(bodies, *message);
    if (!matters) message = nullptr;
  }

 private:
  bool is_better(const Message& other) const { return told_length(other) > told_length(*message); }
};

void tell(Message message, const std::string& who, MessageLog& log) {
  message.text = who + ": " + message.text;
  log.add(std::move(message));
}

/// Adds a message once for all bodies that have the same one. `first` is the body that is being
/// told of; nothing is added where an earlier body has the message too.
void tell_alike(const std::vector<BodyMessages>& bodies, std::size_t first, const Message& message,
                MessageLog& log) {
  const auto is_same = [&](const Message& m) {
    return m.code == message.code && m.text == message.text;
  };
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (std::ranges::none_of(bodies[i].messages, is_same)) continue;
    if (i < first) return;  // the earlier body's message named them all
    names += (count == 0 ? "" : ", ") + bodies[i].name;
    ++count;
  }
  const bool all = count == bodies.size() && count > 1;
  tell(message, all ? "each body" : (count > 1 ? "bodies " : "body ") + names, log);
}

}  // namespace

void tell_of_bodies(const std::vector<BodyMessages>& bodies, MessageLog& log) {
  std::vector<std::string_view> told;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const Message& message : bodies[i].messages) {
      if (!is_of_vehicle(message)) {
        tell_alike(bodies, i, message, log);
      } else if (std::ranges::find(told, message.code) == told.end()) {
        told.push_back(message.code);
        const OfVehicle found(bodies, message.code);
        if (found.message == nullptr) continue;
        tell(*found.message, "the vehicle, as its body " + found.body->name, log);
      }
    }
  }
}

}  // namespace clearway
