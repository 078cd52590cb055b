#include <cmath>

#include "io/files/text_writer.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

namespace clearway {
using namespace test;
namespace {

TEST_CASE("a text becomes a cell of CSV that no spreadsheet runs as a formula", "[csv]") {
  check_equal(csv_cell("truck"), "truck");
  CHECK(csv_cell("").empty());
  check_equal(csv_cell("truck, \"long\"\n"), "\"truck, \"\"long\"\"\n\"");
  for (const char* formula :
       {"=1+1", "+1+1", "-1+1", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "-", "="}) {
    CAPTURE(formula);
    CHECK(csv_cell(formula) == "\"'" + std::string(formula) + "\"");
  }
  check_equal(csv_cell("=A1&\"x\""), "\"'=A1&\"\"x\"\"\"");
  for (const char* number : {"-12.5", "+3", "-1e-9", "12", "a=b", "1-2"}) {
    CHECK(csv_cell(number) == number);
  }
}

TEST_CASE("lengths for people are rounded to 0.1 mm, and up where less would not be enough") {
  CHECK(readable_length(0.46412) == 0.4641);
  CHECK(readable_length(0.46412, true) == 0.4642);
  CHECK(readable_length(0.4641, true) == 0.4641);  // which is no multiple of 0.1 mm in binary
  CHECK(readable_length(2.15 + 1e-13, true) == 2.15);
  CHECK(!std::signbit(readable_length(-0.00001)));
}

}  // namespace
}  // namespace clearway
