#include "search/run_journal.hpp"

#include <algorithm>
#include <optional>

#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "core/util/shortened.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/check_results.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReplaces = "overwrites";

std::string yes_or_no(bool value) { return value ? "yes" : "no"; }
std::string text_of(bool value) { return yes_or_no(value); }
std::string text_of(double value) { return format_number(value); }
std::string text_of(std::uint32_t value) { return std::to_string(value); }
std::string text_of(const std::optional<double>& value) {
  return value ? format_number(*value) : "none";
}

std::string classes_text(const ResultHeader& header) {
  std::string text;
  for (const std::uint8_t value : header.ignore_classes) {
    text += (text.empty() ? "" : " ") + std::to_string(value);
  }
  return text.empty() ? "none" : text;
}

std::string cells_text(std::uint64_t cells) { return counted(cells, "cell") + " finished"; }

std::string value_of(const JournalIdentity& identity, const std::string& name) {
  for (const auto& [field, value] : identity) {
    if (field == name) return value;
  }
  return "unknown";
}

JournalIdentity identity_of(const StoreReader& store, const ResultHeader& header,
                            const std::string& engine, const std::string& device, bool replaces) {
  JournalIdentity identity{{"environment", hash_text(store.fingerprint())},
                           {"model", hash_text(header.model_hash)},
                           {"model_as", model_as(header.model_solids, header.model_triangles)},
                           {"trajectory", hash_text(header.trajectory_hash)},
                           {"engine", engine},
                           {"device", device},
                           {kReplaces, yes_or_no(replaces)}};
  for_each_field(kQueryValues, [&](const auto& field) {
    identity.emplace_back(field.key, text_of(field.of(header)));
  });
  if (header.part) {
    identity.emplace_back("shard", to_string(header.part->shard));
    identity.emplace_back("division", hash_text(header.part->division));
  }
  if (header.ignores_points()) {
    identity.emplace_back("ignored_classes", classes_text(header));
    identity.emplace_back("ignored_boxes", boxes_text(header.ignore_boxes));
  }
  return identity;
}

/// How two queries differ, such as "radius: 0.1 m in the file, 0.2 m here; ..."; empty where both
/// ask the same.
std::string differences_text(const ResultHeader& found, const ResultHeader& asked) {
  constexpr std::size_t kMost = 80;  // bytes: a coordinate reference system may be long
  std::string text;
  const auto add = [&](const std::string& what, const std::string& a, const std::string& b) {
    text += (text.empty() ? "" : "; ") + what + ": " + shortened(a, kMost) + " in the file, " +
            shortened(b, kMost) + " here";
  };
  const auto part_text = [](const ResultHeader& header) {
    return header.part ? in_words(header.part->shard) : std::string("the whole result");
  };
  if (part_text(found) != part_text(asked)) add("part", part_text(found), part_text(asked));
  for (const QueryDifference& one : query_differences(found, asked)) add(one.what, one.a, one.b);
  return text;
}

void remove_file(const fs::path& path) {
  std::error_code failed;
  fs::remove(path, failed);
  if (failed) throw ResourceError(path.string() + ": cannot remove: " + failed.message());
}

/// Refuses the journal of a conversion, whose files of points a run would leave behind.
void refuse_conversion(const fs::path& path, const JournalReader& read) {
  if (!read.identity() || !is_of_conversion(*read.identity())) return;
  throw UsageError(path.string() +
                   ": is the journal of an unfinished conversion; finish it, or choose another "
                   "output");
}

}  // namespace

RunJournal::RunJournal(PendingFile& pending, const fs::path& output, const SearchOptions& options,
                       MessageLog& log)
    : pending_(pending),
      output_(output),
      options_(options),
      log_(log),
      path_(journal_of(output)),
      replaces_(options.overwrite && fs::exists(output)) {
  std::error_code none;
  if (!fs::exists(fs::symlink_status(path_, none))) {
    if (options.resume && !fs::exists(output)) {
      log_.note(path_.string() + ": no journal to resume, starts from the beginning");
    }
    return;
  }
  if (!fs::is_regular_file(fs::symlink_status(path_)) || fs::hard_link_count(path_) > 1 ||
      (fs::file_size(path_) > 0 && !is_journal(path_))) {
    throw UsageError(
        path_.string() +
        ": is where this output's journal has to be, but is no journal; move it away, or "
        "choose another output");
  }
  if (options.overwrite) {
    try {
      refuse_conversion(path_, JournalReader(path_));
    } catch (const InputError&) {
      // Whatever the damaged journal was about, it is not wanted.
    }
    unwanted_ = "journal of an unfinished run removed, starts from the beginning";
    return;
  }
  JournalReader read(path_);
  if (!read.identity() || read.records() == 0) {
    unwanted_ = "nothing in it yet, starts from the beginning";
    return;
  }
  refuse_conversion(path_, read);
  earlier_cells_ = answered_cells(read)[index_of(PointQuestion::kHits)];
  if (!options.resume) {
    throw UsageError(path_.string() + ": an unfinished run with engine " +
                         value_of(*read.identity(), "engine") + " on " +
                         value_of(*read.identity(), "device") + ", radius " +
                         value_of(*read.identity(), "radius") + ", " + cells_text(earlier_cells_),
                     Remedy::kResumeOrOverwrite);
  }
  if (!read.torn().empty()) {
    log_.note(path_.string() + ": " + read.torn() + "; it is cut off and computed again");
  }
  replaces_ = value_of(*read.identity(), kReplaces) == yes_or_no(true);
  read_.emplace(std::move(read));
}

