// The library changes nothing that belongs to the program: HDF5's state, oneTBB's limits, signal
// handlers; and it prints nothing.
#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <iostream>
#include <locale>

#include "library/api_scene.hpp"
#include "support/catch.hpp"
#include "support/leaks_of_hdf5.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Called before any other call of HDF5, which other tests of this program make, because
/// HDF5 1.10.8 complains at its end of damaged files that it could not close.
const herr_t kNoHandlerAtExit = H5dont_atexit();

int printed_errors = 0;

herr_t print_error(hid_t, void*) {
  ++printed_errors;
  return 0;
}

/// State that belongs to the program and that a library may not change.
struct GlobalState {
  GlobalState() {
    H5Eget_auto2(H5E_DEFAULT, &print, &print_data);
    H5PLget_loading_state(&plugins);
    parallelism = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    constexpr std::array kSignals{SIGBUS, SIGSEGV, SIGINT, SIGTERM, SIGPIPE, SIGXFSZ};
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      struct sigaction action {};
      sigaction(kSignals[i], nullptr, &action);
      handlers[i] = action.sa_handler;
    }
    folder = std::filesystem::current_path();
    locale = std::locale().name() + setlocale(LC_ALL, nullptr);
  }
  friend bool operator==(const GlobalState&, const GlobalState&) = default;

  H5E_auto2_t print = nullptr;
  void* print_data = nullptr;
  unsigned plugins = 0;
  std::size_t parallelism = 0;
  std::array<sighandler_t, 6> handlers{};
  std::filesystem::path folder;
  std::string locale;
};

/// What a call prints to standard output and error.
template <typename Call>
std::string printed_by(const std::filesystem::path& file, const Call& call) {
  std::cout.flush();  // text of the test program itself
  const int into = ::open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  const std::array kept{::dup(1), ::dup(2)};
  for (const int stream : {1, 2}) ::dup2(into, stream);
  ::close(into);
  call();
  std::cout.flush();
  std::fflush(nullptr);
  for (std::size_t k = 0; k < 2; ++k) {
    ::dup2(kept[k], static_cast<int>(k) + 1);
    ::close(kept[k]);
  }
  return bytes_of(file);
}

/// Calls every function of the library, also in ways that fail.
void use_all(const ApiScene& scene) {
  const auto input = scene.folder / "wall.las", site = scene.folder / "site.h5",
             output = scene.folder / "out.h5", damaged = scene.folder / "damaged.h5";
  const int more = 8;  // threads, more than the caller lets oneTBB have
  convert({input}, site, {.cell_points = 64, .threads = more});
  CHECK_THROWS_AS(convert({input}, site), UsageError);
  const Store store(site);
  search(store, scene.query, output, {.threads = more, .shard = Shard{1, 2}, .overwrite = true});
  for (const Engine engine : {Engine::kSweep, Engine::kGrid, Engine::kKdtree}) {
    search(store, scene.query, output, {.engine = engine, .threads = more, .overwrite = true});
  }
  CHECK_THROWS_AS(search(store, scene.query, output), UsageError);
  CHECK(Result(output).xyz().size() == Result(output).size());
  CHECK_THROWS_AS(read_model_points(output), InputError);
  CHECK_THROWS_AS(read_trajectory(input), InputError);
  for (const auto& file : {site, output}) {
    const std::string bytes = bytes_of(file);
    for (const double share : {0.0, 0.003, 0.01, 0.9}) {
      std::string broken = bytes;
      for (std::size_t i = 0; i < 40; ++i) {
        broken[static_cast<std::size_t>(share * static_cast<double>(bytes.size())) + i] ^= 0x55;
      }
      put_bytes(damaged, broken);
      try {
        if (file == site) {
          search(Store(damaged), scene.query, output, {.overwrite = true});
        } else {
          Result(damaged).source();
        }
      } catch (const Error&) {
      }
    }
  }
  put_bytes(damaged, bytes_of(site));
  CHECK_THROWS_AS(Result(damaged), InputError);
}

}  // namespace

TEST_CASE("nothing global is changed for the caller, and nothing printed") {
  REQUIRE(kNoHandlerAtExit == 0);
  const LeaksOfHdf5 known_leaks;
  const ApiScene scene;
  H5E_auto2_t print = nullptr;
  void* print_data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &print_data);
  H5Eset_auto2(H5E_DEFAULT, print_error, &printed_errors);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 3);
  const GlobalState before;
  CHECK(printed_by(scene.folder / "printed.txt", [&] { use_all(scene); }) == "");
  CHECK((GlobalState() == before));
  CHECK(printed_errors == 0);
  H5Eset_auto2(H5E_DEFAULT, print, print_data);
}
