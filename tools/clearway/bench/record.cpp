#include "clearway/bench/record.hpp"

#include <algorithm>
#include <fstream>
#include <span>

#include "core/error.hpp"
#include "io/pending_file.hpp"

namespace clearway::tool {
namespace {

Json read(const std::filesystem::path& path) {
  std::ifstream in(path);
  Json all = Json::parse(in, nullptr, false);
  const auto is_case = [](const Json& one) {
    return one.is_object() && one.contains("key") && one["key"].is_string();
  };
  if (!in || !all.is_object() || !all.contains("cases") || !all["cases"].is_array() ||
      !std::all_of(all["cases"].begin(), all["cases"].end(), is_case)) {
    throw InputError(path.string() + ": is not a file of clearway bench");
  }
  return all;
}

}  // namespace

Record::Record(std::filesystem::path path, const Json& header, bool resume, bool force)
    : path_(std::move(path)), all_(header) {
  all_["cases"] = Json::array();
  if (std::filesystem::exists(path_) && !force) {
    if (!resume) {
      throw UsageError(path_.string() + ": exists; --resume goes on with it, --force replaces it");
    }
    Json earlier = read(path_);
    for (const auto& [name, value] : header.items()) {
      if (!earlier.contains(name) || earlier[name] != value) {
        throw UsageError(path_.string() + ": its " + name + " is another; --force replaces it");
      }
    }
    all_ = std::move(earlier);
  }
  write();
}

const Json* Record::find(const std::string& key) const {
  for (const Json& one : all_["cases"]) {
    if (one["key"] == key) return &one;
  }
  return nullptr;
}

Json Record::add(Json of_case) {
  all_["cases"].push_back(std::move(of_case));
  write();
  return all_["cases"].back();
}

void Record::write() const {
  PendingFile pending(path_, true);
  {
    const File file = File::create(pending.partial());
    const std::string text = all_.dump(1) + "\n";
    file.write(std::as_bytes(std::span(text)));
  }
  pending.publish();
}

}  // namespace clearway::tool
