#include "clearway/session.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/describe/search.hpp"
#include "python/arrays.hpp"
#include "python/columns.hpp"
#include "python/fields.hpp"
#include "python/model.hpp"
#include "python/store.hpp"
#include "python/values.hpp"
#include "python/watch.hpp"

namespace clearway::python {
namespace {

using namespace py::literals;

/// How one question of a session is asked.
constexpr std::tuple kQuestionFields{kEngine<QuestionOptions>, kStrict<QuestionOptions>};

/// Queries that still hold the copy of a Model, so that further questions about the same Model need
/// not copy it. A Model cannot be changed from Python, which arrays can, so arrays are copied for
/// every question. Used with the GIL.
class KeptQueries {
 public:
  /// A query on loan for one question.
  class Loan {
   public:
    Loan(KeptQueries& queries, const ArrayQuery& query)
        : queries_(queries), model_(query.model), lent_(queries.take(query.model)) {
      ask(query, *lent_);
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() { queries_.give_back(model_, std::move(lent_)); }

    const Query& query() const { return *lent_; }

   private:
    KeptQueries& queries_;
    const py::object model_;
    std::unique_ptr<Query> lent_;
  };

  void forget_all() { idle_.clear(); }

  /// Bytes of the copies that no question uses now.
  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const Idle& one : idle_) {
      const Model& model = one.query->model;
      sum += model.vertices.size() * sizeof(model.vertices[0]) +
             model.triangles.size() * sizeof(model.triangles[0]) +
             model.solid_of.size() * sizeof(model.solid_of[0]);
    }
    return sum;
  }

 private:
  struct Idle {
    py::object model;
    std::unique_ptr<Query> query;
  };

  /// How many are kept, which is how many threads can ask about one model without copying it.
  static constexpr std::size_t kMostIdle = 8;

  std::unique_ptr<Query> take(const py::object& model) {
    for (auto idle = idle_.begin(); idle != idle_.end(); ++idle) {
      if (!idle->model.is(model)) continue;
      std::unique_ptr<Query> query = std::move(idle->query);
      idle_.erase(idle);
      return query;
    }
    auto query = std::make_unique<Query>();
    query->model = model_of(model);
    return query;
  }

  void give_back(const py::object& model, std::unique_ptr<Query> query) {
    if (!py::isinstance<Model>(model)) return;
    query->poses = {};
    query->bodies = {};
    idle_.push_front({model, std::move(query)});
    if (idle_.size() > kMostIdle) idle_.pop_back();
  }

  std::list<Idle> idle_;  ///< the most recently used one first
};

/// A session that several Python threads share, until one of them closes it.
class SharedSession {
 public:
  SharedSession(const std::filesystem::path& path, const SessionOptions& options)
      : session_(std::make_shared<const Session>(path, options)), path_(path) {}

  /// The session, which stays open as long as the returned pointer. Throws UsageError once it is
  /// closed.
  std::shared_ptr<const Session> opened() const {
    if (session_) return session_;
    throw UsageError("the session of " + path_.string() +
                     " is closed; open the store again with clearway.Session(path)");
  }
  bool is_closed() const { return session_ == nullptr; }
  const std::filesystem::path& path() const { return path_; }

  /// Questions that are being answered still have the session, and come to their end.
  void close() {
    queries.forget_all();
    without_gil([last = std::exchange(session_, nullptr)]() mutable {
      last.reset();
      return true;
    });
  }

  KeptQueries queries;

