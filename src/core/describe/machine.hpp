#pragma once

#include <array>
#include <tuple>

#include "clearway/device.hpp"
#include "core/describe/field.hpp"

namespace clearway {

template <>
inline constexpr std::array kChoices<Device>{Choice<Device>{"auto", Device::kAuto},
                                             Choice<Device>{"cpu", Device::kCpu},
                                             Choice<Device>{"cuda", Device::kCuda}};

/// The GPUs that options with these members may use.
template <typename Options>
inline constexpr std::tuple kDeviceFields{
    Field{.member = &Options::device,
          .key = "device",
          .option = "--device",
          .group = OptionGroup::kSpeed,
          .help = "cpu or cuda; auto takes a GPU where the engine and the machine have one",
          .doc = "'auto', 'cpu' or 'cuda'; 'auto' takes a GPU where that is estimated faster."},
    Field{.member = &Options::gpus,
          .key = "gpus",
          .option = "--gpus",
          .group = OptionGroup::kSpeed,
          .help = "Numbers of the GPUs to use, for example 0,1",
          .usual = "the first with room",
          .doc = "The numbers that CUDA gives the GPUs to take; empty: the first one with room.",
          .least = 0,
          .most = 1023},
    Field{.member = &Options::device_memory_bytes,
          .key = "device_memory_bytes",
          .campaign_key = "device_memory",
          .option = "--device-memory",
          .group = OptionGroup::kSpeed,
          .help = "Memory bound of each GPU, without CUDA's own",
          .usual = "2G, or what is free",
          .doc = "How many bytes may be taken on each GPU; 0: 2 GiB, or what is free.",
          .unit = FieldUnit::kBytes}};

template <typename Options>
inline constexpr Field kThreads{.member = &Options::threads,
                                .key = "threads",
                                .option = "--threads",
                                .group = OptionGroup::kSpeed,
                                .help = "Threads",
                                .usual = "all cores",
                                .doc = "How many threads work; 0: as many as there are cores.",
                                .least = 1,
                                .most = 1024};

template <typename Options>
inline constexpr Field kMemory{.member = &Options::memory_bytes,
                               .key = "memory_bytes",
                               .campaign_key = "memory",
                               .option = "--memory",
                               .group = OptionGroup::kSpeed,
                               .help = "Bound of the working memory, for example 512M or 4G",
                               .usual = "4.0 GiB",
                               .doc = "How many bytes of working memory may be taken.",
                               .unit = FieldUnit::kBytes};

/// The cores and the memory that options with these members may use.
template <typename Options>
inline constexpr std::tuple kHostFields{kThreads<Options>, kMemory<Options>};

/// All of the machine.
template <typename Options>
inline constexpr std::tuple kMachineFields = std::tuple_cat(kDeviceFields<Options>,
                                                            kHostFields<Options>);

}  // namespace clearway
