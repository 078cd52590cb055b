#include "search/memory_budget.hpp"

#include "clearway/error.hpp"
#include "core/query/profile_set.hpp"
#include "core/util/format.hpp"

namespace clearway {

std::uint64_t program_bytes(int threads) {
  constexpr std::uint64_t kProgram = std::uint64_t{8} << 20;
  constexpr std::uint64_t kThread = std::uint64_t{256} << 10;
  return kProgram + kThread * static_cast<std::uint64_t>(threads);
}

namespace {

std::uint64_t bytes_of(const Model& model) {
  return model.vertices.size() * sizeof(model.vertices[0]) +
         model.triangles.size() * sizeof(model.triangles[0]) +
         model.solid_of.size() * sizeof(model.solid_of[0]);
}

}  // namespace

std::uint64_t input_bytes(const StoreReader& store, const Query& query) {
  std::uint64_t bytes =
      store.allocated_bytes() + bytes_of(query.model) + query.poses.size() * sizeof(Pose);
  for (const Body& body : query.bodies) {
    // The search has a copy of model and poses.
    bytes +=
        2 * bytes_of(body.model) + body.poses.size() * (2 * sizeof(Pose) + sizeof(std::uint32_t));
  }
  return bytes;
}

std::uint64_t search_result_bytes(const StoreReader& store, const Query& query) {
  const std::uint64_t a_slot = (query.first_pose ? sizeof(std::uint32_t) : 0) +
                               (query.clearance > 0 ? sizeof(double) + sizeof(std::uint32_t) : 0);
  const std::uint64_t a_pose = query.profile > 0 ? sizeof(ProfilePoint) + sizeof(double) : 0;
  return store.entry_count() / 8 + a_slot * store.entry_count() + a_pose * query.poses.size() +
         last_pose_bytes(store, query);
}

std::uint64_t last_pose_bytes(const StoreReader& store, const Query& query) {
  if (!query.first_pose) return 0;
  const std::uint64_t inputs = input_bytes(store, query) - store.allocated_bytes();
  return store.entry_count() / 8 + store.entry_count() * sizeof(std::uint32_t) + inputs;
}

std::uint64_t tree_building_bytes(const Query& query) {
  const auto of_model = [](const Model& model) {
    // For solids each triangle is there once more.
    const std::uint64_t of_solids = 400 * model.solid_of.size();
    return of_solids +
           (model.is_surface() ? 240 * model.triangles.size() : 52 * model.vertices.size());
  };
  if (query.bodies.empty()) return of_model(query.model) + 168 * query.poses.size();
  std::uint64_t bytes = 0;
  for (const Body& body : query.bodies) bytes += of_model(body.model) + 168 * body.poses.size();
  return bytes;
}

void check_memory(std::uint64_t needed, std::uint64_t allowed) {
  if (needed > allowed) refuse_memory(needed, allowed);
}

void refuse_memory(std::uint64_t needed, std::uint64_t allowed) {
  throw ResourceError(format_size(allowed) + " of memory is too little: this search needs " +
                          format_size(needed) + " beside the mapped store",
                      Remedy::kMoreMemory, static_cast<double>(needed));
}

void refuse_device_memory(std::uint64_t needed, std::uint64_t allowed,
                          const std::string& short_device) {
  const std::string need = "this search needs " + format_size(needed);
  if (!short_device.empty()) {
    throw ResourceError(short_device + " has too little: " + need + ", and may take " +
                            format_size(allowed) + " there",
                        Remedy::kOtherGpu);
  }
  throw ResourceError(
      format_size(allowed) + " of device memory is too little: " + need + " on each device",
      Remedy::kMoreDeviceMemory, static_cast<double>(needed));
}

}  // namespace clearway
