// What the checks of several bodies together tell about the vehicle.
#include "search/checks/query_warnings.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Message warned(const std::string& code, const std::string& text = "text",
               std::vector<PoseRange> stretches = {}) {
  return {Message::Severity::kWarning, code, text, {}, std::move(stretches)};
}

/// A warning about a stretch of the path, from one chainage to another.
Message on(const std::string& code, double from, double to, std::vector<PoseRange> stretches = {}) {
  Message message =
      warned(code, "from " + std::to_string(static_cast<int>(from)), std::move(stretches));
  message.numbers = {{"chainage_from", from}, {"chainage_to", to}};
  return message;
}

std::vector<Message> told(const std::vector<BodyMessages>& bodies) {
  std::vector<Message> out, warnings;
  const MessageCallback keep = [&](const Message& message) { out.push_back(message); };
  MessageLog log(keep, warnings);
  warn_of_bodies_once(bodies, log);
  return out;
}

/// Checks what the bodies' messages tell, each as its code and text.
void check_told(const std::vector<BodyMessages>& bodies, const std::vector<std::string>& expected,
                const Caller& caller = Caller::current()) {
  std::vector<std::string> found;
  for (const Message& message : told(bodies)) found.push_back(message.code + ": " + message.text);
  check_equal(found, expected, caller);
}

}  // namespace

TEST_CASE("a warning of one body names it, and what several are told alike is told once") {
  const Message same = warned("radius-size", "odd");
  check_told({{"a", {}}, {"b", {warned("model-size", "large")}}}, {"model-size: body b: large"});
  check_told({{"a", {same}}, {"b", {same}}, {"c", {same}}}, {"radius-size: each body: odd"});
  check_told({{"a", {same}}, {"b", {}}, {"c", {same, warned("radius-size", "other")}}},
             {"radius-size: bodies a, c: odd", "radius-size: body c: other"});
  const auto notes = told({{"a", {{Message::Severity::kNote, {}, "small"}}}});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].severity == Message::Severity::kNote);
  check_equal(notes[0].text, "body a: small");
}

TEST_CASE("the vehicle floats, or has nothing beside it, where all of its bodies do") {
  const auto codes = [](const std::vector<BodyMessages>& bodies) { return codes_of(told(bodies)); };
  const Message floats = warned("floats"), beside = warned("nothing-beside");
  check_equal(codes({{"roof", {floats}}, {"bogie", {}}}), "");
  check_equal(codes({{"roof", {floats}}, {"bogie", {floats}}}), "floats");
  // Nothing is expected beside a body that is above the ground.
  check_equal(codes({{"roof", {floats, beside}}, {"bogie", {floats, beside}}}), "floats");
  check_equal(codes({{"roof", {beside}}, {"bogie", {floats, beside}}}), "nothing-beside");
  const Message stretch = on("nothing-beside", 10, 40);
  check_equal(codes({{"roof", {stretch}}, {"bogie", {}}}), "");
  check_equal(codes({{"roof", {stretch}}, {"bogie", {on("nothing-beside", 12, 40)}}}),
              "nothing-beside");
}

TEST_CASE("a body that is nowhere near the scan does not hide what others lack") {
  check_told(
      {{"far", {warned("out-of-reach", "far away")}},
       {"near", {warned("nothing-below", "no ground")}},
       {"still", {warned("no-poses", "none")}}},
      {"out-of-reach: body far: far away",
       "nothing-below: the vehicle, as its body near: no ground", "no-poses: body still: none"});
}

TEST_CASE("a stretch without ground below one body is told, once, as the body with the longest") {
  for (const std::string code : {"nothing-below", "floats"}) {
    check_told({{"front", {on(code, 10, 16)}}, {"rear", {on(code, 11, 18)}}, {"roof", {}}},
               {code + ": the vehicle, as its body rear: from 11"});
  }
  // That a roof is above the ground everywhere does not hide what its bogie meets.
  check_told({{"roof", {warned("floats", "everywhere")}}, {"bogie", {on("floats", 10, 16)}}},
             {"floats: the vehicle, as its body bogie: from 10"});
}

TEST_CASE("a warning of the vehicle has the stretches of all of its bodies") {
  using Stretches = std::vector<PoseRange>;
  const std::string code = "nothing-below";
  const auto below = told({{"front", {on(code, 10, 16, {{100, 160}})}},
                           {"rear", {on(code, 3, 12, {{30, 120}, {300, 310}})}},
                           {"roof", {on(code, 50, 53, {{500, 530}})}}});
  REQUIRE(below.size() == 1);
  CHECK((below[0].stretches == Stretches{{30, 160}, {300, 310}, {500, 530}}));
  const auto steps = [](PoseRange at) { return warned("large-steps", "text", {at}); };
  const auto alike = told({{"a", {steps({7, 8})}}, {"b", {steps({3, 4})}}, {"c", {steps({4, 5})}}});
  REQUIRE(alike.size() == 1);
  CHECK((alike[0].stretches == Stretches{{3, 5}, {7, 8}}));
}
