#pragma once

#include <string>

#include "clearway/ledger.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// A ledger as JSON: the number of rows and conflicts without a row by status, then each row, each
/// conflict, and what is left without the accepted ones.
Json ledger_json(const Ledger& ledger);

/// The statuses with their numbers, such as "2 accepted, 1 gone"; "empty" where there is no row.
std::string ledger_counts_words(const Ledger& ledger);

/// How many conflicts are accepted, and what that leaves: "2 of 3 conflicts are accepted by the
/// ledger". Empty where the result has none.
std::string ledger_sentence(const Ledger& ledger);

}  // namespace clearway
