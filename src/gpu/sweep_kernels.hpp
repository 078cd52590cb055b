#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

#include "core/sweep/profile/sweep_profile.hpp"
#include "core/sweep/sweep_page.hpp"

namespace clearway {

/// Number of counts in a SweepStatistics, which keep its order, and number of places in which they
/// are added up: several, so that warps seldom wait for each other.
constexpr std::uint32_t kSweepCounts = 4;
constexpr std::uint32_t kSweepTallies = 64;

/// Number of thread blocks of search_sweep() that a device can hold at a time. Throws
/// ResourceError.
unsigned resident_sweep_blocks(int device);

/// Searches a page: clears and fills its answer. tallies: kSweepCounts times kSweepTallies numbers,
/// added to. Enqueued on `stream`, not synchronised. Throws ResourceError.
template <typename Element>
void search_sweep(const SweepPageOf<Element>& page, unsigned long long* tallies,
                  unsigned resident_blocks, cudaStream_t stream);

/// Lists the nearest points of a page at its poses. tallies: as for search_sweep(). Enqueued on
/// `stream`, not synchronised. Throws ResourceError.
template <typename Element>
void search_profile(const SweepPageOf<Element>& page, const ProfileBests& bests,
                    const ProfileList& list, unsigned long long* tallies, unsigned resident_blocks,
                    cudaStream_t stream);

extern template void search_sweep(const SweepPageOf<Vec3>&, unsigned long long*, unsigned,
                                  cudaStream_t);
extern template void search_sweep(const SweepPageOf<Triangle>&, unsigned long long*, unsigned,
                                  cudaStream_t);
extern template void search_sweep(const SweepPageOf<SolidTriangle>&, unsigned long long*, unsigned,
                                  cudaStream_t);
extern template void search_profile(const SweepPageOf<Vec3>&, const ProfileBests&,
                                    const ProfileList&, unsigned long long*, unsigned,
                                    cudaStream_t);
extern template void search_profile(const SweepPageOf<Triangle>&, const ProfileBests&,
                                    const ProfileList&, unsigned long long*, unsigned,
                                    cudaStream_t);
extern template void search_profile(const SweepPageOf<SolidTriangle>&, const ProfileBests&,
                                    const ProfileList&, unsigned long long*, unsigned,
                                    cudaStream_t);

/// Loads the kernels that search points on the current device, because CUDA otherwise loads a
/// kernel when it is first used.
void load_sweep_kernels() noexcept;

}  // namespace clearway
