#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

#include "core/sweep/sweep_page.hpp"
#include "core/sweep/sweep_profile.hpp"

namespace clearway {

/// Numbers of a SweepStatistics, in its order, and places in which they are added up: several, so
/// that warps seldom wait for each other.
constexpr std::uint32_t kSweepCounts = 5;
constexpr std::uint32_t kSweepTallies = 64;

/// Blocks of threads of search_sweep that a device can hold at a time. Throws ResourceError.
unsigned resident_sweep_blocks(int device);

/// Clears and fills the page's answer. tallies: kSweepCounts times kSweepTallies, added to.
/// Enqueued on `stream`, not synchronised. Throws ResourceError.
void search_sweep(const SweepPage& page, unsigned long long* tallies, unsigned resident_blocks,
                  cudaStream_t stream);

/// Lists the nearest points of a page at its poses. tallies: as of search_sweep. Enqueued on
/// `stream`, not synchronised. Throws ResourceError.
void search_profile(const SweepPage& page, const ProfileBests& bests, const ProfileList& list,
                    unsigned long long* tallies, unsigned resident_blocks, cudaStream_t stream);

/// CUDA loads a kernel where it is first asked for: asks for all of this file. On the current
/// device.
void load_sweep_kernels() noexcept;

}  // namespace clearway
