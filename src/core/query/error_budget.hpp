#pragma once

#include <optional>

#include "clearway/error_budget.hpp"
#include "clearway/query.hpp"
#include "core/geometry/quantisation.hpp"

namespace clearway {

/// How many points that are certainly too close have to hang together for a conflict.
inline constexpr std::uint64_t kLeastCertainGroup = 10;

/// The budget of a query in an environment with these steps; nullopt if the query asks for none.
std::optional<ErrorBudget> error_budget_of(const Query& query, const Quantisation& quantisation);

/// The numbers of the budget that the user gave; nullopt if none was given.
std::optional<ErrorBudget> given_errors(const QueryParameters& query);

}  // namespace clearway
