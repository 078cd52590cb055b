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

/// Bytes of a store's points that were read, by column. What is read again counts again.
struct BytesRead {
  std::uint64_t coordinates = 0, sources = 0, classes = 0, origins = 0;
};

/// An environment that convert() made. Its index is in memory, while its points stay in the file.
class Store {
 public:
  /// Opens a store. Throws InputError if the file is not an intact, complete store of this version;
  /// ResourceError if it cannot be read.
  explicit Store(const std::filesystem::path& path);
  ~Store();
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  std::uint64_t point_count() const;
  std::uint64_t cell_count() const;
  Box box() const;  ///< box around all points; zeros if there are no points
  /// How many points each class has, 256 numbers; empty if the points have no classes.
  std::vector<std::uint64_t> class_points() const;
  /// Whether any point has an origin, the place of the scanner that saw it.
  bool has_origins() const;
  /// Coordinate reference system as the scans gave it, or empty
  const std::string& crs_wkt() const;
  /// The unit of the coordinates: "metre", "foot", "us-survey-foot", "degree" or "unknown".
  std::string length_unit() const;
  /// Metres of length_unit(), as ModelOptions::environment_unit takes them; 1 if it is unknown.
  double metres_per_unit() const;
  /// The warnings of the conversion, with codes such as "store-same-place"; at most 64.
  std::vector<Message> warnings() const;
  const std::filesystem::path& path() const { return path_; }

  /// The reader behind this store, for the library itself.
  const StoreReader& reader() const { return *reader_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<StoreReader> reader_;
};

}  // namespace clearway
