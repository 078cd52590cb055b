#include "clearway/session.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include "clearway/error.hpp"
#include "io/files/pending_file.hpp"
#include "search/answer_question.hpp"
#include "search/check_query.hpp"
#include "search/session_state.hpp"

namespace clearway {

struct SessionAnswer::Tables : AnswerInMemory {
  std::filesystem::path store;  ///< which no output may overwrite

  /// Sets the profile's distance at the poses where no body has a pose: NaN in memory, and infinity
  /// in a file, which Result::profile() turns into NaN.
  static void set_distance_without_bodies(const ResultFindings& findings, double distance,
                                          ResultTables& tables) {
    for (const auto& [first, last] : findings.without_bodies) {
      std::fill_n(tables.profile.distance.begin() + first, last - first + 1, distance);
    }
  }
};

SessionAnswer::SessionAnswer() : tables_(std::make_shared<Tables>()) {}
SessionAnswer::~SessionAnswer() = default;
SessionAnswer::SessionAnswer(const SessionAnswer&) = default;
SessionAnswer::SessionAnswer(SessionAnswer&&) noexcept = default;
SessionAnswer& SessionAnswer::operator=(const SessionAnswer&) = default;
SessionAnswer& SessionAnswer::operator=(SessionAnswer&&) noexcept = default;

const Collisions& SessionAnswer::collisions() const { return tables_->collisions; }
const Clearances& SessionAnswer::clearances() const { return tables_->clearances; }
const Profile& SessionAnswer::profile() const { return tables_->profile; }
const Nearby& SessionAnswer::near() const { return tables_->near; }
const UnseenCubes& SessionAnswer::unseen() const { return tables_->unseen; }

void SessionAnswer::save(const std::filesystem::path& output, bool overwrite) const {
  refuse_overwriting(output, {tables_->store});
  PendingFile pending(output, overwrite);
  const ResultFindings& findings = tables_->findings;
  if (findings.without_bodies.empty()) {
    write_tables(*tables_, tables_->header, findings, pending.partial());
  } else {
    ResultTables of_file = *tables_;
    Tables::set_distance_without_bodies(findings, std::numeric_limits<double>::infinity(), of_file);
    write_tables(of_file, tables_->header, findings, pending.partial());
  }
  pending.publish();
}

struct Session::State {
  State(const std::filesystem::path& path, const SessionOptions& machine)
      : store(path),
        options(machine),
        for_search(search_options(machine)),
        session(store, for_search, KeptModels::Kept::kForSession) {
    check_gpus(for_search);
    store.reader().survive_faults();
    if (may_take_gpus(for_search) && !fallback_allowed(for_search)) {
      session.start_surely(for_search);
    }
  }

  static SearchOptions search_options(const SessionOptions& machine) {
    SearchOptions options;
    options.device = machine.device;
    options.gpus = machine.gpus;
    options.threads = machine.threads;
    options.memory_bytes = machine.memory_bytes;
    options.device_memory_bytes = machine.device_memory_bytes;
    return options;
  }

  const Store store;
  const SessionOptions options;
  const SearchOptions for_search;
  SessionState session;
};

Session::Session(const std::filesystem::path& store, const SessionOptions& options)
    : state_(std::make_unique<State>(store, options)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

const Store& Session::store() const { return state_->store; }
const SessionOptions& Session::options() const { return state_->options; }
void Session::forget_models() const { state_->session.forget(); }
std::uint64_t Session::kept_bytes() const { return state_->session.kept_bytes(); }

SessionAnswer Session::search(const Query& query, const QuestionOptions& asked) const {
  SearchOptions options = state_->for_search;
  options.engine = asked.engine;
  options.strict = asked.strict;
  options.input_warnings = asked.input_warnings;
  options.progress = asked.progress;
  options.message = asked.message;
  options.stop = asked.stop;
  const StoreReader& reader = state_->store.reader();
  reader.check_read();
  reader.check_unchanged();
  SessionAnswer answer;
  // Nobody keeps the session alive for an answer's sake, so the tables' memory may have nowhere to
  // go back to.
  const auto end =
      [spare = std::weak_ptr(state_->session.shared_spare())](SessionAnswer::Tables* tables) {
        const std::unique_ptr<SessionAnswer::Tables> ended(tables);
        if (const auto kept = spare.lock()) kept->keep(static_cast<ResultTables&&>(*ended));
      };
  const std::shared_ptr<SessionAnswer::Tables> tables(new SessionAnswer::Tables, end);
  const auto ask = [&] { return answer_question(state_->session, query, options, *tables); };
  try {
    static_cast<SearchReport&>(answer) = ask();
  } catch (const ResourceError& error) {
    // What is kept on the GPUs may be what there is too little memory for.
    if (error.remedy() != Remedy::kMoreDeviceMemory) throw;
    if (!state_->session.kept_on_gpus().give_way()) throw;
    static_cast<SearchReport&>(answer) = ask();
  } catch (const InputError&) {
    reader.check_read();  // which is why a cell may have seemed damaged
    throw;
  }
  reader.check_read();
  tables->store = state_->store.path();
  SessionAnswer::Tables::set_distance_without_bodies(
      tables->findings, std::numeric_limits<double>::quiet_NaN(), *tables);
  answer.tables_ = tables;
  return answer;
}

}  // namespace clearway
