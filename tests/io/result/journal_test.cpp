#include "io/result/journal.hpp"

#include <algorithm>
#include <thread>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const JournalIdentity kIdentity{{"model", "00ff"}, {"radius", "0.1"}};
constexpr double kNever = 1e9;  // seconds

/// A record's payload: its number, and a text whose length and letter follow from that.
JournalRecord record_of(std::uint64_t number) {
  JournalRecord record;
  record.put_count(number);
  record.put_text(std::string(number % 40, static_cast<char>('a' + number % 26)));
  return record;
}

/// The numbers of the journal's records, after a check of each payload.
std::vector<std::uint64_t> numbers_in(const JournalReader& journal) {
  std::vector<std::uint64_t> numbers;
  journal.for_each([&numbers](JournalPayload payload) {
    const std::uint64_t number = payload.take_count();
    CHECK(payload.take_text() == std::string(number % 40, static_cast<char>('a' + number % 26)));
    CHECK(payload.at_end());
    numbers.push_back(number);
  });
  return numbers;
}

std::vector<std::uint64_t> first_numbers(std::uint64_t count) {
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t i = 0; i < count; ++i) numbers.push_back(i);
  return numbers;
}

/// Writes records 0 .. records - 1, and syncs after each of the first `synced`.
void write_journal(const std::filesystem::path& path, std::uint64_t records, std::uint64_t synced) {
  JournalWriter writer = JournalWriter::create(path, kIdentity, kNever);
  for (std::uint64_t i = 0; i < records; ++i) {
    JournalRecord record = record_of(i);
    writer.append(record);
    if (i < synced) writer.sync();
  }
}

}  // namespace

TEST_CASE("a journal gives back what was appended") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  write_journal(path, 100, 3);
  const JournalReader journal(path);
  CHECK(journal.identity() == kIdentity);
  check_equal(journal.records(), 100);
  CHECK(journal.torn().empty());
  CHECK(journal.whole_bytes() == std::filesystem::file_size(path));
  CHECK(numbers_in(journal) == first_numbers(100));
}

TEST_CASE("a journal cut at any byte gives the records before, and goes on from them") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  write_journal(path, 12, 4);
  const std::string whole = bytes_of(path);
  std::uint64_t most = 0;
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    put_bytes(path, whole.substr(0, bytes));
    const JournalReader journal(path);
    const std::uint64_t records = journal.records();
    CHECK(records >= most);
    CHECK(records < 12);
    most = std::max(most, records);
    CHECK(numbers_in(journal) == first_numbers(records));
    if (!journal.identity()) continue;
    CHECK(journal.identity() == kIdentity);
    CHECK(journal.torn().empty() == (journal.whole_bytes() == bytes));
    {
      JournalWriter writer = JournalWriter::resume(path, journal, kNever);
      for (std::uint64_t i = records; i < 12; ++i) {
        JournalRecord record = record_of(i);
        writer.append(record);
      }
    }
    CHECK(numbers_in(JournalReader(path)) == first_numbers(12));
  }
  check_equal(most, 11);
}

TEST_CASE("a byte flipped before what is known to be on the disk is refused and named") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  write_journal(path, 12, 11);
  const std::string whole = bytes_of(path);
  const std::size_t last = whole.size() - 32 - 1 - 1 - 11;  // the record that says what is synced
  for (std::size_t at = 0; at < last; ++at) {
    for (const int bit : {0, 3, 7}) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ 1 << bit);
      put_bytes(path, bytes);
      CAPTURE(at, bit);
      CHECK_THROWS_AS(JournalReader(path), InputError);
    }
  }
  std::string bytes = whole;
  bytes[last - 1] = static_cast<char>(bytes[last - 1] ^ 1);
  put_bytes(path, bytes);
  check_refused([&] { return JournalReader(path); }, "a.journal: record 11 at byte");
}

