#include "io/store/convert/source_description.hpp"

#include <cstddef>
#include <span>
#include <utility>

#include "core/util/format.hpp"
#include "core/util/threads.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/xxh64.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

std::string name_in_store(const std::filesystem::path& path) {
  return valid_utf8(path.filename().string());
}

SourceFile describe(const std::filesystem::path& path, const std::stop_token& stop,
                    const Progress& progress) {
  if (path == "-") return {"-", 0, 0};
  const File file = File::open_for_reading(path);
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  Xxh64Stream hash;
  std::uint64_t bytes = 0;
  while (const std::size_t got = file.read_some(buffer)) {
    if (stop.stop_requested()) break;
    throw_if_stopped(progress);
    hash.update(std::span(buffer).first(got));
    bytes += got;
  }
  return {name_in_store(path), bytes, hash.digest()};
}

SourceFile describe_with_files(const std::filesystem::path& input) {
  const NoProgress progress;
  const std::vector<std::filesystem::path> files = files_behind(input);
  if (files == std::vector{input}) return describe(input, {}, progress);
  SourceFile all{name_in_store(input), 0, 0};
  Xxh64Stream hash;
  for (const std::filesystem::path& file : files) {
    const SourceFile one = describe(file, {}, progress);
    all.bytes += one.bytes;
    const std::string text = one.name + " " + hash_text(one.xxh64) + "\n";
    hash.update(std::as_bytes(std::span(text)));
  }
  all.xxh64 = hash.digest();
  return all;
}

SourceDescription::SourceDescription(std::vector<std::filesystem::path> files,
                                     std::vector<bool> known, const Progress& progress)
    : files_(std::move(files)), progress_(progress) {
  known.resize(files_.size());
  sources_ = std::async(kBeside, [this, known = std::move(known)] {
    std::vector<std::optional<SourceFile>> sources(files_.size());
    for (std::size_t i = 0; i < files_.size(); ++i) {
      if (!known[i]) sources[i] = describe(files_[i], stop_.get_token(), progress_);
    }
    return sources;
  });
}

std::vector<SourceFile> SourceDescription::get(std::vector<std::optional<SourceFile>> known) {
  const std::vector<std::optional<SourceFile>> described = sources_.get();
  known.resize(files_.size());
  std::vector<SourceFile> sources;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    const auto& found = described[i] ? described[i] : known[i];
    // A file without any piece has not been described elsewhere.
    sources.push_back(found ? *found : describe(files_[i], stop_.get_token(), progress_));
  }
  return sources;
}

}  // namespace clearway
