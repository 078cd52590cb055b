#include "search/result_header.hpp"

#include "core/geometry/point_box.hpp"
#include "io/trajectory/content_hash.hpp"
#include "search/check_query.hpp"

namespace clearway {

ResultHeader result_header(const StoreReader& store, const Query& query,
                           const SearchOptions& options) {
  const StoreMetadata& metadata = store.metadata();
  return {query,
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
          solid_count(query)};
}

}  // namespace clearway
