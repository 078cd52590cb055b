// Any bytes, read as a store.
#include "read_store.hpp"

using namespace clearway;
using namespace clearway::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile input({data, size});
  may_refuse([&] { read_store(input.path()); });
  return 0;
}
