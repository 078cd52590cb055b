#pragma once

#include "clearway/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// What a result's header alone tells of its answer, without counts of rows, places and doubts.
Answer answer_of(const ResultHeader& header);

/// Adds the doubts among these warnings to those that are known already.
void add_doubts(const std::vector<Message>& warnings, Answer& answer);

/// Adds what a search found beside its tables.
void add_findings(const ResultFindings& findings, Answer& answer);

/// The answer without what only the rows tell: its places, the points inside and the poses of the
/// profile. Reads no table.
Answer counted_answer(const ResultReader& result);

/// The answer that a result, or a part of one, holds. Reads all of its tables. Doubts are those
/// that the file keeps, and those that follow from its counts where an earlier release wrote it.
/// Throws as ResultReader does.
Answer answer_of(const ResultReader& result);

}  // namespace clearway