bool RunJournal::already_done(const StoreReader& store, const ResultHeader& header,
                              Progress& progress) {
  if (replaces_) return false;
  if (options_.resume && fs::exists(output_) && is_of(store, header) &&
      is_intact_result(output_, header, progress)) {
    if (ResultReader(output_, Parts::kAccepted).header().notes != header.notes) {
      log_.note(output_.string() +
                ": answers the same question, but more or other things are known of the inputs "
                "now, so it is made again");
      return false;
    }
    if (read_ || !unwanted_.empty()) remove_file(path_);
    return true;
  }
  refuse_existing(header);
  pending_.refuse_existing();
  return false;
}

void RunJournal::refuse_existing(const ResultHeader& header) const {
  std::error_code unknown;
  if (!fs::is_regular_file(output_, unknown)) return;  // left to the pending file
  if (options_.resume) refuse_other_part(header);
  const Remedy overwrite = options_.resume ? Remedy::kOverwriteNotResume : Remedy::kOverwrite;
  const std::string exists = output_.string() + ": exists already, ";
  ResultHeader found;
  try {
    found = ResultReader(output_, Parts::kAccepted).header();
  } catch (const Error&) {
    if (!options_.resume) return;  // the pending file says that the output exists
    throw UsageError(exists + "and is no complete result", overwrite);
  }
  const std::string differences = differences_text(found, header);
  if (!differences.empty()) {
    throw UsageError(exists + "and answers another question than this run: " + differences,
                     overwrite);
  }
  if (options_.resume) throw UsageError(exists + "and is damaged", overwrite);
  throw UsageError(exists + "and answers the same question", Remedy::kReadOrOverwrite);
}

/// Throws UsageError where the output is a part in the place of a whole result, another part, or a
/// whole result in the place of a part.
void RunJournal::refuse_other_part(const ResultHeader& header) const {
  const auto words = [](const std::optional<ResultPart>& part) {
    return part ? in_words(part->shard) : std::string("the whole result");
  };
  std::string found;
  try {
    found = words(ResultReader(output_, Parts::kAccepted).header().part);
  } catch (const Error&) {
    return;  // the output does not exist, or is not a result
  }
  if (found == words(header.part)) return;
  throw UsageError(
      output_.string() + ": is " + found + ", and " + words(header.part) + " is asked for",
      Remedy::kOtherPart);
}

bool RunJournal::is_of(const StoreReader& store, const ResultHeader& header) const {
  if (!read_) return true;
  const JournalIdentity& earlier = *read_->identity();
  return difference(earlier, identity_of(store, header, value_of(earlier, "engine"),
                                         value_of(earlier, "device"), false))
      .empty();
}

SearchJournal& RunJournal::open(const StoreReader& store, const Query& query,
                                const ResultHeader& header, Engine engine, Device device) {
  const JournalIdentity identity =
      identity_of(store, header, name_of(engine), name_of(device), replaces_);
  if (read_) {
    const std::string differs = difference(*read_->identity(), identity);
    if (!differs.empty()) {
      throw UsageError(path_.string() + ": belongs to another run: its " + differs,
                       Remedy::kRestoreOptions);
    }
    log_.note(path_.string() + ": resumes with " + cells_text(earlier_cells_));
  }
  if (!unwanted_.empty()) {
    log_.note(path_.string() + ": " + unwanted_);
    remove_file(path_);
  }
  return results_.emplace(path_, identity, read_ ? &*read_ : nullptr, store, query,
                          options_.journal_interval_seconds);
}

Device RunJournal::earlier_device() const {
  if (!read_) return Device::kAuto;
  return value_of(*read_->identity(), "device") == name_of(Device::kCuda) ? Device::kCuda
                                                                          : Device::kCpu;
}

void RunJournal::remove_after_publication() {
  if (!results_->is_in_place()) return;
  try {
    remove_file(path_);
  } catch (const ResourceError& error) {
    log_.warn("journal-left", std::string(error.what()) + "; the result is complete");
  }
}

}  // namespace clearway
