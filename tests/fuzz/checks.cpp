// The checks of tests/support for programs without Catch: a check that fails ends the program.
#include <cstdio>
#include <cstdlib>

#include "support/compare.hpp"

namespace clearway::test {

void fail_check(const std::string& text, const Caller& caller) {
  std::fprintf(stderr, "%s:%u: %s\n", caller.file_name(), caller.line(), text.c_str());
  std::abort();
}

template <>
void check_equal(const std::vector<std::string>& found,
                 const std::type_identity_t<std::vector<std::string>>& expected,
                 const Caller& caller) {
  if (found != expected) fail_check("found another list than expected", caller);
}

}  // namespace clearway::test
