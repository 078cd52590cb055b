#include "io/store/convert/conversion_journal.hpp"

#include <fcntl.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "core/describe/convert.hpp"
#include "core/util/format.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/files/xxh64.hpp"
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
constexpr const char* kMeaning = "store " CLEARWAY_VERSION ", records 1";

// The first bytes of a file of points, by which it is known.
constexpr std::array<char, 8> kPointsMagic{'C', 'L', 'W', 'Y', 'P', 'N', 'T', 'S'};

constexpr double kNever = std::numeric_limits<double>::infinity();

std::string yes_or_no(bool value) { return value ? "yes" : "no"; }

std::string state_text(const fs::path& path) {
  const FileState state = state_of(path);
  const auto time = [](std::int64_t seconds, std::int64_t nanoseconds) {
    std::string digits = std::to_string(nanoseconds);
    digits.insert(0, 9 - std::min<std::size_t>(9, digits.size()), '0');
    return std::to_string(seconds) + "." + digits;
  };
  return std::to_string(state[0]) + " bytes, modified at " + time(state[1], state[2]) +
         ", status changed at " + time(state[3], state[4]);
}

/// A path with the state of its file, or with the states of the files with poses in a folder.
std::string named_file_text(const fs::path& path) {
  if (path.empty()) return "none";
  std::error_code unknown;
  if (!fs::is_directory(path, unknown)) return path.string() + ", " + state_text(path);
  std::vector<std::string> states;
  for (const auto& entry : fs::directory_iterator(path)) {
    // Other files, such as those of this conversion, may come and go.
    const std::string ending = entry.path().extension().string();
    if (ending != ".pose" && ending != ".frames") continue;
    states.push_back(entry.path().string() + state_text(entry.path()));
  }
  std::ranges::sort(states);
  Xxh64Stream hash;
  for (const std::string& state : states) hash.update(std::as_bytes(std::span(state)));
  return path.string() + ", files " + hash_text(hash.digest());
}

std::string value_text(bool value) { return yes_or_no(value); }
std::string value_text(double value) { return format_number(value); }
std::string value_text(int value) { return std::to_string(value); }
std::string value_text(std::uint32_t value) { return std::to_string(value); }
std::string value_text(std::uint64_t value) { return std::to_string(value); }
std::string value_text(const std::optional<double>& value) {
  return value ? format_number(*value) : "none";
}
std::string value_text(const FileUnit& unit) {
  return format_number(unit.metres()) + (unit.is_any_foot() ? " (any foot)" : "");
}
std::string value_text(const fs::path& path) { return named_file_text(path); }
std::string value_text(const Vec3& v) {
  return format_number(v.x) + " " + format_number(v.y) + " " + format_number(v.z);
}
std::string value_text(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : ",") + value;
  return text.empty() ? "none" : text;
}

std::string value_text(const TrajectoryOptions& path) {
  return "format " + std::to_string(static_cast<int>(path.format)) + ", non-rigid " +
         yes_or_no(path.allow_non_rigid) + ", angles " +
         std::to_string(static_cast<int>(path.angle_unit)) + " " +
         std::to_string(static_cast<int>(path.angle_frame)) + ", crs " + path.crs + ", datum " +
         path.datum + ", unit " + value_text(path.metres_per_unit);
}

/// Whether the bytes of a store do not depend on the option.
bool is_free(const std::string& key) {
  return key == "memory_bytes" || key == "threads" || key == "overwrite" || key == "resume";
}

JournalIdentity identity_of(const ConversionOptions& options, bool replaces) {
  JournalIdentity identity{{kJournalOfConversion, kMeaning}, {kOverwrites, yes_or_no(replaces)}};
  for_each_field(kConvertFields, [&](const auto& field) {
    if (!is_free(field.key)) identity.emplace_back(field.key, value_text(field.of(options)));
  });
  identity.emplace_back("reading of paths", value_text(options.path_options));
  std::size_t number = 0;
  for (const fs::path& file : with_pose_files(list_point_files(options.inputs))) {
    identity.emplace_back("input " + std::to_string(++number), named_file_text(file));
  }
  return identity;
}

