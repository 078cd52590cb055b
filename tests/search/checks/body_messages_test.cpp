// What the checks of several bodies together tell about the vehicle.
#include "search/checks/query_warnings.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Message warned(const std::string& code, const std::string& text = "text") {
  return {Message::Severity::kWarning, code, text};
}

std::vector<Message> told(const std::vector<BodyMessages>& bodies) {
  std::vector<Message> out, warnings;
  const MessageCallback keep = [&](const Message& message) { out.push_back(message); };
  MessageLog log(keep, warnings);
  warn_of_bodies_once(bodies, log);
  return out;
}

std::vector<std::string> codes(const std::vector<Message>& messages) {
  std::vector<std::string> out;
  for (const Message& message : messages) out.push_back(message.code);
  return out;
}

}  // namespace

TEST_CASE("a warning of one body names it") {
  const auto found = told({{"a", {}}, {"b", {warned("model-size", "large")}}});
  REQUIRE(found.size() == 1);
  check_equal(found[0].code, "model-size");
  check_equal(found[0].text, "body b: large");
}

TEST_CASE("what several bodies are told alike is told once") {
  const Message same = warned("radius-size", "odd");
  auto found = told({{"a", {same}}, {"b", {same}}, {"c", {same}}});
  REQUIRE(found.size() == 1);
  check_equal(found[0].text, "each body: odd");
  found = told({{"a", {same}}, {"b", {}}, {"c", {same, warned("radius-size", "other")}}});
  REQUIRE(found.size() == 2);
  check_equal(found[0].text, "bodies a, c: odd");
  check_equal(found[1].text, "body c: other");
}

TEST_CASE("the vehicle floats where all of its bodies do") {
  const Message floats = warned("floats"), beside = warned("nothing-beside");
  CHECK(told({{"roof", {floats}}, {"bogie", {}}}).empty());
  CHECK(codes(told({{"roof", {floats}}, {"bogie", {floats}}})) ==
        std::vector<std::string>{"floats"});
  // Nothing is expected beside a body that is above the ground.
  CHECK(codes(told({{"roof", {floats, beside}}, {"bogie", {floats, beside}}})) ==
        std::vector<std::string>{"floats"});
  CHECK(codes(told({{"roof", {beside}}, {"bogie", {floats, beside}}})) ==
        std::vector<std::string>{"nothing-beside"});
}

TEST_CASE("a body that is nowhere near the scan does not hide what others lack") {
  const auto found = told({{"far", {warned("out-of-reach", "far away")}},
                           {"near", {warned("nothing-below", "no ground")}},
                           {"still", {warned("no-poses")}}});
  check_equal(codes(found), {"out-of-reach", "nothing-below", "no-poses"});
  check_equal(found[0].text, "body far: far away");
  check_equal(found[1].text, "the vehicle, as its body near: no ground");
}

namespace {

Message of_stretch(const std::string& code, double from, double to) {
  Message message = warned(code, "from " + std::to_string(static_cast<int>(from)));
  message.numbers = {{"chainage_from", from}, {"chainage_to", to}};
  return message;
}

}  // namespace

TEST_CASE("a stretch without ground below one body is told, once, as the body with the longest") {
  for (const std::string code : {"nothing-below", "floats"}) {
    CAPTURE(code);
    const auto found = told({{"front", {of_stretch(code, 10, 16)}},
                             {"rear", {of_stretch(code, 11, 18)}},
                             {"roof", {}}});
    REQUIRE(found.size() == 1);
    CHECK(found[0].code == code);
    check_equal(found[0].text, "the vehicle, as its body rear: from 11");
  }
  // That a roof is above the ground everywhere does not hide what its bogie meets.
  const auto found =
      told({{"roof", {warned("floats", "everywhere")}}, {"bogie", {of_stretch("floats", 10, 16)}}});
  REQUIRE(found.size() == 1);
  check_equal(found[0].text, "the vehicle, as its body bogie: from 10");
}

TEST_CASE("a warning of the vehicle has the stretches of all of its bodies") {
  const auto on = [](Message message, std::vector<PoseRange> stretches) {
    message.stretches = std::move(stretches);
    return message;
  };
  using Stretches = std::vector<PoseRange>;
  const auto below =
      told({{"front", {on(of_stretch("nothing-below", 10, 16), {{100, 160}})}},
            {"rear", {on(of_stretch("nothing-below", 3, 12), {{30, 120}, {300, 310}})}},
            {"roof", {on(of_stretch("nothing-below", 50, 53), {{500, 530}})}}});
  REQUIRE(below.size() == 1);
  CHECK((below[0].stretches == Stretches{{30, 160}, {300, 310}, {500, 530}}));
  const Message steps = warned("large-steps");
  const auto alike = told(
      {{"a", {on(steps, {{7, 8}})}}, {"b", {on(steps, {{3, 4}})}}, {"c", {on(steps, {{4, 5}})}}});
  REQUIRE(alike.size() == 1);
  CHECK((alike[0].stretches == Stretches{{3, 5}, {7, 8}}));
}

TEST_CASE("a stretch without walls is told where all bodies lack them") {
  const Message beside = of_stretch("nothing-beside", 10, 40);
  CHECK(told({{"roof", {beside}}, {"bogie", {}}}).empty());
  CHECK(codes(told({{"roof", {beside}}, {"bogie", {of_stretch("nothing-beside", 12, 40)}}})) ==
        std::vector<std::string>{"nothing-beside"});
}

TEST_CASE("notes of bodies stay notes") {
  const auto found = told({{"a", {{Message::Severity::kNote, {}, "small"}}}});
  REQUIRE(found.size() == 1);
  CHECK(found[0].severity == Message::Severity::kNote);
  check_equal(found[0].text, "body a: small");
}
