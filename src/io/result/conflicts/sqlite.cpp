#include "io/result/conflicts/sqlite.hpp"

#include <sqlite3.h>

#include <utility>

#include "clearway/error.hpp"
#include "io/files/file.hpp"

namespace clearway::sqlite {

Database::Database(const std::filesystem::path& path) : name_(path.string()) {
  File::create(path);
  // SQLite's own locks are off, because outputs are locked by their PendingFile, also in this
  // process.
  const int code = sqlite3_open_v2(name_.c_str(), &handle_, SQLITE_OPEN_READWRITE, "unix-none");
  if (code != SQLITE_OK) {
    const std::string reason = handle_ == nullptr ? "out of memory" : sqlite3_errmsg(handle_);
    sqlite3_close(std::exchange(handle_, nullptr));
    throw ResourceError(name_ + ": cannot write: " + reason);
  }
  // The caller syncs the file and gives it its name, so a journal would protect nothing.
  run("PRAGMA journal_mode = OFF");
  run("PRAGMA synchronous = OFF");
}

Database::~Database() { sqlite3_close(handle_); }

void Database::run(const std::string& sql) {
  check(sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr), "cannot write");
}

void Database::close() {
  check(sqlite3_close(handle_), "cannot close");
  handle_ = nullptr;
}

void Database::fail(const std::string& what) const {
  throw ResourceError(name_ + ": " + what + ": " + sqlite3_errmsg(handle_));
}

void Database::check(int code, const char* what) const {
  if (code != SQLITE_OK) fail(what);
}

Insert::Insert(Database& database, const std::string& sql) : database_(database) {
  database.check(sqlite3_prepare_v2(database.handle_, sql.c_str(), -1, &statement_, nullptr),
                 "cannot write");
}

Insert::~Insert() { sqlite3_finalize(statement_); }

Insert& Insert::add(const FieldValue& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) {
    return add_integer(static_cast<std::int64_t>(*count));
  }
  const auto* word = std::get_if<std::string_view>(&value);
  if (word != nullptr && !word->empty()) return add_text(*word);
  const auto* number = std::get_if<double>(&value);
  database_.check(number != nullptr ? sqlite3_bind_double(statement_, next_, *number)
                                    : sqlite3_bind_null(statement_, next_),
                  "cannot write");
  ++next_;
  return *this;
}

Insert& Insert::add_text(std::string_view text) {
  database_.check(sqlite3_bind_text64(statement_, next_++, text.data(), text.size(),
                                      SQLITE_TRANSIENT, SQLITE_UTF8),
                  "cannot write");
  return *this;
}

Insert& Insert::add_integer(std::int64_t value) {
  database_.check(sqlite3_bind_int64(statement_, next_++, value), "cannot write");
  return *this;
}

Insert& Insert::add_blob(std::span<const std::byte> bytes) {
  database_.check(
      sqlite3_bind_blob64(statement_, next_++, bytes.data(), bytes.size(), SQLITE_TRANSIENT),
      "cannot write");
  return *this;
}

void Insert::run() {
  const int code = sqlite3_step(statement_);
  if (code != SQLITE_DONE) database_.fail("cannot write");
  sqlite3_reset(statement_);
  next_ = 1;
}

}  // namespace clearway::sqlite
