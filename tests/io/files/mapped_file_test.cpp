#include "io/files/mapped_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <memory>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scratch_folder.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a map shows the file's bytes") {
  const ScratchFolder folder;
  put_bytes(folder / "a", "abc");
  put_bytes(folder / "empty", "");
  const MappedFile map(folder / "a");
  REQUIRE(map.bytes().size() == 3);
  CHECK(map.bytes()[2] == std::byte{'c'});
  CHECK(MappedFile(folder / "empty").bytes().empty());
  CHECK_THROWS_AS(MappedFile(folder / "none"), ResourceError);
  CHECK_THROWS_AS(MappedFile(folder / ""), ResourceError);
}

TEST_CASE("a map that survives a file that shrinks has zeros there and says so") {
  const ScratchFolder folder;
  put_bytes(folder / "kept", std::string(100'000, 'x'));
  put_bytes(folder / "cut", std::string(100'000, 'x'));
  const MappedFile kept(folder / "kept"), cut(folder / "cut");
  kept.survive_faults();
  cut.survive_faults();
  CHECK(cut.bytes()[90'000] == std::byte{'x'});
  CHECK_FALSE(cut.failed());
  REQUIRE(::truncate((folder / "cut").c_str(), 10) == 0);
  CHECK(cut.bytes()[90'000] == std::byte{0});
  CHECK(cut.failed());
  CHECK(cut.bytes()[3] == std::byte{'x'});
  CHECK(kept.bytes()[90'000] == std::byte{'x'});
  CHECK_FALSE(kept.failed());
}

TEST_CASE("a fault is that of its own map, not of the one that lies before it in memory") {
  const ScratchFolder folder;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  for (const char* name : {"cut", "before"}) put_bytes(folder / name, std::string(4 * page, 'x'));
  // The first place in the list of maps is free again for the map that lies before the other.
  auto first = std::make_unique<MappedFile>(folder / "before");
  const MappedFile cut(folder / "cut");
  first.reset();
  std::vector<std::unique_ptr<MappedFile>> maps;
  const auto lies_before = [&] {
    return maps.back()->bytes().data() + maps.back()->bytes().size() == cut.bytes().data();
  };
  do {
    maps.push_back(std::make_unique<MappedFile>(folder / "before"));
  } while (!lies_before() && maps.size() < 16);
  REQUIRE(lies_before());
  cut.survive_faults();
  for (const auto& map : maps) map->survive_faults();
  REQUIRE(::truncate((folder / "cut").c_str(), 10) == 0);
  CHECK(cut.bytes()[page] == std::byte{0});
  CHECK(cut.failed());
  for (const auto& map : maps) CHECK_FALSE(map->failed());
}

TEST_CASE("a fault of a map ends the program with the file's name, and another one as before") {
  const ScratchFolder folder;
  const auto path = folder / "shrinking";
  put_bytes(path, std::string(100'000, 'x'));
  const auto end_of = [](const std::function<int()>& act) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(act());
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    return WEXITSTATUS(status);
  };
  check_equal(end_of([&] {
                ::dup2(::creat((folder / "said").c_str(), 0600), STDERR_FILENO);
                install_map_fault_handler(4);
                const MappedFile map(path);
                if (::truncate(path.c_str(), 10) != 0) return 99;
                const volatile std::byte lost = map.bytes()[90'000];
                return lost == std::byte{0} ? 98 : 97;
              }),
              4);
  check_says(bytes_of(folder / "said"), path.string() + " ... shrank");
  check_equal(end_of([&] {
                ::signal(SIGBUS, [](int) { ::_exit(42); });
                const MappedFile map(path);
                map.survive_faults();
                ::raise(SIGBUS);
                return 98;
              }),
              42);
}
