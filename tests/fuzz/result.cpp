// Any bytes, read as a result.
#include "io/result/result.hpp"

#include "io/result/check_results.hpp"
#include "memory_file.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile input({data, size});
  may_refuse([&] {
    NoProgress progress;
    verify_result(ResultReader(input.path()), progress);
  });
  return 0;
}
