#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/ledger.hpp"
#include "clearway/query.hpp"
#include "core/util/progress.hpp"
#include "findings/ledger/ledger_places.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Finds out whether a run would have found what was at some places, and shows so that nothing is
/// there any more (docs/design/findings.md, "Gone").
class LedgerEvidence {
 public:
  /// found: the result and its poses. find: with the model or bodies. options: with the store. All
  /// of them outlive this object. Throws InputError where store, model, bodies or poses are not
  /// those of the result.
  LedgerEvidence(const GroupedResult& found, const ConflictOptions& find,
                 const LedgerOptions& options, Progress& progress);

  /// For each row why it is not shown to be gone; empty where it is. No point of the result is near
  /// any of its places.
  std::vector<std::string> why_not_gone(std::span<const LedgerPlaces* const> rows) const;

 private:
  /// The poses from the first to the last one that a place collides at; none where it does not.
  using Touch = std::optional<PoseRange>;

  bool knows_all() const { return store_ != nullptr && !query_.empty(); }
  Query question() const;
  std::vector<std::vector<Touch>> search(std::span<const LedgerPlaces* const> rows) const;
  std::string of_search(const std::vector<Touch>& touches) const;
  std::string of_warnings(const std::vector<Touch>& touches) const;
  std::string of_withheld(const LedgerPlaces& row) const;
  void look_at_store(std::span<const LedgerPlaces* const> rows,
                     std::vector<std::string>& reasons) const;

  const GroupedResult& found_;
  const LedgerOptions& options_;
  const StoreReader* store_;
  std::vector<Query> query_;  ///< the question of the run for points in memory; empty: not known
  Progress& progress_;
  const int threads_;
};

}  // namespace clearway
