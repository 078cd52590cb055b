#pragma once

#include <tuple>

#include "clearway/ledger.hpp"
#include "core/describe/field.hpp"
#include "core/describe/finding.hpp"

namespace clearway {

/// How conflicts are compared with a ledger. Only what updates a ledger has the second one.
inline constexpr std::tuple kLedgerFields{
    Field{.member = &LedgerOptions::worse_by,
          .key = "worse_by",
          .option = "--worse-by",
          .group = OptionGroup::kConflicts,
          .help = "With --ledger: an accepted conflict is worse where it comes nearer, or needs a "
                  "larger shift or trim, by more than this",
          .usual = "0.02",
          .doc = "An accepted conflict is worse where it comes nearer, or needs a larger shift or "
                 "trim, by more than this, in metres; None stands for 0.02.",
          .range = FieldRange::kFromZero}};
inline constexpr std::tuple kLedgerUpdateFields{
    Field{.member = &LedgerOptions::update,
          .key = "update",
          .option = "--update",
          .group = OptionGroup::kConflicts,
          .help = "Write into the ledger what was found: rows for new conflicts, and when each was "
                  "last seen",
          .doc = "Whether to write into the ledger what was found; the files are made if they do "
                 "not exist."}};

/// A row of a ledger, in the order of its files. Its conflicts are written by hand.
inline constexpr std::tuple kLedgerRowColumns{
    FindingColumn{
        .member = &LedgerRow::key, .key = "key", .doc = "The name of the row in the table."},
    FindingColumn{.member = &LedgerRow::shown,
                  .key = "shown",
                  .doc = "Its status in this run: 'new', 'open', 'accepted', 'resolved', 'worse', "
                         "'expired', 'gone' or 'not-searched'."},
    FindingColumn{.member = &LedgerRow::status,
                  .key = "status",
                  .doc = "Its status in the table: 'new', 'open', 'accepted' or 'resolved'."},
    FindingColumn{.member = &LedgerRow::why,
                  .key = "why",
                  .doc = "Why it is shown so, in words; empty where there is nothing to say."},
    FindingColumn{
        .member = &LedgerRow::owner, .key = "owner", .doc = "The cell `owner` of the table."},
    FindingColumn{
        .member = &LedgerRow::comment, .key = "comment", .doc = "The cell `comment` of the table."},
    FindingColumn{.member = &LedgerRow::until,
                  .key = "until",
                  .doc = "The cell `until` of the table, the last day of an acceptance."},
    FindingColumn{.member = &LedgerRow::conflicts,
                  .key = "conflicts",
                  .doc = "The ids of the conflicts that belong to the row: a list of int.",
                  .is_in_files = false},
    FindingColumn{
        .member = &LedgerRow::box,
        .key = "box",
        .doc = "The box around its places, in metres; None where the ledger does not have them.",
        .is_in_files = false},
    FindingColumn{.member = &LedgerRow::first_seen,
                  .key = "first_seen",
                  .doc = "The day on which it was found first."},
    FindingColumn{.member = &LedgerRow::last_seen,
                  .key = "last_seen",
                  .doc = "The day on which it was found last."}};

/// What the ledger says of a conflict.
inline constexpr std::tuple kLedgerEntryColumns{
    FindingColumn{
        .member = &LedgerEntry::conflict, .key = "conflict", .doc = "The id of the conflict."},
    FindingColumn{.member = &LedgerEntry::status,
                  .key = "status",
                  .doc = "Its status: 'new', 'open', 'accepted', 'worse' or 'expired'."},
    FindingColumn{.member = &LedgerEntry::key,
                  .key = "key",
                  .doc = "The key of the row that decides; empty where it has none."},
    FindingColumn{.member = &LedgerEntry::why,
                  .key = "why",
                  .doc = "Why it is so, in words; empty where there is nothing to say."},
    FindingColumn{
        .member = &LedgerEntry::owner, .key = "owner", .doc = "The cell `owner` of that row."},
    FindingColumn{.member = &LedgerEntry::comment,
                  .key = "comment",
                  .doc = "The cell `comment` of that row."},
    FindingColumn{
        .member = &LedgerEntry::until, .key = "until", .doc = "The cell `until` of that row."}};

}  // namespace clearway
