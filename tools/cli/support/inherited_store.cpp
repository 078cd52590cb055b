#include "cli/support/inherited_store.hpp"

#include <exception>
#include <optional>
#include <utility>

#include "clearway/error.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::tool {
namespace {

std::optional<Store>& inherited() {
  static std::optional<Store> store;
  return store;
}

/// Whether the file is still the one that was opened.
bool is_unchanged(const Store& store) {
  try {
    store.reader().check_unchanged();
    return true;
  } catch (const Error&) {
    return false;
  }
}

bool is_kept(const std::filesystem::path& path) {
  return inherited() && inherited()->path() == path && is_unchanged(*inherited());
}

}  // namespace

void keep_store(const std::filesystem::path& path) {
  if (is_kept(path)) return;
  inherited().reset();
  try {
    inherited().emplace(path);
  } catch (const std::exception&) {  // the command says it
  }
}

Store open_store(const std::filesystem::path& path) {
  if (!is_kept(path)) return Store(path);
  Store store = std::move(*inherited());
  inherited().reset();
  return store;
}

}  // namespace clearway::tool
