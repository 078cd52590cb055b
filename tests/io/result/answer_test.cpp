#include "io/result/answer.hpp"

#include <catch2/catch.hpp>
#include <utility>
#include <vector>

using namespace clearway;

TEST_CASE("a warning that is said twice names the stretches of both") {
  constexpr auto kWarning = Message::Severity::kWarning;
  const auto missing = [](std::vector<PoseRange> stretches) {
    return Message{kWarning, "nothing-below", "no ground", {}, std::move(stretches)};
  };
  std::vector<Message> warnings;
  add_warnings({missing({{0, 4}, {20, 25}}), {Message::Severity::kNote, "nothing-below", "note"}},
               warnings);
  add_warnings({missing({{3, 9}}), missing({})}, warnings);
  add_warnings({missing({{30, 31}})}, warnings);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].stretches == std::vector<PoseRange>{{0, 9}, {20, 25}, {30, 31}});
  // One about the whole path raises no doubt, and so does not stand for those about stretches.
  CHECK(warnings[1].stretches.empty());
}
