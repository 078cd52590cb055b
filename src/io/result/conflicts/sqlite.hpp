#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "io/result/conflicts/conflict_fields.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace clearway::sqlite {

/// A new database with one writer. All functions throw ResourceError with the file's name.
class Database {
 public:
  /// Creates the database, or empties an existing file.
  explicit Database(const std::filesystem::path& path);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database();

  void run(const std::string& sql);
  /// Writes the remaining data and closes the database; no call may follow.
  void close();

 private:
  friend class Insert;
  [[noreturn]] void fail(const std::string& what) const;
  void check(int code, const char* what) const;

  std::string name_;
  sqlite3* handle_ = nullptr;
};

/// A statement whose question marks are replaced by values. It may be run several times. The
/// database must outlive it.
class Insert {
 public:
  Insert(Database& database, const std::string& sql);
  Insert(const Insert&) = delete;
  Insert& operator=(const Insert&) = delete;
  ~Insert();

  /// Sets the next value.
  Insert& add(const FieldValue& value);
  Insert& add_text(std::string_view text);
  Insert& add_integer(std::int64_t value);
  Insert& add_blob(std::span<const std::byte> bytes);
  /// Runs the statement, for which as many values as question marks must be set.
  void run();

 private:
  Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int next_ = 1;
};

}  // namespace clearway::sqlite
