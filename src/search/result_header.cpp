#include "search/result_header.hpp"

#include <utility>

#include "core/geometry/point_box.hpp"
#include "core/query/ignored_points.hpp"
#include "io/result/result_names.hpp"
#include "io/trajectory/content_hash.hpp"
#include "search/check_query.hpp"
#include "search/ignored/count_ignored.hpp"

namespace clearway {

ResultHeader result_header(const StoreReader& store, const Query& query,
                           const SearchOptions& options) {
  const StoreMetadata& metadata = store.metadata();
  QueryParameters asked = query;
  sort_ignored(asked);
  IgnoredPointCounts ignored = count_ignored(store, asked, options.threads);
  const bool by_class = !asked.ignore_classes.empty();
  const std::uint32_t version =
      asked.ignores_points() ? result_names::kIgnoringVersion : result_names::kVersion;
  return {std::move(asked),
          metadata.input_points,
          metadata.points_hash,
          query.model.size(),
          hash_of_model(query.model, query.triangles, query.solid_of),
          query.poses.size(),
          hash_of_trajectory(query.poses),
          query.tolerance > 0 ? name_of(chosen_engine(options)) : "",
          options.float_precision,
          metadata.quantisation,
          metadata.crs_wkt,
          false,
          query.model.empty() ? Box{} : box_of(query.model),
          std::nullopt,
          query.triangles.size(),
          solid_count(query),
          std::move(ignored),
          by_class ? metadata.classes->hash : 0,
          version};
}

}  // namespace clearway
