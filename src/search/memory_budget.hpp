#pragma once

#include <cstdint>
#include <string>

#include "clearway/query.hpp"
#include "io/store/store_reader.hpp"

/// What a run takes of the memory budget beside the mapped store.
namespace clearway {

/// The program itself: its libraries' data, stacks of threads, buffers of files.
std::uint64_t program_bytes(int threads);

/// Index of the store, model and poses.
std::uint64_t input_bytes(const StoreReader& store, const Query& query);

/// Hits, first and last poses and clearances of all points, nearest points and chainage of all
/// poses.
std::uint64_t search_result_bytes(const StoreReader& store, const Query& query);

/// What a search for last poses keeps at the same time: the other hits, and a copy of the inputs.
std::uint64_t last_pose_bytes(const StoreReader& store, const Query& query);

/// While the trees over model and poses are built. Choosing what a tolerance keeps takes less.
std::uint64_t tree_building_bytes(const Query& query);

/// Throws ResourceError naming what is needed where that is more than `allowed`.
void check_memory(std::uint64_t needed, std::uint64_t allowed);

/// Throws ResourceError that says what to do.
[[noreturn]] void refuse_memory(std::uint64_t needed, std::uint64_t allowed);
/// short_device: the device whose free memory, not the budget, is the bound; empty: none.
[[noreturn]] void refuse_device_memory(std::uint64_t needed, std::uint64_t allowed,
                                       const std::string& short_device);

}  // namespace clearway
