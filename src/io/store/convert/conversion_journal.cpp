#include "io/store/convert/conversion_journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
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
#include "io/files/parallel_loop.hpp"
#include "io/files/xxh64.hpp"
#include "io/store/convert/conversion_identity.hpp"
#include "io/store/convert/input_files.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// What a record is about, its first byte (docs/design/conversion.md).
enum Kind : std::uint8_t {
  kFound = 1,
  kCountedPart,
  kCounted,
  kPointFiles,
  kBegunBatch,
  kBatch,
  kDistributed,
  kBegunUnit,
  kUnit,
  kCutBatches,
  kCutUnits,
};

constexpr const char* kOverwrites = "overwrites";
// Changes whenever records, or what they rest on, change their meaning.
constexpr const char* kMeaning = "store " CLEARWAY_VERSION ", records 2";

// The names in an identity of an input, and of the state of a file that another name has.
constexpr const char* kInput = "input ";
constexpr const char* kState = "state of ";

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

constexpr const char* kBytes = " bytes";
constexpr const char* kModified = ", modified ";
constexpr const char* kChanged = ", status changed ";

/// The size of a file, and when its bytes and its status were changed last.
std::string state_text(const fs::path& path) {
  const FileState state = state_of(path);
  return std::to_string(state[0]) + kBytes + kModified + utc_text(state[1], state[2]) + kChanged +
         utc_text(state[3], state[4]);
}

/// The state of a file, or the hash of the states of the files with poses in a folder. Its other
/// files, such as those of this conversion, may come and go.
std::string state_of_all(const fs::path& path) {
  std::error_code unknown;
  if (!fs::is_directory(path, unknown)) return state_text(path);
  Xxh64Stream hash;
  for (const fs::path& file : files_behind(path)) {
    const std::string state = file.filename().string() + " " + state_text(file);
    hash.update(std::as_bytes(std::span(state)));
  }
  return hash_text(hash.digest());
}

void add_file(JournalIdentity& identity, const std::string& name, const fs::path& path) {
  identity.emplace_back(name, path.empty() ? "none" : known_path(path).string());
  if (!path.empty()) identity.emplace_back(kState + name, state_of_all(path));
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

/// The states of the files that an identity names, by their paths.
std::map<std::string, std::string> states_of(const JournalIdentity& identity) {
  std::map<std::string, std::string> states;
  for (std::size_t i = 1; i < identity.size(); ++i) {
    if (identity[i].first.starts_with(kState)) states[identity[i - 1].second] = identity[i].second;
  }
  return states;
}

/// Some paths in words, "a.las, b.las, c.las and 7 more".
std::string in_words(const std::vector<std::string>& paths) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> named(
      paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, paths.size())));
  if (paths.size() > kMost) named.push_back(format_count(paths.size() - kMost) + " more");
  return format_list(named);
}

/// A part of the state of a file: what follows `from`, up to `to`.
std::string part_of_state(const std::string& state, const char* from, const char* to) {
  const std::size_t begin = state.find(from);
  if (begin == std::string::npos) return {};
  const std::size_t first = begin + std::strlen(from);
  return state.substr(first, *to == 0 ? std::string::npos : state.find(to, first) - first);
}

/// What became of a file between two of its states, in words.
std::string change_text(const std::string& path, const std::string& before,
                        const std::string& now) {
  if (now.find(kModified) == std::string::npos) {
    return "the files with poses in " + path + " have changed since it began";
  }
  const auto bytes = [](const std::string& state) { return part_of_state(state, "", kBytes); };
  const auto modified = [](const std::string& state) {
    return part_of_state(state, kModified, kChanged);
  };
  if (bytes(before) != bytes(now)) {
    return path + " had " + bytes(before) + " bytes when it began, and has " + bytes(now) + " now";
  }
  if (modified(before) != modified(now)) {
    return path + " was last modified at " + modified(before) + " when it began, and at " +
           modified(now) + " now";
  }
  return path + " was renamed, or its rights or links were changed, at " +
         part_of_state(now, kChanged, "");
}

