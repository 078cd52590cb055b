#pragma once

#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "io/result/result_header.hpp"
#include "search/session_state.hpp"
#include "stream/write_result.hpp"

namespace clearway {

/// An answer with all that its file would have.
struct AnswerInMemory : ResultTables {
  ResultHeader header;
  ResultFindings findings;
};

/// Answers a question as search() does, in memory. Throws as search() does.
SearchReport answer_question(SessionState& session, const Query& query,
                             const SearchOptions& options, AnswerInMemory& answer);

}  // namespace clearway
