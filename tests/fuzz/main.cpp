// A program of several fuzz targets, with a name for each of them.
#include "fuzz.hpp"

using namespace clearway::test;

namespace {

void (*target)(Bytes) = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char*** argv) {
  const std::string name = std::filesystem::path((*argv)[0]).filename().string().substr(5);
  target = targets().at(name);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target({data, size});
  return 0;
}