/// What differs between the identity of an unfinished conversion and that of another one, in words;
/// empty where nothing does.
std::string difference_in_words(const JournalIdentity& found, const JournalIdentity& wanted) {
  std::vector<std::string> parts;
  if (found.front() != wanted.front()) {
    return "another release began it, and its records may have another meaning";
  }
  const auto options_of = [](JournalIdentity identity) {
    std::erase_if(identity, [](const auto& field) {
      return field.first.starts_with(kInput) || field.first.starts_with(kState);
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
  const std::map<std::string, std::string> states = states_of(wanted);
  for (const auto& [path, before] : states_of(found)) {
    const auto now = states.find(path);
    if (now == states.end() || now->second == before) continue;
    parts.push_back(change_text(path, before, now->second));
  }
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

fs::path aside_of(const fs::path& output) { return output.string() + ".written"; }

void remove_points_of(const fs::path& output, std::size_t first) {
  for (; has_points_magic(points_of(output, first)); ++first) remove_file(points_of(output, first));
}

/// Removes all that an unfinished conversion left beside its output but the journal.
void remove_work_of(const fs::path& output) {
  remove_points_of(output, 0);
  if (is_file(aside_of(output))) remove_file(aside_of(output));
}

/// Whether a chunk of the file has the hash that it had when it was written.
bool read_chunk(const File& file, std::uint64_t size, const ChunkPlace& place,
                std::vector<std::byte>& bytes) {
  if (place.bytes > size || place.address > size - place.bytes) return false;
  bytes.resize(place.bytes);
  file.read_at(place.address, bytes);
  return xxh64(bytes) == place.xxh64;
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
  remove_work_of(output);
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
  remove_work_of(options.output);
  remove_file(journal);
}

ConversionJournal::ConversionJournal(PendingFile& pending, const ConversionOptions& options,
                                     MessageLog& log)
    : pending_(pending),
      options_(options),
      log_(log),
      path_(journal_of(options.output)),
      replaces_(options.overwrite && fs::exists(options.output)) {
  find_earlier();
  identity_ = identity_of(options_, replaces_);
  if (read_) {
    const std::string differs = difference_in_words(*read_->identity(), identity_);
    if (!differs.empty()) {
      throw UsageError(
          path_.string() + ": belongs to another conversion: " + shortened(differs, 600),
          Remedy::kRestoreOptions);
    }
    for (std::size_t i = 0; i < files_; ++i) {
      refuse_other_file(points_path(i), has_points_magic(points_path(i)));
    }
    refuse_other_file(aside_path(), is_file(aside_path()));
    log_.note(path_.string() + ": goes on with an unfinished conversion; " + work_text());
    writer_.emplace(JournalWriter::resume(path_, *read_, kNever));
    pending_.keep(false);
    return;
  }
  // Without a journal there is no unfinished conversion whose file this could be.
  if (unwanted_.empty()) refuse_other_file(aside_path(), false);
  pending_.keep(false);
  if (!unwanted_.empty()) {
    log_.note(path_.string() + ": " + unwanted_);
    remove_work_of(options_.output);
    remove_file(path_);
  }
  try {
    writer_.emplace(JournalWriter::create(path_, identity_, kNever));
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
  if (!is_empty && read.identity()->front().second == kMeaning) {
    std::uint64_t place = 0;
    read.for_each([&](JournalPayload payload) { read_record(payload, place++); });
  }
  if (!has_work() && (is_empty || read.identity()->front().second == kMeaning)) {
    unwanted_ = "nothing in it yet, starts from the beginning";
    found_.reset();
    begun_batches_ = 0;
    return;
  }
  distributed_records_ = batches_.empty() ? 0 : batches_.back().counts.input_points;
  if (!options_.resume) {
    throw UsageError(
        path_.string() + ": is the journal of an unfinished conversion; " + work_text(),
        Remedy::kResumeOrOverwrite);
  }
  if (!read.torn().empty()) {
    log_.note(path_.string() + ": " + read.torn() + "; it is cut off and done again");
  }
  replaces_ = value_of(*read.identity(), kOverwrites) == value_text(true);
  read_.emplace(std::move(read));
  take_last_hashes();
}

void ConversionJournal::read_record(JournalPayload payload, Place place) {
  const auto kind = payload.take<std::uint8_t>();
  JournalValues values(payload);
  std::uint64_t number = 0;
  switch (kind) {
    case kFound:
      values.add(found_.emplace());
      break;
    case kCountedPart:
      counted_part_ = place;
      break;
    case kCounted:
      counted_ = place;
      begun_batches_ = 0;
      break;
    case kPointFiles:
      values.add(number);
      files_ = number;
      break;
    case kBegunBatch:
      values.add(begun_batches_);
      break;
    case kBatch:
      values.add(batches_.emplace_back());
      batches_.back().hashes = {};
      places_of_batches_.push_back(place);
      break;
    case kDistributed:
      distributed_ = place;
      break;
    case kBegunUnit:
      values.add(begun_units_);
      break;
    case kUnit: {
      std::vector<WrittenCell> cells;
      values.add(cells);
      for (const WrittenCell& cell : cells) {
        for (const ChunkPlace& chunk : cell.chunks) {
          written_bytes_ = std::max(written_bytes_, chunk.address + chunk.bytes);
        }
      }
      written_cells_ += cells.size();
      units_.push_back(place);
      break;
    }
    case kCutBatches:
      values.add(number);
      batches_.resize(std::min<std::uint64_t>(batches_.size(), number));
      places_of_batches_.resize(batches_.size());
      distributed_.reset();
      break;
    case kCutUnits:
      values.add(number);
      units_.resize(std::min<std::uint64_t>(units_.size(), number));
      break;
    default:
      payload.refuse("is of an unknown kind");
  }
}

bool ConversionJournal::has_work() const {
  const bool has_read = found_ && (found_->chosen || !found_->readable.skipped.empty());
  return has_read || counted_part_ || counted_;
}

std::string ConversionJournal::work_text() const {
  if (!units_.empty()) {
    return "all points were distributed, and " + counted(written_cells_, "cell was", "cells were") +
           " written";
  }
  if (distributed_) return "all points were distributed";
  if (distributed_records_ > 0) {
    return "all points were counted, and " + format_count(distributed_records_) +
           (distributed_records_ == 1 ? " was" : " were") + " distributed";
  }
  if (counted_) return "all points were counted";
  return counted_part_ ? "a part of the points was counted" : "the inputs were inspected";
}

bool ConversionJournal::take(std::optional<Place> place,
                             const std::function<void(JournalValues&)>& use) const {
  if (!read_ || !place) return false;
  Place at = 0;
  read_->for_each([&](JournalPayload payload) {
    if (at++ != *place) return;
    payload.take<std::uint8_t>();
    JournalValues values(payload);
    use(values);
  });
  return true;
}

void ConversionJournal::append(JournalRecord& record) {
  writer_->append(record);
  if (options_.journalled) options_.journalled();
}

void ConversionJournal::keep(int kind, const std::function<void(JournalValues&)>& what) {
  JournalRecord record;
  record.put(static_cast<std::uint8_t>(kind));
  JournalValues values(record);
  what(values);
  append(record);
}

void ConversionJournal::keep_found(FoundInputs found) {
  if (found_) return;
  found_ = std::move(found);
  keep(kFound, [&](JournalValues& values) { values.add(*found_); });
}

bool ConversionJournal::wants_counted() {
  // Ever more rarely, so that the journal of a long pass does not grow without bounds; and no more
  // often than pauses take two hundredths of the time.
  constexpr double kShare = 0.02;
  const auto seconds = [](auto duration) {
    return std::chrono::duration<double>(duration).count();
  };
  const Clock::time_point now = Clock::now();
  if (options_.counted_interval_seconds > 0 &&
      seconds(now - counted_at_) <
          std::max({options_.counted_interval_seconds, kShare * seconds(now - begun_at_),
                    seconds(counted_at_ - paused_at_) / kShare})) {
    return false;
  }
  paused_at_ = now;
  return true;
}

bool ConversionJournal::take_counted_part(const std::function<void(JournalValues&)>& use) {
  return take(counted_part_, use);
}

void ConversionJournal::keep_counted_part(const std::function<void(JournalValues&)>& what) {
  keep(kCountedPart, what);
  counted_part_ = 0;
  counted_at_ = Clock::now();
}

bool ConversionJournal::take_counted(const std::function<void(JournalValues&)>& use) {
  return take(counted_, use);
}

void ConversionJournal::keep_counted(const std::function<void(JournalValues&)>& what) {
  keep(kCounted, what);
  counted_ = 0;
  begun_batches_ = 0;
}

void ConversionJournal::begin_batch(std::uint64_t number) {
  keep(kBegunBatch, [&](JournalValues& values) { values.add(number); });
}

void ConversionJournal::go_on_after_batches(std::uint64_t batches) {
  const std::uint64_t repeated = std::max(begun_batches_, batches) - batches;
  (counted_ ? repeated_batches_ : recounted_batches_) += repeated;
  begun_batches_ = 0;
}

std::vector<File> ConversionJournal::open_points(std::size_t files) {
  const bool is_new = files_ == 0;
  if (is_new) {
    files_ = files;
    keep(kPointFiles, [&](JournalValues& values) {
      std::uint64_t number = files;
      values.add(number);
    });
    remove_points_from(0);
  }
  std::vector<File> opened;
  for (std::size_t i = 0; i < files_; ++i) {
    const fs::path path = points_path(i);
    refuse_other_file(path, has_points_magic(path));
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) throw system_failure(path.string() + ": cannot create", errno);
    opened.push_back(File::adopt(descriptor, path.string()));
    opened.back().write_at(0, std::as_bytes(std::span(kPointsMagic)));
  }
  return opened;
}

void ConversionJournal::cut_batches(std::size_t batches) {
  if (batches == batches_.size()) return;
  std::uint64_t number = batches;
  keep(kCutBatches, [&](JournalValues& values) { values.add(number); });
  batches_.resize(batches);
  places_of_batches_.resize(batches);
  distributed_records_ = batches_.empty() ? 0 : batches_.back().counts.input_points;
  distributed_.reset();
  take_last_hashes();
}

/// Reads the hashes of the last batch, because a distribution goes on from them.
void ConversionJournal::take_last_hashes() {
  if (batches_.empty()) return;
  take(places_of_batches_.back(), [this](JournalValues& values) { values.add(batches_.back()); });
}

void ConversionJournal::forget_batches() {
  batches_ = {};
  places_of_batches_ = {};
}

std::uint64_t ConversionJournal::bytes_of_batches() const {
  constexpr std::uint64_t kFirst =
      sizeof(std::uint64_t);  // the index of the first point of a group
  std::uint64_t bytes = batches_.capacity() * sizeof(DistributedBatch) +
                        places_of_batches_.capacity() * sizeof(Place);
  for (const DistributedBatch& batch : batches_) {
    bytes += batch.groups.capacity() * (sizeof(DistributedBatch::Group) + kFirst) +
             batch.withheld_cubes.capacity() * sizeof(MetreCube);
  }
  return bytes;
}

void ConversionJournal::keep_batch(DistributedBatch& batch) {
  keep(kBatch, [&](JournalValues& values) { values.add(batch); });
  distributed_records_ = batch.counts.input_points;
}

void ConversionJournal::take_distributed(const std::function<void(JournalValues&)>& use) {
  take(distributed_, use);
  forget_batches();
}

void ConversionJournal::keep_distributed(const std::function<void(JournalValues&)>& what) {
  keep(kDistributed, what);
  distributed_ = 0;
  forget_batches();
}

void ConversionJournal::for_each_unit(
    const std::function<void(std::vector<WrittenCell>&)>& use) const {
  if (units_.empty()) return;
  Place at = 0;
  auto next = units_.begin();
  read_->for_each([&](JournalPayload payload) {
    if (next == units_.end() || at++ != *next) return;
    ++next;
    payload.take<std::uint8_t>();
    std::vector<WrittenCell> cells;
    JournalValues(payload).add(cells);
    use(cells);
  });
}

void ConversionJournal::check_units() {
  const bool is_aside = is_file(aside_path());
  if (units_.empty()) {
    if (is_aside) remove_file(aside_path());
    repeated_units_ = begun_units_;
    return;
  }
  if (is_aside && fs::file_size(aside_path()) >= written_bytes_) {
    written_.emplace(File::open_for_reading(aside_path()));
  } else {
    written_.emplace(pending_.set_aside(aside_path()));
  }
  const std::uint64_t size = written_->size_bytes();
  std::size_t whole = 0;
  bool all_whole = true;
  written_cells_ = 0;
  for_each_unit([&](std::vector<WrittenCell>& cells) {
    std::atomic<bool> is_whole = all_whole;
    for_each_parallel(cells.size(), [&](std::size_t i) {
      std::vector<std::byte> bytes;
      for (const ChunkPlace& chunk : cells[i].chunks) {
        if (is_whole && !read_chunk(*written_, size, chunk, bytes)) is_whole = false;
      }
    });
    all_whole = is_whole;
    if (!all_whole) return;
    ++whole;
    written_cells_ += cells.size();
  });
  if (begun_units_ > whole) repeated_units_ = begun_units_ - whole;
  if (whole == units_.size()) return;
  std::uint64_t number = whole;
  keep(kCutUnits, [&](JournalValues& values) { values.add(number); });
  units_.resize(whole);
}

void ConversionJournal::for_each_cell(const StoreMetadata& metadata,
                                      const std::function<void(const PackedCell&)>& use) {
  if (!written_) return;
  const std::uint64_t size = written_->size_bytes();
  std::vector<PackedColumn PackedCell::*> columns;
  if (metadata.classes) columns.push_back(&PackedCell::classes);
  if (metadata.origins) columns.push_back(&PackedCell::origins);
  for_each_unit([&](std::vector<WrittenCell>& cells) {
    for (WrittenCell& cell : cells) {
      PackedCell packed;
      packed.cell = cell.cell;
      packed.blocks = std::move(cell.blocks);
      if (cell.chunks.size() != packed.chunks.size() + columns.size()) {
        throw InputError(path_.string() + ": holds cells of another store");
      }
      for (std::size_t i = 0; i < cell.chunks.size(); ++i) {
        const ChunkPlace& place = cell.chunks[i];
        std::vector<std::byte> bytes;
        if (!read_chunk(*written_, size, place, bytes)) {
          throw ResourceError(written_->name() + ": changed while it was read");
        }
        if (i < packed.chunks.size()) {
          packed.chunks[i] = std::move(bytes);
          packed.xxh64[i] = place.xxh64;
        } else {
          packed.*columns[i - packed.chunks.size()] = {std::move(bytes), place.xxh64};
        }
      }
      use(packed);
    }
  });
  written_.reset();
  remove_file(aside_path());
}

void ConversionJournal::begin_unit(std::uint64_t number) {
  keep(kBegunUnit, [&](JournalValues& values) { values.add(number); });
}

void ConversionJournal::keep_unit(std::vector<WrittenCell>& cells) {
  keep(kUnit, [&](JournalValues& values) { values.add(cells); });
  written_cells_ += cells.size();
  units_.push_back(0);
}

fs::path ConversionJournal::points_path(std::size_t file) const {
  return points_of(options_.output, file);
}

fs::path ConversionJournal::aside_path() const { return aside_of(options_.output); }

void ConversionJournal::remove_points_from(std::size_t file) {
  remove_points_of(options_.output, file);
}

void ConversionJournal::remove_points() { remove_points_from(0); }

void ConversionJournal::remove_after_publication() {
  if (!writer_->file().is_at(path_)) return;
  try {
    remove_file(path_);
  } catch (const ResourceError& error) {
    log_.warn("journal-left", std::string(error.what()) + "; the store is complete");
  }
}

void ConversionJournal::leave() {
  if (!has_work()) return discard();
  std::uint64_t bytes = 0;
  const auto add = [&bytes](const fs::path& path) {
    std::error_code unknown;
    if (is_file(path)) bytes += fs::file_size(path, unknown);
  };
  // While units are copied from the file that was set aside, the other one is of no use.
  const bool is_aside = is_file(aside_path());
  if (!units_.empty() && !is_aside) pending_.keep(true);
  for (std::size_t i = 0; i < files_; ++i) add(points_path(i));
  for (const fs::path& path : {path_, aside_path(), pending_.partial()}) add(path);
  std::string files = path_.filename().string();
  if (files_ > 0) files += ", " + points_path(0).filename().string();
  if (files_ > 1) files += " to " + std::to_string(files_);
  if (is_aside) files += ", " + aside_path().filename().string();
  if (!units_.empty() && !is_aside) files += ", " + pending_.partial().filename().string();
  log_.note(options_.output.string() + ": is not finished; " + work_text() +
            ". --resume goes on from there with " + files + " (" + format_size(bytes) +
            "), and --force removes these files");
}

void ConversionJournal::discard() {
  remove_work_of(options_.output);
  if (writer_->file().is_at(path_)) remove_file(path_);
}

}  // namespace clearway
