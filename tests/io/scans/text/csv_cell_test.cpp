#include <catch2/catch.hpp>

#include "io/files/text_writer.hpp"
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

}  // namespace
}  // namespace clearway
