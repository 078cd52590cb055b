#pragma once

#include "clearway/search.hpp"

namespace clearway {

class StoreReader;

/// The length of a metre in the store's unit; 1 where the unit is unknown or is no length.
double metre_of(const StoreReader& store);

/// The length of a metre in units of so many metres; 1 where they are not known, which is 0.
double metre_in_units_of(double metres);

/// Throws UsageError, saying what can answer it, where the engine cannot answer a query with these
/// parameters, whatever its model and poses, or where the options contradict each other.
void check_query(const QueryParameters& query, const SearchOptions& options);

/// Throws UsageError where the options for GPUs contradict each other.
void check_gpus(const SearchOptions& options);

/// Throws UsageError where the engine cannot answer a query with these parameters whose model is a
/// surface.
void check_surface(const QueryParameters& query, const SearchOptions& options);

/// Throws InputError where a triangle names a corner that does not exist, where the numbers of
/// solids do not match the triangles or the model is too large for solids, and where model or
/// trajectory have more elements than a tree over them can have.
void check_sizes(const Query& query);

/// Throws UsageError where the engine cannot search the query's bodies, and InputError where the
/// bodies contradict each other or the path.
void check_bodies(const Query& query, const SearchOptions& options);

}  // namespace clearway
