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
inline constexpr std::tuple kLedgerUpdateFields{Field{
    .member = &LedgerOptions::update,
    .key = "update",
    .option = "--update",
    .group = OptionGroup::kConflicts,
    .help =
        "Write into the ledger what was found: rows for new conflicts, and when each was last seen",
    .doc = "Whether to write into the ledger what was found; the files are made if they do not "
           "exist."}};

/// A row of a ledger, in the order of its files. Its conflicts are written by hand.
inline constexpr std::tuple kLedgerRowColumns{
    column(&LedgerRow::key, "key", "The name of the row in the table."),
    column(&LedgerRow::shown, "shown",
           "Its status in this run: 'new', 'open', 'accepted', 'resolved', 'worse', 'expired', "
           "'gone' or 'not-searched'."),
    column(&LedgerRow::status, "status",
           "Its status in the table: 'new', 'open', 'accepted' or 'resolved'."),
    column(&LedgerRow::why, "why",
           "Why it is shown so, in words; empty where there is nothing to say."),
    column(&LedgerRow::owner, "owner", "The cell `owner` of the table."),
    column(&LedgerRow::comment, "comment", "The cell `comment` of the table."),
    column(&LedgerRow::until, "until",
           "The cell `until` of the table, the last day of an acceptance."),
    column(&LedgerRow::conflicts, "conflicts",
           "The ids of the conflicts that belong to the row: a list of int.",
           {.is_in_files = false}),
    column(&LedgerRow::box, "box",
           "The box around its places, in metres; None where the ledger does not have them.",
           {.is_in_files = false}),
    column(&LedgerRow::first_seen, "first_seen", "The day on which it was found first."),
    column(&LedgerRow::last_seen, "last_seen", "The day on which it was found last.")};

/// What the ledger says of a conflict.
inline constexpr std::tuple kLedgerEntryColumns{
    column(&LedgerEntry::conflict, "conflict", "The id of the conflict."),
    column(&LedgerEntry::status, "status",
           "Its status: 'new', 'open', 'accepted', 'worse' or 'expired'."),
    column(&LedgerEntry::key, "key", "The key of the row that decides; empty where it has none."),
    column(&LedgerEntry::why, "why",
           "Why it is so, in words; empty where there is nothing to say."),
    column(&LedgerEntry::owner, "owner", "The cell `owner` of that row."),
    column(&LedgerEntry::comment, "comment", "The cell `comment` of that row."),
    column(&LedgerEntry::until, "until", "The cell `until` of that row.")};

}  // namespace clearway
