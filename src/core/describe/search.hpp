#pragma once

#include <array>
#include <tuple>

#include "clearway/search.hpp"
#include "core/describe/machine.hpp"

namespace clearway {

template <>
inline constexpr std::array kChoices<Engine>{Choice<Engine>{"sweep", Engine::kSweep},
                                             Choice<Engine>{"grid", Engine::kGrid},
                                             Choice<Engine>{"kdtree", Engine::kKdtree}};

template <typename Options>
inline constexpr Field kEngine{
    .member = &Options::engine,
    .key = "engine",
    .option = "--engine",
    .group = OptionGroup::kSpeed,
    .help =
        "sweep; grid and kdtree are those of the paper, which find the points that collide at the "
        "poses and nothing else",
    .doc =
        "'sweep', 'grid' or 'kdtree'; the last two are those of the paper, which\n"
        "    find the points that collide at the poses and nothing else."};

/// How a query is searched, and where.
inline constexpr std::tuple kEngineFields =
    std::tuple_cat(std::tuple{kEngine<SearchOptions>}, kMachineFields<SearchOptions>);

/// What a search does about its files. Not in campaigns, which decide about files themselves.
inline constexpr std::tuple kFileFields{
    Field{.member = &SearchOptions::overwrite,
          .key = "overwrite",
          .option = "--force",
          .group = OptionGroup::kFiles,
          .help = "Overwrite an existing result; remove the journal of an earlier run",
          .doc = "Replaces an existing result, and the journal of an earlier search.",
          .is_in_campaigns = false},
    Field{.member = &SearchOptions::resume,
          .key = "resume",
          .option = "--resume",
          .group = OptionGroup::kFiles,
          .help = "Go on with a run of the same query that was interrupted or killed",
          .doc = "Goes on from the journal of an earlier search.",
          .is_in_campaigns = false},
    Field{.member = &SearchOptions::journal_interval_seconds,
          .key = "journal_interval_seconds",
          .campaign_key = "journal_interval",
          .option = "--journal-interval",
          .group = OptionGroup::kFiles,
          .help = "Seconds between two syncs of the journal to the disk; a system crash can cost "
                  "that much work",
          .doc = "How often what was found is made safe on the disk, seconds.",
          .unit = FieldUnit::kSeconds,
          .least = 0,
          .most = 3600}};

template <typename Options>
inline constexpr Field kStrict{
    .member = &Options::strict,
    .key = "strict",
    .option = "--strict",
    .group = OptionGroup::kOutput,
    .help = "Treat warnings as errors: nothing is searched (exit code 3)",
    .doc = "Treats warnings as errors: raises InputError, and searches nothing."};

/// What only programs say, which have read the inputs themselves.
inline constexpr std::tuple kCallerFields{Field{
    .member = &SearchOptions::end_gpus,
    .key = "end_gpus",
    .doc = "Says that nothing else in this process uses CUDA, so that it ends with the search."}};

/// All that the command line and Python may choose about a search.
inline constexpr std::tuple kSearchFields =
    std::tuple_cat(kEngineFields, kFileFields, std::tuple{kStrict<SearchOptions>}, kCallerFields);

}  // namespace clearway
