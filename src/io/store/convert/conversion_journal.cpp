#include "io/store/convert/conversion_journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <iterator>
#include <limits>
#include <map>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "core/util/shortened.hpp"
#include "io/files/xxh64.hpp"
#include "io/store/convert/conversion_identity.hpp"
#include "io/store/convert/input_files.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOverwrites = "overwrites";
// Changes whenever records, or what they rest on, change their meaning.
constexpr const char* kMeaning = "store " CLEARWAY_VERSION ", records 4";

// The name in an identity of an input.
constexpr const char* kInput = "input ";

// The first bytes of a file of points, by which it is known.
constexpr std::array<char, 8> kPointsMagic{'C', 'L', 'W', 'Y', 'P', 'N', 'T', 'S'};

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A moment after the beginning of 1970, as in "2026-06-30 12:34:56.123456789 UTC".
std::string utc_text(std::int64_t seconds, std::int64_t nanoseconds) {
  const std::time_t moment = seconds;
  std::tm parts{};
  std::array<char, 40> text{};
  if (::gmtime_r(&moment, &parts) == nullptr ||
      std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &parts) == 0) {
    return std::to_string(seconds) + " s";
  }
  std::string digits = std::to_string(nanoseconds);
  digits.insert(0, 9 - std::min<std::size_t>(9, digits.size()), '0');
  return std::string(text.data()) + "." + digits + " UTC";
}

/// What is known of the state of a file, by which it is known again.
struct StateField {
  const char* name;
  std::string (*of)(const FileState& state);
  /// The words before, between and after two different values
  const char *had, *has, *end;
};

constexpr std::array<StateField, 3> kStateFields{{
    {"bytes of ", [](const FileState& state) { return std::to_string(state[0]); }, " had ",
     " bytes when it began, and has ", " now"},
    {"time of ", [](const FileState& state) { return utc_text(state[1], state[2]); },
     " was last modified at ", " when it began, and at ", " now"},
    {"status of ", [](const FileState& state) { return utc_text(state[3], state[4]); },
     " was renamed, or its rights or links were changed: its status changed at ",
     " before it began, and at ", " since"},
}};
constexpr const char* kPoses = "poses in ";

/// Adds the state of a file, or a hash of the states of the files with poses in a folder. Its other
/// files, such as those of this conversion, may come and go.
void add_state(JournalIdentity& identity, const fs::path& path) {
  std::error_code unknown;
  if (fs::is_directory(path, unknown)) {
    JournalIdentity poses;
    for (const fs::path& file : files_behind(path)) add_state(poses, file);
    Xxh64Stream hash;
    for (const auto& [name, value] : poses) {
      const std::string state = fs::path(name).filename().string() + " " + value + " ";
      hash.update(std::as_bytes(std::span(state)));
    }
    identity.emplace_back(kPoses + known_path(path).string(), hash_text(hash.digest()));
    return;
  }
  for (const StateField& field : kStateFields) {
    identity.emplace_back(field.name + known_path(path).string(), field.of(state_of(path)));
  }
}

void add_file(JournalIdentity& identity, const std::string& name, const fs::path& path) {
  identity.emplace_back(name, path.empty() ? "none" : known_path(path).string());
  if (!path.empty()) add_state(identity, path);
}

JournalIdentity identity_of(const ConversionOptions& options, bool replaces) {
  JournalIdentity identity;
  add_option_texts(options, identity, add_file);
  std::erase_if(identity, [](const auto& option) {
    return option.first != "strict" && shapes_no_store(option.first);
  });
  identity.insert(identity.begin(),
                  {{kJournalOfConversion, kMeaning}, {kOverwrites, value_text(replaces)}});
  std::size_t number = 0;
  for (const fs::path& file : with_pose_files(list_point_files(options.inputs))) {
    add_file(identity, kInput + std::to_string(++number), file);
  }
  return identity;
}

std::string value_of(const JournalIdentity& identity, const std::string& name) {
  for (const auto& [field, value] : identity) {
    if (field == name) return value;
  }
  return {};
}

/// The inputs that an identity names, in their order.
std::vector<std::string> inputs_of(const JournalIdentity& identity) {
  std::vector<std::string> inputs;
  for (const auto& [name, value] : identity) {
    if (name.starts_with(kInput)) inputs.push_back(value);
  }
  return inputs;
}

