#include "cli/vehicle/run_query.hpp"

#include <utility>

#include "clearway/model.hpp"
#include "clearway/vehicle.hpp"
#include "cli/support/console.hpp"

namespace clearway::tool {

Query read_query(RunOptions& options, const Store& store, PoseLabels& labels) {
  std::vector<Message>& warnings = options.search.input_warnings;
  const ModelOptions how = model_options_of(options);
  Query query({}, {}, options.query);
  if (options.vehicle.empty()) query.model = read_model(options.model, how, &warnings);
  options.trajectory_options.default_crs = store.crs_wkt();
  query.poses = read_trajectory(options.trajectory, options.trajectory_options, &warnings, &labels);
  if (!options.vehicle.empty()) {
    query.bodies =
        read_vehicle(options.vehicle, query.poses,
                     {how, options.trajectory_options, options.search.threads}, &warnings);
  }
  for (const Message& warning : warnings) log_message(warning);
  return query;
}

}  // namespace clearway::tool
