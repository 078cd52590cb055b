#pragma once

#include <vector>

#include "clearway/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The answer as far as a result's header gives it: without numbers of rows, places and warnings.
Answer answer_of(const ResultHeader& header);

/// Whether two warnings say the same: by code and text, and by whether they are about stretches of
/// the path. Which stretches these are may differ, as among the parts of a result.
bool say_the_same(const Message& a, const Message& b);

/// Adds the stretches of a warning that says the same, and which the message does not have.
void unite_stretches(const Message& other, Message& message);

/// Adds those of the messages that are warnings. One that says the same as another adds its
/// stretches to that one.
void add_warnings(const std::vector<Message>& messages, std::vector<Message>& warnings);

/// Sets in `answer` what a search found besides its tables.
void add_findings(const ResultFindings& findings, Answer& answer);

/// Adds what rows say to the summary of those before them, which have smaller sources or, in a
/// profile, smaller poses: `first_pose` is that of the first row.
void summarise(const Collisions& rows, TableSummary& summary);
void summarise(const Nearby& rows, TableSummary& summary);
void summarise(const Clearances& rows, TableSummary& summary);
void summarise(const Profile& rows, TableSummary& summary, std::uint64_t first_pose = 0);

/// Adds the summary of later rows to that of those before them.
void add_summary(const TableSummary& later, TableSummary& summary);

/// The answer from the header, the findings and the numbers of rows. It lacks what only the rows
/// show: places, points inside the model and poses of the profile. Reads no table.
Answer counted_answer(const ResultReader& result);

/// The answer that a result, or a part of one, holds. Reads all of its tables. Throws as
/// ResultReader does.
Answer answer_of(const ResultReader& result);

}  // namespace clearway
