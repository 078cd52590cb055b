#include "bench/measure/work_folder.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

fs::path made(fs::path path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw ResourceError(path.string() + ": cannot create the folder: " + error.message());
  }
  return path;
}

/// Locks a folder. The lock's file stays, because removing it would let another process lock a file
/// that has no name any more.
File locked(const fs::path& folder) {
  const fs::path path = folder / "bench.lock";
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw ResourceError(path.string() + ": cannot create: " + std::strerror(errno));
  }
  File file = File::adopt(descriptor, path.string());
  if (!lock_whole(file)) {
    throw ResourceError(folder.string() +
                        ": another clearway-bench uses it; wait for it, or take another --work");
  }
  return file;
}

constexpr const char* kMadeBy = "made-by.json";

std::string text_of(const Json& program) {
  if (!program.is_object()) return "an unknown program";
  std::string text = "clearway";
  for (const auto& [name, value] : program.items()) {
    text += " " + name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text;
}

/// Whether a work folder holds folders or stores.
bool holds_inputs(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() || entry.path().extension() == ".h5") return true;
  }
  return false;
}

void write(const fs::path& path, const std::string& text) {
  PendingFile pending(path, true);
  File::create(pending.partial()).write(std::as_bytes(std::span(text)));
  pending.publish();
}

}  // namespace

bool may_have_changed(const Json& program) {
  const std::string commit = program.value("commit", "");
  return commit == "unknown" || commit.ends_with("-dirty");
}

std::optional<std::string> WorkFolder::note_program(const Json& program) const {
  const fs::path note = path_ / kMadeBy;
  const bool noted = fs::exists(note);
  if (!noted && !fs::exists(answers())) {
    const bool holds_others = holds_inputs(path_);
    write(note, program.dump(1) + "\n");
    if (!holds_others) return std::nullopt;
    return path_.string() + ": scenes and stores of an unknown program are used";
  }
  const Json earlier = noted ? Json::parse(std::ifstream(note), nullptr, false) : Json();
  if (!(earlier == program)) {  // != is false also for text that is no JSON
    throw UsageError(path_.string() + ": made by " + text_of(earlier) + "; this program is " +
                     text_of(program) + ": take another --work or remove the folder (or its " +
                     kMadeBy + " and answers, to use its scenes and stores nevertheless)");
  }
  if (!may_have_changed(program)) return std::nullopt;
  return path_.string() + ": made by " + text_of(program) +
         "; remove the folder if the source has changed since";
}

WorkFolder::WorkFolder(fs::path path) : path_(made(std::move(path))), lock_(locked(path_)) {}

}  // namespace clearway::bench