/// Some paths in words, "a.las, b.las, c.las and 7 more".
std::string in_words(const std::vector<std::string>& paths) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> named(
      paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, paths.size())));
  if (paths.size() > kMost) named.push_back(format_count(paths.size() - kMost) + " more");
  return format_list(named);
}

/// What became of the files of an identity, one change of each in words.
std::vector<std::string> changes_in_words(const JournalIdentity& found,
                                          const JournalIdentity& wanted) {
  const std::map<std::string, std::string> values(wanted.begin(), wanted.end());
  std::vector<std::string> changes;
  std::string changed;  // the file that changed last
  for (const auto& [name, before] : found) {
    const auto at = values.find(name);
    if (at == values.end() || at->second == before) continue;
    const std::string& now = at->second;
    if (name.starts_with(kPoses)) {
      changes.push_back("the files with " + name + " have changed since it began");
    }
    for (const StateField& field : kStateFields) {
      if (!name.starts_with(field.name)) continue;
      const std::string path = name.substr(std::strlen(field.name));
      if (std::exchange(changed, path) == path) continue;
      changes.push_back(path + field.had + before + field.has + now + field.end);
    }
  }
  return changes;
}

/// What differs between the identity of an unfinished conversion and that of another one, in words;
/// empty where nothing does.
std::string difference_in_words(const JournalIdentity& found, const JournalIdentity& wanted) {
  if (found == wanted) return {};
  std::vector<std::string> parts;
  if (found.front() != wanted.front()) {
    return "another release began it, and its records may have another meaning";
  }
  const auto options_of = [](JournalIdentity identity) {
    std::erase_if(identity, [](const auto& field) {
      const auto begins = [&](const StateField& of) { return field.first.starts_with(of.name); };
      return field.first.starts_with(kInput) || field.first.starts_with(kPoses) ||
             std::ranges::any_of(kStateFields, begins);
    });
    return identity;
  };
  const std::string options = difference(options_of(found), options_of(wanted));
  if (!options.empty()) parts.push_back("its " + options);
  const std::vector<std::string> had = inputs_of(found), has = inputs_of(wanted);
  const auto without = [](std::vector<std::string> all, std::vector<std::string> others) {
    std::ranges::sort(all);
    std::ranges::sort(others);
    std::vector<std::string> left;
    std::ranges::set_difference(all, others, std::back_inserter(left));
    return left;
  };
  const std::vector<std::string> missing = without(had, has), more = without(has, had);
  if (!missing.empty()) {
    parts.push_back(missing.size() == 1 ? "its input " + missing[0] + " is not given"
                                        : format_count(missing.size()) +
                                              " of its inputs are not given: " + in_words(missing));
  }
  if (!more.empty()) {
    parts.push_back(more.size() == 1 ? more[0] + " is none of its inputs"
                                     : format_count(more.size()) +
                                           " files are none of its inputs: " + in_words(more));
  }
  if (missing.empty() && more.empty() && had != has) {
    parts.emplace_back("it has the same inputs in another order");
  }
  const std::vector<std::string> changes = changes_in_words(found, wanted);
  parts.insert(parts.end(), changes.begin(), changes.end());
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
  return text;
}

void remove_file(const fs::path& path) {
  std::error_code failed;
  fs::remove(path, failed);
  if (failed) throw ResourceError(path.string() + ": cannot remove: " + failed.message());
}

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(fs::symlink_status(path, unknown));
}

/// Whether a file begins as those of points do. The end of the process or of the system may have
/// cost the beginning, or left zeros in its place.
bool has_points_magic(const fs::path& path) {
  if (!is_file(path)) return false;
  const File file = File::open_regular(path);
  std::array<char, kPointsMagic.size()> found{};
  const auto size =
      static_cast<std::size_t>(std::min<std::uint64_t>(file.size_bytes(), found.size()));
  file.read_at(0, std::as_writable_bytes(std::span(found)).first(size));
  return std::equal(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(size),
                    kPointsMagic.begin()) ||
         found == decltype(found){};
}

/// Throws UsageError where something else is at the place of a temporary file.
void refuse_other_file(const fs::path& path, bool is_ours) {
  std::error_code unknown;
  if (!fs::exists(fs::symlink_status(path, unknown))) return;
  if (is_ours && fs::hard_link_count(path) == 1) return;
  throw UsageError(path.string() +
                   ": is where this output's temporary file has to be, and is another file; move "
                   "it away, or choose another output");
}

