#include "core/messages/messages.hpp"

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

namespace clearway {
using namespace test;
TEST_CASE("a strict call refuses warnings and names their codes") {
  CHECK_NOTHROW(refuse_warnings({}));
  CHECK_THROWS_AS(refuse_warnings({warning("feet", "text")}), InputError);
  CHECK_THROWS_WITH(refuse_warnings({warning("feet", "text")}),
                    "strict: 1 warning (feet), expected none; no output was written");
  CHECK_THROWS_WITH(
      refuse_warnings({warning("same-scan", "a"), warning("feet", "b"), warning("same-scan", "c")}),
      "strict: 3 warnings (same-scan, feet), expected none; no output was written");
}

TEST_CASE("a log tells notes and warnings, and keeps warnings") {
  std::vector<Message> told, kept;
  const MessageCallback tell = [&told](const Message& message) { told.push_back(message); };
  MessageLog log(tell, kept);
  log.note("a note");
  log.warn("feet", "a warning", {{"points", 3}});
  REQUIRE(told.size() == 2);
  REQUIRE(kept.size() == 1);
  check_equal(kept[0].code, "feet");
  CHECK(kept[0].numbers == std::vector<std::pair<std::string, double>>{{"points", 3}});
}

}  // namespace clearway
