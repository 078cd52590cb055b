#include <catch2/catch.hpp>

#include "io/files/text_writer.hpp"

namespace clearway {
namespace {

TEST_CASE("a text becomes a cell of CSV that no spreadsheet runs as a formula", "[csv]") {
  CHECK(csv_cell("truck") == "truck");
  CHECK(csv_cell("").empty());
  CHECK(csv_cell("truck, \"long\"\n") == "\"truck, \"\"long\"\"\n\"");
  for (const char* formula :
       {"=1+1", "+1+1", "-1+1", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "-", "="}) {
    CAPTURE(formula);
    CHECK(csv_cell(formula) == "\"'" + std::string(formula) + "\"");
  }
  CHECK(csv_cell("=A1&\"x\"") == "\"'=A1&\"\"x\"\"\"");
  for (const char* number : {"-12.5", "+3", "-1e-9", "12", "a=b", "1-2"}) {
    CHECK(csv_cell(number) == number);
  }
}

}  // namespace
}  // namespace clearway