std::string value_of(const JournalIdentity& identity, const std::string& name) {
  for (const auto& [field, value] : identity) {
    if (field == name) return value;
  }
  return {};
}

std::string shortened(std::string text) {
  constexpr std::size_t kMost = 600;
  if (text.size() <= kMost) return text;
  std::size_t end = kMost;
  while (end > 0 && (text[end] & 0xc0) == 0x80) --end;  // do not cut within a character
  return text.substr(0, end) + " ...";
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

}  // namespace

bool unfinished_overwrites(const fs::path& output) {
  const auto read = conversion_at(journal_of(output));
  return read && value_of(*read->identity(), kOverwrites) == yes_or_no(true);
}

bool remove_left_over(const ConversionOptions& options) {
  const fs::path& output = options.output;
  const auto read = conversion_at(journal_of(output));
  if (!read) return true;
  const bool replaces = value_of(*read->identity(), kOverwrites) == yes_or_no(true);
  if (!difference(*read->identity(), identity_of(options, replaces)).empty()) return false;
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
    const std::string differs = difference(*read_->identity(), identity_);
    if (!differs.empty()) {
      throw UsageError(
          path_.string() + ": belongs to another conversion: its " + shortened(differs),
          Remedy::kRestoreOptions);
    }
    for (std::size_t i = 0; i < files_; ++i) {
      refuse_other_file(points_path(i), has_points_magic(points_path(i)));
    }
    refuse_other_file(aside_path(), is_file(aside_path()));
    log_.note(path_.string() + ": resumes with " + work_text());
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
  if (!options_.resume) {
    throw UsageError(path_.string() + ": an unfinished conversion, " + work_text(),
                     Remedy::kResumeOrOverwrite);
  }
  if (!read.torn().empty()) {
    log_.note(path_.string() + ": " + read.torn() + "; it is cut off and done again");
  }
  replaces_ = value_of(*read.identity(), kOverwrites) == yes_or_no(true);
  read_.emplace(std::move(read));
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
  return has_read || counted_part_ || counted_ || !batches_.empty();
}

std::string ConversionJournal::work_text() const {
  if (!units_.empty()) return counted(written_cells_, "cell") + " written";
  if (distributed_) return "all points distributed";
  const std::uint64_t records = batches_.empty() ? 0 : batches_.back().counts.input_points;
  if (records > 0) return counted(records, "point") + " distributed";
  if (counted_) return "all points counted";
  return counted_part_ ? "some points counted" : "no points counted";
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
  distributed_.reset();
}

void ConversionJournal::keep_batch(DistributedBatch& batch) {
  keep(kBatch, [&](JournalValues& values) { values.add(batch); });
}

void ConversionJournal::take_distributed(const std::function<void(JournalValues&)>& use) {
  take(distributed_, use);
}

void ConversionJournal::keep_distributed(const std::function<void(JournalValues&)>& what) {
  keep(kDistributed, what);
  distributed_ = 0;
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
    const ParallelScope scope;
    const auto check = piece_of(scope, [&](std::size_t i) {
      std::vector<std::byte> bytes;
      for (const ChunkPlace& chunk : cells[i].chunks) {
        if (is_whole && !read_chunk(*written_, size, chunk, bytes)) is_whole = false;
      }
    });
    scope.begin();
    tbb::parallel_for(std::size_t{0}, cells.size(), check);
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
  log_.note(options_.output.string() + ": " + work_text() + "; --resume goes on from there with " +
            files + " (" + format_size(bytes) + "), and --force removes these files");
}

void ConversionJournal::discard() {
  remove_work_of(options_.output);
  if (writer_->file().is_at(path_)) remove_file(path_);
}

}  // namespace clearway