fs::path points_of(const fs::path& output, std::size_t file) {
  return output.string() + ".points-" + std::to_string(file + 1);
}

std::size_t point_files_of(const fs::path& output) {
  std::size_t files = 0;
  while (has_points_magic(points_of(output, files))) ++files;
  return files;
}

/// Removes the files of points that an unfinished conversion left beside its output.
void remove_points_of(const fs::path& output) {
  for (std::size_t file = point_files_of(output); file-- > 0;) remove_file(points_of(output, file));
}

/// The journal of a conversion at a path; nullopt where there is none.
std::optional<JournalReader> conversion_at(const fs::path& path) {
  if (!is_journal(path)) return std::nullopt;
  JournalReader read(path);
  if (!read.identity() || !is_of_conversion(*read.identity())) return std::nullopt;
  return read;
}

/// The journal of a conversion at a path, for a caller that does not own the output. It is nullopt
/// also where the owner cuts the journal shorter while it is read; the caller is then refused when
/// it tries to own the output.
std::optional<JournalReader> conversion_of_any_owner(const fs::path& path) {
  try {
    return conversion_at(path);
  } catch (const ResourceError&) {
    return std::nullopt;
  }
}

}  // namespace

bool unfinished_overwrites(const fs::path& output) {
  const auto read = conversion_of_any_owner(journal_of(output));
  return read && value_of(*read->identity(), kOverwrites) == value_text(true);
}

bool remove_left_over(const ConversionOptions& options) {
  const fs::path& output = options.output;
  const auto read = conversion_of_any_owner(journal_of(output));
  if (!read) return true;
  const bool replaces = value_of(*read->identity(), kOverwrites) == value_text(true);
  if (*read->identity() != identity_of(options, replaces)) return false;
  const PendingFile owned(output, true);
  if (!conversion_at(journal_of(output))) return true;
  remove_points_of(output);
  remove_file(journal_of(output));
  return true;
}

void give_way_to_stream(PendingFile& pending, const ConversionOptions& options) {
  const fs::path journal = journal_of(options.output);
  if (!conversion_at(journal)) return;
  if (!options.overwrite) {
    pending.keep(true);
    throw UsageError(journal.string() + ": belongs to an unfinished conversion",
                     Remedy::kOverwrite);
  }
  remove_points_of(options.output);
  remove_file(journal);
}

const char* in_words(ConversionPhase phase) {
  switch (phase) {
    case ConversionPhase::kInspected:
      return "the inputs were inspected";
    case ConversionPhase::kCounted:
      return "all points were counted";
    case ConversionPhase::kDistributed:
      return "all points were distributed";
  }
  return "";
}

ConversionJournal::ConversionJournal(PendingFile& pending, const ConversionOptions& options,
                                     MessageLog& log)
    : pending_(pending),
      options_(options),
      log_(log),
      path_(journal_of(options.output)),
      replaces_(options.overwrite && fs::exists(options.output)) {
  find_earlier();
  const JournalIdentity identity = identity_of(options_, replaces_);
  if (read_) {
    const std::string differs = difference_in_words(*read_->identity(), identity);
    if (!differs.empty()) {
      throw UsageError(
          path_.string() + ": belongs to another conversion: " + shortened(differs, 600),
          Remedy::kRestoreOptions);
    }
    refuse_other_file(points_of(options_.output, point_files()), false);
    log_.note(path_.string() + ": goes on with an unfinished conversion; " + in_words(*finished_));
    writer_.emplace(JournalWriter::resume(path_, *read_, kNever));
    pending_.keep(false);
    return;
  }
  pending_.keep(false);
  if (!unwanted_.empty()) {
    log_.note(path_.string() + ": " + unwanted_);
    remove_points();
    remove_file(path_);
  }
  try {
    writer_.emplace(JournalWriter::create(path_, identity, kNever));
  } catch (const ResourceError&) {
    std::error_code unknown;
    fs::remove(path_, unknown);  // a journal without its beginning, on a full disk
    throw;
  }
}

