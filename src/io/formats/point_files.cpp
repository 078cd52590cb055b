#include <algorithm>
#include <system_error>

#include "clearway/error.hpp"
#include "io/formats/point_formats.hpp"
#include "io/formats/point_reader.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  const fs::directory_iterator end;
  for (fs::directory_iterator at(folder, error); !error && at != end; at.increment(error)) {
    std::error_code unknown;
    const bool hidden = at->path().filename().native().starts_with('.');
    if (!hidden && !at->is_directory(unknown) && is_surely_point_file(at->path())) {
      files.push_back(at->path());
    }
  }
  if (error) throw ResourceError(folder.string() + ": cannot list the folder: " + error.message());
  // std::string compares its bytes as unsigned, so this is byte order.
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return a.filename().native() < b.filename().native();
  });
  if (files.empty()) {
    refuse(folder.string(),
           "holds no point file; expected files with the ending las, ply, xyz, pts or asc (txt and "
           "csv files have to be named themselves)");
  }
  return files;
}

}  // namespace

std::vector<fs::path> list_point_files(const std::vector<fs::path>& inputs) {
  std::vector<fs::path> files;
  for (const fs::path& input : inputs) {
    std::error_code error;
    const fs::file_status status = fs::status(input, error);
    if (!fs::exists(status)) {
      throw ResourceError(input.string() + ": no such file or folder");
    }
    if (fs::is_directory(status)) {
      const auto found = files_of_folder(input);
      files.insert(files.end(), found.begin(), found.end());
    } else {
      files.push_back(input);
    }
  }
  return files;
}

}  // namespace clearway
