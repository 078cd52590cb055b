#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

#include "core/sweep/profile/sweep_profile.hpp"
#include "core/sweep/sweep_page.hpp"

namespace clearway {

/// Numbers of a SweepStatistics, in its order, and places in which they are added up: several, so
/// that warps seldom wait for each other.
constexpr std::uint32_t kSweepCounts = 5;
constexpr std::uint32_t kSweepTallies = 64;

/// Blocks of threads of search_sweep that a device can hold at a time. Throws ResourceError.
unsigned resident_sweep_blocks(int device);

/// Clears and fills the page's answer. tallies: kSweepCounts times kSweepTallies, added to.
/// Enqueued on `stream`, not synchronised. Throws ResourceError.
template <typename Element>
void search_sweep(const SweepPageOf<Element>& page, unsigned long long* tallies,
                  unsigned resident_blocks, cudaStream_t stream);

/// Lists the nearest points of a page at its poses. tallies: as of search_sweep. Enqueued on
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

/// CUDA loads a kernel where it is first asked for: asks for those of this file that search points.
/// On the current device.
void load_sweep_kernels() noexcept;

}  // namespace clearway
