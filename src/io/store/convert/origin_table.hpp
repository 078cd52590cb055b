#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/messages/messages.hpp"
#include "io/store/convert/distribute.hpp"
#include "io/store/convert/environment_source.hpp"
#include "io/store/convert/quanta_batch.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// A place of a scanner in the integers of a store, as StoreOrigins::quanta has them.
using OriginQuanta = std::array<std::int64_t, 3>;

/// The integers of an origin in the unit of the environment. Throws InputError, which begins with
/// `name`, for an origin that they cannot hold.
OriginQuanta quanta_of_origin(const Quantisation& quantisation, const Vec3& origin,
                              const std::string& name);

/// The origins of all points of a conversion, by runs of source indices: the points of a run were
/// seen from the same place, or do not say from where.
class OriginTable {
 public:
  /// most_bytes: memory that the table may take.
  OriginTable(const Quantisation& quantisation, std::uint64_t most_bytes)
      : quantisation_(quantisation), most_bytes_(most_bytes) {}

  /// Names what the following runs rest on, such as "poses of E57".
  void rest_on(const std::string& what);
  /// Adds the run from source index `first` on, which ascends from 0; the origin is in the unit of
  /// the environment. Throws InputError, which begins with `name`, for an origin that the
  /// integers cannot hold, and ResourceError where the table becomes larger than it may.
  void add(std::uint64_t first, const std::optional<Vec3>& origin, const std::string& name);
  /// Likewise, for an origin in the integers of the store.
  void add_quanta(std::uint64_t first, const std::optional<OriginQuanta>& origin,
                  const std::string& name);
  /// Numbers the distinct origins. Called once, after all runs have been added.
  void finish();

  /// Whether any run has an origin.
  bool any() const { return !quanta_.empty(); }
  std::uint64_t allocated_bytes() const;

  /// Counts the points of the next batch, in source order.
  void count(const QuantaBatch& batch);
  /// For each of the points, which are in source order, 1 + the index of its origin, or 0.
  std::vector<std::uint32_t> numbers_of(std::span<const DistributedPoint> points) const;
  /// The origins as a store of `points` points records them, once all points were counted; nullopt
  /// where no point has an origin.
  std::optional<StoreOrigins> origins(std::uint64_t points) const;

  /// Number of points that were counted for each of what the runs rest on.
  std::vector<std::uint64_t> counts() const;
  void set_counts(const std::vector<std::uint64_t>& counts);
  /// Keeps all but what was counted, after finish().
  template <typename Values>
  void keep(Values& values) {
    values.add(runs_, quanta_, bases_, with_origin_, all_zero_);
  }

  /// Warns of points without an origin, and of origins that can hardly be right. box: of all
  /// points. metres: length of the environment's unit.
  void warn(const StoreOrigins& origins, std::uint64_t points, const std::optional<Box>& box,
            double metres, MessageLog& log) const;

 private:
  struct Run {
    std::uint64_t first;
    std::uint32_t number;  ///< 1 + index in quanta_, or 0
    std::uint32_t basis;   ///< index in bases_
  };

  std::uint32_t number_of(const OriginQuanta& quanta);
  std::size_t slot_of(const OriginQuanta& quanta) const;
  std::size_t run_of(std::uint64_t source, std::size_t from) const;
  std::uint64_t end_of(std::size_t run) const;
  void warn_of_zero(const std::optional<Box>& box, double metres, MessageLog& log) const;
  void warn_of_far(const StoreOrigins& origins, const Box& box, double metres,
                   MessageLog& log) const;

  Quantisation quantisation_;
  std::uint64_t most_bytes_;
  std::vector<Run> runs_;
  std::vector<OriginQuanta> quanta_;  ///< distinct, in the order of their runs; then ascending
  /// While runs are added, a hash table of 1 + the index in quanta_, at most half full; 0 is free.
  std::vector<std::uint32_t> slots_;
  std::vector<OriginBasis> bases_;
  std::uint64_t with_origin_ = 0;  ///< number of runs that were added with an origin
  bool all_zero_ = true;           ///< whether all origins are at 0, 0, 0, within half a step
  std::size_t counted_run_ = 0;    ///< run of the point that was counted last
};

/// Adds the origins that the inputs themselves have. To be called when all of them have been read.
void add_origins_of_inputs(const EnvironmentSource& environment, OriginTable& table);

/// Adds the origins of a CSV file with the header first,x,y,z: from source index `first` on, the
/// points were seen from x, y, z. Throws InputError with the line for anything else, and
/// ResourceError.
void add_origins_of_file(const std::filesystem::path& path, OriginTable& table);

/// Throws InputError where a file of origins names a source index beyond the inputs.
void refuse_origins_beyond(const std::filesystem::path& path, std::uint64_t input_points);

}  // namespace clearway
