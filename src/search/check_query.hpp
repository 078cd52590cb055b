#pragma once

#include "clearway/search.hpp"

namespace clearway {

/// The engine that searches: kSweep, kGrid or kKdtree.
Engine chosen_engine(const SearchOptions& options);

/// Throws UsageError, saying what can do it, where the engine cannot answer such a query, whatever
/// its model and poses, or where the options contradict each other.
void check_query(const QueryParameters& query, const SearchOptions& options);

/// The same of a query whose model is a surface.
void check_surface(const QueryParameters& query, const SearchOptions& options);

/// And where it has solids.
void check_solid(const QueryParameters& query);

/// Throws InputError where a triangle has a corner that is not there, where solids are not those of
/// the triangles or too large, and where the trees over model and poses cannot have as many nodes.
void check_sizes(const Query& query);

/// Throws UsageError where the engine cannot search bodies so, and InputError where they contradict
/// each other or the path.
void check_bodies(const Query& query, const SearchOptions& options);

}  // namespace clearway
