#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/progress.hpp"

namespace clearway {

class StoreReader;

/// An environment that convert() made. Its index is in memory, its points stay in the file.
class Store {
 public:
  /// Throws InputError when the file is not an intact, complete store of this version;
  /// ResourceError when it cannot be read.
  explicit Store(const std::filesystem::path& path);
  ~Store();
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  std::uint64_t point_count() const;
  std::uint64_t cell_count() const;
  Box box() const;  ///< of all points; of no points: zeros
  /// How many points each class has, 256 numbers; empty where the points have no classes.
  std::vector<std::uint64_t> class_points() const;
  const std::string& crs_wkt() const;  ///< as the scans had it, or empty
  /// "metre", "foot", "us-survey-foot", "degree" or "unknown".
  std::string length_unit() const;
  /// Metres of that unit, as ModelOptions::environment_unit takes them; 1 where it is unknown.
  double metres_per_unit() const;
  /// What the conversion warned of, with codes as "store-same-place"; at most 64.
  std::vector<Message> warnings() const;
  const std::filesystem::path& path() const { return path_; }

  /// For the library itself.
  const StoreReader& reader() const { return *reader_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<StoreReader> reader_;
};

}  // namespace clearway
