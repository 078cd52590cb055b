#include <algorithm>
#include <optional>

#include "clearway/error.hpp"
#include "io/convert/checks/readable_files.hpp"
#include "io/convert/convert.hpp"
#include "io/convert/source_description.hpp"
#include "io/formats/point_reader.hpp"
#include "io/formats/wkt.hpp"
#include "io/store/store_reader.hpp"
#include "io/store/verify_store.hpp"

namespace clearway {
namespace {

/// The store at a path; nullopt where there is no store with a sound index.
std::optional<StoreReader> store_at(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) return std::nullopt;
  try {
    return std::optional<StoreReader>(std::in_place, path);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Whether a store in unit `found` agrees with the option `wanted`, which applies where inputs name
/// no unit. An option "ft" agrees with either foot, since another input may have named which.
bool has_wanted_unit(const FileUnit& wanted, LengthUnit found) {
  return !wanted.is_known() || wanted.metres_in(metres_of(found)) == metres_of(found);
}

/// Whether a conversion with these options could have made this store, as far as its metadata
/// tells.
bool would_make(const ConversionOptions& options, const StoreMetadata& found) {
  const auto wanted = [&options](double scale) {
    return !options.scale || scale == *options.scale;
  };
  return found.cell_points == options.cell_points &&
         found.layout == layout_name(options.regular_size) &&
         std::all_of(found.quantisation.scale, found.quantisation.scale + 3, wanted) &&
         (!options.strict || found.point_count == found.input_points || !found.warnings.empty()) &&
         has_wanted_unit(options.unit, found.unit) &&
         (options.ignore_crs ||
          (found.unit != LengthUnit::kDegrees && units_of_wkt(found.crs_wkt).trouble.empty()));
}

}  // namespace

bool is_converted(const ConversionOptions& options, Progress& progress) {
  // A store does not record the columns with which it was made.
  if (options.inputs == std::vector<std::filesystem::path>{"-"} || !options.columns.empty()) {
    return false;
  }
  const std::optional<StoreReader> store = store_at(options.output);
  if (!store || !would_make(options, store->metadata())) return false;
  std::vector<std::filesystem::path> files = list_point_files(options.inputs);
  if (options.skip_unreadable) files = readable_files(files, {}, progress).files;
  SourceDescription sources(with_pose_files(files), {}, progress);
  if (sources.get() != store->metadata().sources) return false;
  const std::vector<std::string> faults = verify_store(*store, progress, 1);
  if (faults.empty()) return true;
  throw UsageError(faults[0] + "; the store of these inputs is damaged",
                   Remedy::kOverwriteNotResume);
}

}  // namespace clearway
