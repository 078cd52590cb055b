#pragma once

#include <cstdint>
#include <string>

#include "clearway/query.hpp"
#include "io/store/store_reader.hpp"

/// The bytes that a run takes of the memory budget, beside the mapped store.
namespace clearway {

/// Bytes of the program itself: its libraries' data, stacks of threads, buffers of files.
std::uint64_t program_bytes(int threads);

/// Bytes of the store's index, of models and of poses.
std::uint64_t input_bytes(const StoreReader& store, const Query& query);

/// Bytes of a search's result: hits, first and last poses and clearances of all points, nearest
/// points and chainage of all poses.
std::uint64_t search_result_bytes(const StoreReader& store, const Query& query);

/// Bytes that a search for last poses keeps besides the result of the first search: the other hits,
/// and a copy of the inputs; 0 where no first poses are asked for.
std::uint64_t last_pose_bytes(const StoreReader& store, const Query& query);

/// Bytes that are taken while the trees over model and poses are built. To choose what a tolerance
/// keeps takes less.
std::uint64_t tree_building_bytes(const Query& query);

/// Throws ResourceError, naming what is needed, where that is more than `allowed`.
void check_memory(std::uint64_t needed, std::uint64_t allowed);

/// Throws ResourceError that says how much memory is needed and what to do.
[[noreturn]] void refuse_memory(std::uint64_t needed, std::uint64_t allowed);
/// Throws ResourceError that says how much device memory is needed and what to do. short_device:
/// the device whose free memory is too little; empty where the limit is the budget.
[[noreturn]] void refuse_device_memory(std::uint64_t needed, std::uint64_t allowed,
                                       const std::string& short_device);

}  // namespace clearway