TEST_CASE("a byte flipped after that leaves the records before it") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  write_journal(path, 12, 0);
  const std::string whole = bytes_of(path);
  for (std::size_t at = 16; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    put_bytes(path, bytes);
    const JournalReader journal(path);
    CAPTURE(at);
    CHECK(journal.records() < 12);
    CHECK(journal.whole_bytes() <= at);
    CHECK_FALSE(journal.torn().empty());
    CHECK(numbers_in(journal) == first_numbers(journal.records()));
  }
}

TEST_CASE("what is no journal, or one of another version, is refused") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  put_bytes(path, "a journal of another program");
  CHECK_FALSE(is_journal(path));
  CHECK_THROWS_AS(JournalReader(path), InputError);
  put_bytes(path, "CLWYJRN");
  CHECK(is_journal(path));
  CHECK_FALSE(JournalReader(path).identity());
  put_bytes(path, "CLWYJRX");
  CHECK_THROWS_AS(JournalReader(path), InputError);
  put_bytes(path, std::string("CLWYJRNL\1\0\0\0\0\0\0\0", 16));
  check_refused([&] { return JournalReader(path); }, "journal of version 1 of another release");
  put_bytes(path, std::string("CLWYJRNL\2\0\0\0\0\0\0\1", 16));
  CHECK_THROWS_AS(JournalReader(path), InputError);
  put_bytes(path, "");
  CHECK_FALSE(is_journal(path));
  CHECK_FALSE(JournalReader(path).identity());
  CHECK_FALSE(is_journal(folder / "nothing"));
}

TEST_CASE("a journal is created only where no file is, and not through a link") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  put_bytes(folder / "precious", "precious");
  std::filesystem::create_symlink("precious", path);
  CHECK_THROWS_AS(JournalWriter::create(path, kIdentity, kNever), ResourceError);
  check_equal(bytes_of(folder / "precious"), "precious");
}

TEST_CASE("a payload is not read past its end") {
  const auto payload = [](const std::string& bytes) {
    return JournalPayload(std::as_bytes(std::span(bytes)), "here");
  };
  const std::string nine(9, '\xff'), ten(10, '\xff');
  CHECK_THROWS_AS(payload("").take_count(), InputError);
  CHECK_THROWS_AS(payload("\x80").take_count(), InputError);
  CHECK_THROWS_AS(payload("abc").take<std::uint32_t>(), InputError);
  const std::string long_text =
      "\x05"
      "abcd";
  check_refused([&] { return payload(long_text).take_text(); }, "here");
  CHECK_THROWS_AS(payload(ten).take_count(), InputError);
  const std::string most = nine + '\1', too_much = nine + '\2';
  CHECK(payload(most).take_count() == ~std::uint64_t{0});
  CHECK_THROWS_AS(payload(too_much).take_count(), InputError);
}

TEST_CASE("several threads append whole records") {
  const ScratchFolder folder;
  const auto path = folder / "a.journal";
  {
    JournalWriter writer = JournalWriter::create(path, kIdentity, 0);
    std::vector<std::thread> threads;
    for (std::uint64_t thread = 0; thread < 4; ++thread) {
      threads.emplace_back([&writer, thread] {
        for (std::uint64_t i = 0; i < 50; ++i) {
          JournalRecord record = record_of(4 * i + thread);
          writer.append(record);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  std::vector<std::uint64_t> numbers = numbers_in(JournalReader(path));
  std::sort(numbers.begin(), numbers.end());
  CHECK(numbers == first_numbers(200));
}

TEST_CASE("the difference of two journals is named field by field") {
  CHECK(difference(kIdentity, kIdentity).empty());
  CHECK(difference(kIdentity, {{"model", "00ff"}, {"radius", "0.2"}}) ==
        "radius is 0.1, expected 0.2");
  check_equal(difference(kIdentity, {{"model", "00ff"}}), "radius is 0.1, expected none");
  check_says(difference({}, kIdentity), "model is missing, expected 00ff");
}
