#include "io/result/journal.hpp"

#include <algorithm>
#include <numeric>
#include <thread>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scratch_folder.hpp"

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

void check_numbers(const std::vector<std::uint64_t>& found, std::uint64_t count) {
  std::vector<std::uint64_t> expected(count);
  std::iota(expected.begin(), expected.end(), 0);
  check_equal(found, expected);
}

std::string flipped(std::string bytes, std::size_t at, int bit) {
  bytes[at] = static_cast<char>(bytes[at] ^ 1 << bit);
  return bytes;
}

struct JournalFile {
  /// Appends records first .. end - 1, and syncs after each of the first `synced`.
  static void append(JournalWriter writer, std::uint64_t first, std::uint64_t end,
                     std::uint64_t synced = 0) {
    for (std::uint64_t i = first; i < end; ++i) {
      JournalRecord record = record_of(i);
      writer.append(record);
      if (i < synced) writer.sync();
    }
  }
  /// Writes a journal of `records`, and returns its bytes.
  std::string write(std::uint64_t records, std::uint64_t synced) const {
    append(JournalWriter::create(path, kIdentity, kNever), 0, records, synced);
    return bytes_of(path);
  }

  ScratchFolder folder;
  std::filesystem::path path = folder / "a.journal";
};

}  // namespace

TEST_CASE("a journal gives back what was appended") {
  const JournalFile file;
  const std::string bytes = file.write(100, 3);
  const JournalReader journal(file.path);
  CHECK(journal.identity() == kIdentity);
  check_equal(journal.records(), 100);
  CHECK(journal.torn().empty());
  CHECK(journal.whole_bytes() == bytes.size());
  check_numbers(numbers_in(journal), 100);
}

TEST_CASE("a journal cut at any byte gives the records before, and goes on from them") {
  const JournalFile file;
  const std::string whole = file.write(12, 4);
  std::uint64_t most = 0;
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    put_bytes(file.path, whole.substr(0, bytes));
    const JournalReader journal(file.path);
    const std::uint64_t records = journal.records();
    CHECK(records >= most);
    CHECK(records < 12);
    most = std::max(most, records);
    check_numbers(numbers_in(journal), records);
    if (!journal.identity()) continue;
    CHECK(journal.identity() == kIdentity);
    CHECK(journal.torn().empty() == (journal.whole_bytes() == bytes));
    JournalFile::append(JournalWriter::resume(file.path, journal, kNever), records, 12);
    check_numbers(numbers_in(JournalReader(file.path)), 12);
  }
  check_equal(most, 11);
}

TEST_CASE("a byte flipped before what is known to be on the disk is refused and named") {
  const JournalFile file;
  const std::string whole = file.write(12, 11);
  const std::size_t last = whole.size() - 32 - 1 - 1 - 11;  // the record that says what is synced
  for (std::size_t at = 0; at < last; ++at) {
    for (const int bit : {0, 3, 7}) {
      put_bytes(file.path, flipped(whole, at, bit));
      CAPTURE(at, bit);
      CHECK_THROWS_AS(JournalReader(file.path), InputError);
    }
  }
  put_bytes(file.path, flipped(whole, last - 1, 0));
  check_refused([&] { return JournalReader(file.path); }, "a.journal: record 11 at byte");
}

TEST_CASE("a byte flipped after that leaves the records before it") {
  const JournalFile file;
  const std::string whole = file.write(12, 0);
  for (std::size_t at = 16; at < whole.size(); ++at) {
    put_bytes(file.path, flipped(whole, at, 4));
    const JournalReader journal(file.path);
    CAPTURE(at);
    CHECK(journal.records() < 12);
    CHECK(journal.whole_bytes() <= at);
    CHECK_FALSE(journal.torn().empty());
    check_numbers(numbers_in(journal), journal.records());
  }
}

TEST_CASE("what is no journal, or one of another version, is refused, and a begun one is empty") {
  const JournalFile file;
  CHECK_FALSE(is_journal(file.path));
  const auto check = [&](const std::string& bytes, bool is_one, const char* words) {
    put_bytes(file.path, bytes);
    CHECK(is_journal(file.path) == is_one);
    if (words != nullptr) {
      check_refused<InputError>([&] { return JournalReader(file.path); }, words);
    } else {
      CHECK_FALSE(JournalReader(file.path).identity());
    }
  };
  check("a journal of another program", false, "a.journal");
  check("CLWYJRX", false, "a.journal");
  check("CLWYJRN", true, nullptr);
  check("", false, nullptr);
  check({"CLWYJRNL\1\0\0\0\0\0\0\0", 16}, true, "journal of version 1 of another release");
  check({"CLWYJRNL\2\0\0\0\0\0\0\1", 16}, true, "a.journal");
}

TEST_CASE("a journal is created only where no file is, and not through a link") {
  const JournalFile file;
  put_bytes(file.folder / "precious", "precious");
  std::filesystem::create_symlink("precious", file.path);
  CHECK_THROWS_AS(JournalWriter::create(file.path, kIdentity, kNever), ResourceError);
  check_equal(bytes_of(file.folder / "precious"), "precious");
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
  const JournalFile file;
  {
    JournalWriter writer = JournalWriter::create(file.path, kIdentity, 0);
    std::vector<std::jthread> threads;
    for (std::uint64_t thread = 0; thread < 4; ++thread) {
      threads.emplace_back([&writer, thread] {
        for (std::uint64_t i = 0; i < 50; ++i) {
          JournalRecord record = record_of(4 * i + thread);
          writer.append(record);
        }
      });
    }
  }
  std::vector<std::uint64_t> numbers = numbers_in(JournalReader(file.path));
  std::ranges::sort(numbers);
  check_numbers(numbers, 200);
}

TEST_CASE("the difference of two journals is named field by field") {
  CHECK(difference(kIdentity, kIdentity).empty());
  CHECK(difference(kIdentity, {{"model", "00ff"}, {"radius", "0.2"}}) ==
        "radius is 0.1, expected 0.2");
  check_equal(difference(kIdentity, {{"model", "00ff"}}), "radius is 0.1, expected none");
  check_says(difference({}, kIdentity), "model is missing, expected 00ff");
}