 private:
  std::shared_ptr<const Session> session_;
  const std::filesystem::path path_;
};

void add_session_answer(py::module_& module) {
  // The arrays keep the answer itself alive, which keeps its tables.
  py::class_<SessionAnswer, SearchReport>(
      module, "SessionAnswer",
      "What a session found, an Answer with its tables in memory.\n\n"
      "The arrays are made of the tables without a copy. They cannot be written to, and they stay "
      "when the answer and the session are gone.")
      .def_property_readonly(
          "collisions",
          [](const py::object& self) {
            const auto& answer = self.cast<const SessionAnswer&>();
            return collision_columns(answer.collisions(), answer.parameters, !answer.bodies.empty(),
                                     SharedArrays{self});
          },
          "The colliding points: Collisions.")
      .def_property_readonly(
          "near",
          [](const py::object& self) {
            const auto& answer = self.cast<const SessionAnswer&>();
            return near_columns(answer.near(), answer.parameters, !answer.bodies.empty(),
                                SharedArrays{self});
          },
          "The points that do not collide but may in truth, by the error budget: Collisions, whose "
          "last_pose and certain are None. None without a budget.")
      .def_property_readonly(
          "clearances",
          [](const py::object& self) {
            const auto& answer = self.cast<const SessionAnswer&>();
            return clearance_columns(answer.clearances(), answer.parameters, SharedArrays{self});
          },
          "The distances of the points that are closer than the clearance: Clearances. None where "
          "the query did not ask for them.")
      .def_property_readonly(
          "profile",
          [](const py::object& self) {
            const auto& answer = self.cast<const SessionAnswer&>();
            return profile_columns(answer.profile(), answer.parameters, SharedArrays{self});
          },
          "The least distance at every pose: a Profile. None where the query did not ask for it.")
      .def_property_readonly(
          "unseen",
          [](const py::object& self) {
            const auto& answer = self.cast<const SessionAnswer&>();
            return unseen_columns(answer.unseen(), answer.parameters, SharedArrays{self});
          },
          "The places that the model sweeps and no beam passed through: UnseenCubes. None where "
          "the query did not ask for seen space.")
      .def(
          "save",
          [](const SessionAnswer& answer, const py::object& path, bool overwrite) {
            without_gil([&, file = path_of(path)] {
              answer.save(file, overwrite);
              return true;
            });
          },
          "path"_a, "overwrite"_a = false,
          R"(save(self, path, overwrite=False)
--

Write the result file that search() writes for the same question, to be opened with Result.

path: the file of the result to write.
overwrite: replaces an existing file.)");
}

SessionAnswer answer_of(SharedSession& shared, const ArrayQuery& query,
                        const py::object& input_warnings, py::object progress, py::object message,
                        py::object stop, const py::kwargs& given) {
  const std::shared_ptr<const Session> session = shared.opened();
  require_radius(query);
  QuestionOptions options;
  set_fields(kQuestionFields, given, options);
  options.input_warnings = messages_of(input_warnings);
  const KeptQueries::Loan asked(shared.queries, query);
  Watch watch(std::move(progress), std::move(message), std::move(stop));
  watch.attach(options);
  return watch.run([&, rigid = !query.allow_non_rigid] {
    if (rigid) require_rigid(asked.query());
    return session->search(asked.query(), options);
  });
}

void add_session_members(py::class_<SharedSession>& sessions) {
  sessions
      .def(
          "search", &answer_of, "query"_a, py::kw_only(), "input_warnings"_a = py::tuple(),
          "progress"_a = py::none(), "message"_a = py::none(), "stop"_a = py::none(),
          ("search(self, query, *, " + signature_of(kQuestionFields) +
           R"DOC(, input_warnings=(), progress=None, message=None, stop=None)
--

Find every point of the store within the query's radius of the moving model, in memory.

Returns a SessionAnswer, whose tables equal those of search(). Several threads may ask at once.
Ctrl-C stops the question and raises KeyboardInterrupt; the session can then be asked again.
Give the model as a Model where you ask often: an array is copied and checked for every question.
The other arguments are those of search().

query: the Query to answer.
)DOC" + lines_of(kQuestionFields) +
           R"DOC(input_warnings: messages of read_model() and read_trajectory(), which the answer then holds too.
progress: called with a ProgressUpdate, in this thread, up to 20 times a second.
message: called with each note and warning, a Message, in this thread.
stop: an object with is_set(), such as threading.Event. When it is set, Interrupted is raised.)DOC")
              .c_str())
      .def_property_readonly(
          "store",
          [](const SharedSession& shared) {
            const auto session = shared.opened();
            const Store& store = session->store();
            return std::make_unique<SharedStore>(std::shared_ptr<const Store>(session, &store));
          },
          "The Store that the session has open, which stays open as long as you keep it.")
      .def_property_readonly(
          "closed", [](const SharedSession& shared) { return shared.is_closed(); },
          "Whether the session was closed.")
      .def(
          "forget_models",
          [](SharedSession& shared) {
            const auto session = shared.opened();
            shared.queries.forget_all();
            session->forget_models();
          },
          "forget_models(self)\n--\n\n"
          "Forget the models that were asked about, which gives their memory back.")
      .def(
          "kept_bytes",
          [](const SharedSession& shared) {
            return shared.opened()->kept_bytes() + shared.queries.bytes();
          },
          "kept_bytes(self)\n--\n\n"
          "The bytes that are kept for questions to come, besides the mapped store.")
      .def("close", &SharedSession::close,
           "close(self)\n--\n\n"
           "Give back what the session holds. Questions that other threads are asking are still "
           "answered, and answers stay. The end of a with block closes it too.")
      .def("__enter__",
           [](const py::object& self) {
             self.cast<const SharedSession&>().opened();
             return self;
           })
      .def("__exit__", [](SharedSession& shared, const py::args&) { shared.close(); })
      .def("__repr__", [](const SharedSession& shared) {
        const std::string path = shared.path().string();
        if (shared.is_closed()) return text("<Session " + path + ": closed>");
        return text("<Session " + path + ": " +
                    std::to_string(shared.opened()->store().point_count()) + " points>");
      });
}

}  // namespace

void add_session(py::module_& module) {
  add_session_answer(module);
  py::class_<SharedSession> session(
      module, "Session",
      "A store that stays open for many questions, with the GPUs that were started and with what "
      "was built for the models that were asked about, so that a question of one pose takes "
      "milliseconds.\n\nSeveral threads may ask at once, and share the memory of the session.");
  session.def(py::init([](const py::object& path, const py::kwargs& given) {
                SessionOptions options;
                set_fields(kMachineFields<SessionOptions>, given, options);
                return without_gil([&, file = path_of(path)] {
                  return std::make_unique<SharedSession>(file, options);
                });
              }),
              "path"_a,
              ("__init__(self, path, *, " + signature_of(kMachineFields<SessionOptions>) + R"DOC()
--

Open a store for questions. Use it in a with block, which closes it at its end.

All questions together share the machine.

path: the file that convert() made.
)DOC" + lines_of(kMachineFields<SessionOptions>))
                  .c_str());
  add_session_members(session);
  add_checks(module, "Session", kMachineFields<SessionOptions>);
  add_checks(module, "Session.search", kQuestionFields);
}

}  // namespace clearway::python
