#pragma once

#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

/// The kind of engine that options.engine names, on the CPU; options.threads is not 0. All
/// references outlive it.
std::unique_ptr<PageEngineKind> cpu_kind(const PackedCloud& cloud, const Query& query,
                                         const SearchOptions& options,
                                         const EngineSettings& settings = {});

}  // namespace clearway
