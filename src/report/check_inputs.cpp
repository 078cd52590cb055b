#include "report/check_inputs.hpp"

#include "clearway/error.hpp"
#include "findings/check_conflicts.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "io/system/xxh64.hpp"
#include "io/trajectory/content_hash.hpp"

namespace clearway {
namespace {

void check_hash(const Result& result, const char* what, std::uint64_t is, std::uint64_t searched,
                Remedy remedy) {
  if (is == searched) return;
  throw InputError(result.reader().name() + ": is the result of another " + what + " (hash " +
                       hash_text(searched) + ", given " + hash_text(is) + ")",
                   remedy);
}

void check_model(const Result& result, const Model& model, const ReportOptions& options) {
  const ResultHeader& header = result.reader().header();
  if (options.bodies.empty() && !header.bodies.empty()) {
    throw InputError(result.reader().name() +
                     ": is the result of a vehicle of several bodies, and one model is given");
  }
  if (!options.bodies.empty()) {
    check_bodies_of(result.reader(), options.bodies);
    return;
  }
  check_hash(result, "model", hash_of_model(model), header.model_hash, Remedy::kSameModel);
}

}  // namespace

void check_report_inputs(const Result& result, const Store& store, const Model& model,
                         const std::vector<Pose>& poses, const ReportOptions& options) {
  const ResultHeader& header = result.reader().header();
  check_hash(result, "environment", store.reader().metadata().points_hash, header.environment_hash,
             Remedy::kSameEnvironment);
  if (store.crs_wkt() != header.crs_wkt) {
    throw InputError(
        result.reader().name() + ": names another coordinate reference system than the store",
        Remedy::kSameEnvironment);
  }
  check_model(result, model, options);
  check_hash(result, "trajectory", hash_of_trajectory(poses), header.trajectory_hash,
             Remedy::kSameTrajectory);
}

}  // namespace clearway