void ConversionJournal::find_earlier() {
  std::error_code none;
  if (!fs::exists(fs::symlink_status(path_, none))) return;
  // It may be part of what the journal is about, and stays where the journal is refused.
  pending_.keep(fs::file_size(pending_.partial()) > 0);
  if (!is_file(path_) || fs::hard_link_count(path_) > 1 ||
      (fs::file_size(path_) > 0 && !is_journal(path_))) {
    throw UsageError(
        path_.string() +
        ": is where this output's journal has to be, but is no journal; move it away, or "
        "choose another output");
  }
  if (options_.overwrite) {
    unwanted_ =
        "the journal of an unfinished conversion was removed, and the conversion starts from the "
        "beginning";
    return;
  }
  JournalReader read(path_);
  const bool is_empty = !read.identity() || read.identity()->empty();
  if (!is_empty && !is_of_conversion(*read.identity())) {
    throw UsageError(path_.string() +
                     ": is the journal of an unfinished run; finish it, or choose another output");
  }
  // Records of another release may mean something else, and the comparison of identities says so.
  const bool is_known = is_empty || read.identity()->front().second == kMeaning;
  if (!is_empty && is_known) {
    read.for_each([&](JournalPayload payload) {
      const auto phase = payload.take<ConversionPhase>();
      if (*in_words(phase) == 0) payload.refuse("is of an unknown kind");
      finished_ = phase;
    });
  }
  if (is_known && !finished_) {
    unwanted_ = "nothing in it yet, starts from the beginning";
    return;
  }
  if (!options_.resume) {
    throw UsageError(path_.string() + ": is the journal of an unfinished conversion" +
                         (finished_ ? std::string("; ") + in_words(*finished_) : std::string()),
                     Remedy::kResumeOrOverwrite);
  }
  if (!read.torn().empty()) {
    log_.note(path_.string() + ": " + read.torn() + "; it is cut off and done again");
  }
  replaces_ = value_of(*read.identity(), kOverwrites) == value_text(true);
  read_.emplace(std::move(read));
}

bool ConversionJournal::take(ConversionPhase phase,
                             const std::function<void(JournalValues&)>& use) const {
  if (!read_ || finished_ < phase) return false;
  bool found = false;
  read_->for_each([&](JournalPayload payload) {
    if (payload.take<ConversionPhase>() != phase) return;
    JournalValues values(payload);
    use(values);
    found = true;
  });
  return found;
}

void ConversionJournal::keep(ConversionPhase phase,
                             const std::function<void(JournalValues&)>& what) {
  JournalRecord record;
  record.put(phase);
  JournalValues values(record);
  what(values);
  writer_->append(record);
  finished_ = phase;
  if (options_.journalled) options_.journalled();
}

std::size_t ConversionJournal::point_files() const { return point_files_of(options_.output); }

std::vector<File> ConversionJournal::open_points(std::size_t files) {
  if (finished_ == ConversionPhase::kDistributed) {
    files = point_files();
  } else {
    remove_points();
  }
  std::vector<File> opened;
  for (std::size_t i = 0; i < files; ++i) {
    const fs::path path = points_of(options_.output, i);
    refuse_other_file(path, has_points_magic(path));
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) throw system_failure(path.string() + ": cannot create", errno);
    opened.push_back(File::adopt(descriptor, path.string()));
    opened.back().write_at(0, std::as_bytes(std::span(kPointsMagic)));
  }
  return opened;
}

void ConversionJournal::remove_points() { remove_points_of(options_.output); }

void ConversionJournal::remove_after_publication() {
  if (!writer_->file().is_at(path_)) return;
  try {
    remove_file(path_);
  } catch (const ResourceError& error) {
    log_.warn("journal-left", std::string(error.what()) + "; the store is complete");
  }
}

void ConversionJournal::leave() {
  if (!finished_) return discard();
  const std::size_t files = point_files();
  std::uint64_t bytes = fs::file_size(path_);
  for (std::size_t i = 0; i < files; ++i) bytes += fs::file_size(points_of(options_.output, i));
  std::string names = path_.filename().string();
  if (files > 0) names += ", " + points_of(options_.output, 0).filename().string();
  if (files > 1) names += " to " + std::to_string(files);
  log_.note(options_.output.string() + ": is not finished; " + in_words(*finished_) +
            ". --resume goes on from there with " + names + " (" + format_size(bytes) +
            "), and --force removes these files");
}

void ConversionJournal::discard() {
  remove_points();
  if (writer_->file().is_at(path_)) remove_file(path_);
}

}  // namespace clearway
