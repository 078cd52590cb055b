#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "clearway/session.hpp"
#include "core/describe/search.hpp"
#include "python/arrays.hpp"
#include "python/binding.hpp"
#include "python/objects.hpp"
#include "python/watch.hpp"

/// Results in files, and answers of a session in memory, whose tables have the same columns.
namespace clearway::python {
namespace {

template <typename Value>
using Column = py::array_t<Value>;
template <typename Value>
using AskedColumn = std::optional<Column<Value>>;  ///< none where the query did not ask for it

struct CollisionColumns {
  Column<std::uint64_t> source;
  Column<double> xyz;
  Column<std::uint8_t> point_class;
  AskedColumn<std::uint32_t> first_pose = {}, last_pose = {}, body = {};
  AskedColumn<bool> certain = {};
  AskedColumn<double> depth = {};
  AskedColumn<std::uint64_t> depth_source = {};
};
struct ClearanceColumns {
  Column<std::uint64_t> source;
  Column<double> xyz, distance;
  Column<std::uint32_t> pose, body;
  Column<std::uint8_t> point_class;
};
struct ProfileColumns {
  Column<std::uint64_t> source;
  Column<double> xyz, distance, chainage;
  Column<std::uint8_t> point_class;
};
struct UnseenColumns {
  Column<std::int32_t> cube;
  Column<std::uint32_t> first_pose, group;
};

constexpr std::tuple kCollisionFacts{
    fact<&CollisionColumns::source>(
        "The index of each point in the order of the scans, ascending: n uint64."),
    fact<&CollisionColumns::xyz>("The coordinates of the points: n x 3 float64, metres."),
    fact<&CollisionColumns::first_pose>("The first pose that touches each point: n uint32. None "
                                        "where the query did not ask for it."),
    fact<&CollisionColumns::last_pose>(
        "The last pose that touches each point: n uint32. Between poses, the start of the last way "
        "that does. None where the query did not ask for first poses."),
    fact<&CollisionColumns::body>(
        "The body that touches each point at its first pose, as an index of Result.bodies(): n "
        "uint32. None where there is one model, or the query did not ask for first poses."),
    fact<&CollisionColumns::certain>(
        "Whether the error budget says that each point is certainly too close: n bool. None "
        "without a budget, and for points that are only near."),
    fact<&CollisionColumns::depth>("The distance of each point to the nearest free point, which "
                                   "neither collides nor is ignored: n float64, metres; NaN where "
                                   "no point is free. None where the query did not ask for it."),
    fact<&CollisionColumns::depth_source>(
        "The index of that free point: n uint64; NO_POINT where no point is free. None where the "
        "query did not ask for it."),
    fact<&CollisionColumns::point_class>(
        "The class of each point, as the scans have it: n uint8. Empty unless they have classes.")};

constexpr std::tuple kUnseenFacts{
    fact<&UnseenColumns::cube>(
        "The indices of each cube along x, y and z, ascending: n x 3 int32."),
    fact<&UnseenColumns::first_pose>(
        "The first pose at which the model sweeps each cube: n uint32."),
    fact<&UnseenColumns::group>("The number of each cube's group, from 1 on: n uint32.")};

constexpr std::tuple kClearanceFacts{
    fact<&ClearanceColumns::source>(
        "The index of each point in the order of the scans, ascending: n uint64."),
    fact<&ClearanceColumns::xyz>("The coordinates of the points: n x 3 float64, metres."),
    fact<&ClearanceColumns::distance>(
        "The least distance of each point over all poses: n float64, metres."),
    fact<&ClearanceColumns::pose>(
        "The first pose at which each point has this distance: n uint32."),
    fact<&ClearanceColumns::body>("The body that is so close to the point there, as an index of "
                                  "Result.bodies(): n uint32. Empty where there is one model."),
    fact<&ClearanceColumns::point_class>(
        "The class of each point, as the scans have it: n uint8. Empty unless they have classes.")};

constexpr std::tuple kProfileFacts{
    fact<&ProfileColumns::distance>(
        "The least distance at each pose: n float64, metres; infinity where nothing is closer than "
        "the distance that was asked for, NaN where no body of a vehicle has a pose, because "
        "nothing is known there."),
    fact<&ProfileColumns::source>(
        "The index of the nearest point at each pose: n uint64; NO_POINT where there is none."),
    fact<&ProfileColumns::xyz>("The coordinates of the nearest point at each pose: n x 3 float64, "
                               "metres; NaN where there is none."),
    fact<&ProfileColumns::chainage>(
        "How far along the path each pose is: n float64, metres, from 0."),
    fact<&ProfileColumns::point_class>("The class of the nearest point at each pose, 0 where there "
                                       "is none: n uint8. Empty unless the scans have classes.")};

/// Makes arrays that take over the vectors of a table, which belong to the caller alone.
struct OwnArrays {
  template <typename Value>
  auto operator()(std::vector<Value>& values) const {
    return to_array(std::move(values));
  }
};

/// Makes arrays over the vectors of a table that `owner` keeps. They cannot be written to, because
/// all arrays of the table share it.
struct SharedArrays {
  py::object owner;

  template <typename Value>
  auto operator()(const std::vector<Value>& values) const {
    auto array = array_over(values, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
  }
};

/// The columns of a table, which `make` makes of its vectors.
template <typename Table, typename Make>
auto columns_of_table(Table& table, const QueryParameters& asked, bool has_bodies,
                      const Make& make) {
  if constexpr (requires { table.cube; }) {
    return UnseenColumns{make(table.cube), make(table.first_pose), make(table.group)};
  } else if constexpr (requires { table.chainage; }) {
    return ProfileColumns{make(table.source), make(table.xyz), make(table.distance),
                          make(table.chainage), make(table.point_class)};
  } else if constexpr (requires { table.distance; }) {
    return ClearanceColumns{make(table.source), make(table.xyz),  make(table.distance),
                            make(table.pose),   make(table.body), make(table.point_class)};
  } else {
    CollisionColumns columns{make(table.source), make(table.xyz), make(table.point_class)};
    if (asked.first_pose) {
      columns.first_pose = make(table.first_pose);
      if (has_bodies) columns.body = make(table.body);
    }
    if constexpr (requires { table.last_pose; }) {
      if (asked.first_pose) columns.last_pose = make(table.last_pose);
      if (asked.has_budget()) {
        columns.certain = make(table.certain).attr("view")("bool").template cast<Column<bool>>();
      }
      if (asked.depth) {
        columns.depth = make(table.depth);
        columns.depth_source = make(table.depth_source);
      }
    }
    return columns;
  }
}

/// Whether a query asked for a table.
template <typename Table>
bool has_table(const QueryParameters& asked) {
  if constexpr (std::is_same_v<Table, Nearby>) return asked.has_budget();
  if constexpr (std::is_same_v<Table, Clearances>) return asked.clearance > 0;
  if constexpr (std::is_same_v<Table, Profile>) return asked.profile > 0;
  return asked.seen;
}

/// The columns of the table that `read` returns; of any but the collisions none where the query did
/// not ask for it.
template <typename Read, typename Make>
auto columns_if_asked(const Read& read, const QueryParameters& asked, bool has_bodies,
                      const Make& make) {
  using Table = std::remove_cvref_t<decltype(read())>;
  const auto columns = [&] {
    auto&& table = read();
    return columns_of_table(table, asked, has_bodies, make);
  };
  if constexpr (std::is_same_v<Table, Collisions>) {
    return columns();
  } else {
    return has_table<Table>(asked) ? std::optional(columns()) : std::nullopt;
  }
}

template <auto kTable>
auto columns_of_file(const Result& result) {
  const auto read = [&] { return without_gil([&] { return std::invoke(kTable, result); }); };
  return columns_if_asked(read, result.parameters(), !result.bodies().empty(), OwnArrays());
}

/// The arrays keep the answer itself alive, which keeps its tables.
template <auto kTable>
auto columns_in_memory(const py::object& self) {
  const auto& answer = self.cast<const SessionAnswer&>();
  const auto read = [&]() -> decltype(auto) { return std::invoke(kTable, answer); };
  return columns_if_asked(read, answer.parameters, !answer.bodies.empty(), SharedArrays{self});
}

/// A single column of the collisions.
template <auto kColumn>
auto column_of_file(const Result& result) {
  return to_array(without_gil([&] { return std::invoke(kColumn, result); }));
}
template <auto kColumn>
auto asked_column_of_file(const Result& result) {
  return result.parameters().first_pose ? std::optional(column_of_file<kColumn>(result))
                                        : std::nullopt;
}

void add_columns(py::module_& module) {
  auto touched = add_class<CollisionColumns>(module, "Collisions",
                                             "The points that the model touches: arrays of one "
                                             "length, in which row i of each is the same point.",
                                             kCollisionFacts);
  touched.def("__len__", [](const CollisionColumns& c) { return c.source.size(); });
  touched.attr("NO_POINT") = Collisions::kNoPoint;
  add_class<UnseenColumns>(module, "UnseenCubes",
                           "The cubes that the model sweeps and no beam passed through: arrays of "
                           "one length, in which row i of each is the same cube.",
                           kUnseenFacts)
      .def("__len__", [](const UnseenColumns& c) { return c.first_pose.size(); });
  add_class<ClearanceColumns>(module, "Clearances",
                              "The distances of environment points to the moving model: arrays of "
                              "one length, in which row i of each is the same point.",
                              kClearanceFacts)
      .def("__len__", [](const ClearanceColumns& c) { return c.source.size(); });
  auto profile = add_class<ProfileColumns>(module, "Profile",
                                           "The least distance between model and environment at "
                                           "every pose: arrays with a row for each pose.",
                                           kProfileFacts);
  profile.def("__len__", [](const ProfileColumns& p) { return p.distance.size(); });
  profile.attr("NO_POINT") = Profile::kNoPoint;
}

constexpr std::tuple kResultFacts{
    fact<&Result::size>("The number of colliding points."),
    fact<&Result::parameters>("What was asked: QueryParameters."),
    fact<&Result::environment_points>("The number of points that the environment has."),
    fact<&Result::ignored>(
        "How many points of the environment the search left out: IgnoredPointCounts."),
    fact<&Result::poses>("The number of poses that the path had."),
    fact<&Result::warnings>(
        "Warnings of the search: a list of Message, as Answer.warnings has it."),
    fact<&Result::bodies>(
        "The names of the vehicle's bodies: a list, which is empty where there is one model."),
    fact<&Result::model_spacing>(
        "Metres: the model's points are samples of a mesh, and no place of its surface is farther "
        "than this from one of them. 0 where the model is no sampled mesh."),
    fact<&Result::model_axes>(
        "The axes of the model's file that pointed ahead and up before the search turned the "
        "model, such as ('+y', '+z'); ('+x', '+z') where nothing was turned."),
    fact<&Result::model_box>("The box around the model in its own frame: a Box.")};

void add_result(py::module_& module) {
  py::class_<Result> result(module, "Result",
                            "A result file that search() or merge() wrote. Row i of each of its "
                            "arrays is the same point.");
  add_methods(result, std::identity(), kResultFacts);
  result
      .def(py::init([](const py::kwargs& given) {
             return without_gil(
                 [file = path_of(given["path"])] { return std::make_unique<Result>(file); });
           }),
           "__init__(self, path: Path)\n--\n\n"
           "Open a result file, to be read as its methods are called.")
      .def("__len__", &Result::size)
      .def(
          "answer", [](const Result& r) { return without_gil([&] { return r.answer(); }); },
          "The verdict and the places that matter most, an Answer. Reads all tables.")
      .def("collisions", &columns_of_file<&Result::collisions>,
           "The colliding points with all of their columns: Collisions. The methods below read one "
           "column each.")
      .def("source", &column_of_file<&Result::source>,
           "The index of each colliding point in the order of the scans, ascending: n uint64.")
      .def("xyz", &column_of_file<&Result::xyz>,
           "The coordinates of the colliding points: n x 3 float64, metres.")
      .def("first_pose", &asked_column_of_file<&Result::first_pose>,
           "The first pose that touches each colliding point: n uint32. None where the query did "
           "not ask for it.")
      .def("last_pose", &asked_column_of_file<&Result::last_pose>,
           "The last pose that touches each colliding point: n uint32. Between poses, the start of "
           "the last way that does. None where the query did not ask for first poses, or an older "
           "release wrote the file.")
      .def(
          "first_body",
          [](const Result& r) {
            return r.bodies().empty() ? std::nullopt : asked_column_of_file<&Result::first_body>(r);
          },
          "The body that touches each point at its first pose, as an index of bodies(): n uint32. "
          "None where there is one model, or the query did not ask for first poses.")
      .def("unseen", &columns_of_file<&Result::unseen>,
           "The places that the model sweeps and no beam passed through: UnseenCubes. None where "
           "the query did not ask for seen space.")
      .def("near", &columns_of_file<&Result::near>,
           "The points that do not collide but may in truth, by the error budget: Collisions, "
           "whose last_pose and certain are None. None without a budget.")
      .def("clearance", &columns_of_file<&Result::clearance>,
           "The distances of the points that are closer than the clearance: Clearances. None where "
           "the query did not ask for them.")
      .def("profile", &columns_of_file<&Result::profile>,
           "The least distance at every pose: a Profile. None where the query did not ask for it.");
  add_repr(result, [](const Result& r) {
    return "<Result: " + std::to_string(r.size()) + " of " +
           std::to_string(r.environment_points()) + " points collide>";
  });
}

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

void save(const SessionAnswer& answer, const py::kwargs& given) {
  without_gil([&, file = path_of(given["path"]), overwrite = argument<bool>(given, "overwrite")] {
    answer.save(file, overwrite);
    return true;
  });
}

void add_session_answer(py::module_& module) {
  py::class_<SessionAnswer, SearchReport>(
      module, "SessionAnswer",
      "What a session found, an Answer with its tables in memory.\n\n"
      "The arrays are made of the tables without a copy. They cannot be written to, and they stay "
      "when the answer and the session are gone.")
      .def_property_readonly("collisions", &columns_in_memory<&SessionAnswer::collisions>,
                             "The colliding points: Collisions.")
      .def_property_readonly(
          "near", &columns_in_memory<&SessionAnswer::near>,
          "The points that do not collide but may in truth, by the error budget: Collisions, whose "
          "last_pose and certain are None. None without a budget.")
      .def_property_readonly(
          "clearances", &columns_in_memory<&SessionAnswer::clearances>,
          "The distances of the points that are closer than the clearance: Clearances. None where "
          "the query did not ask for them.")
      .def_property_readonly(
          "profile", &columns_in_memory<&SessionAnswer::profile>,
          "The least distance at every pose: a Profile. None where the query did not ask for it.")
      .def_property_readonly(
          "unseen", &columns_in_memory<&SessionAnswer::unseen>,
          "The places that the model sweeps and no beam passed through: UnseenCubes. None where "
          "the query did not ask for seen space.")
      .def("save", &save, R"(save(self, path: Path, overwrite: Flag = False)
--

Write the result file that search() writes for the same question, to be opened with Result.

path: the file of the result to write.
overwrite: replaces an existing file.)");
}

SessionAnswer answer_of(SharedSession& shared, const py::kwargs& given) {
  const std::shared_ptr<const Session> session = shared.opened();
  const auto& query = argument<const ArrayQuery&>(given, "query");
  require_radius(query);
  QuestionOptions options;
  set_fields(kQuestionFields, given, options);
  take<&QuestionOptions::input_warnings>(given, options);
  const KeptQueries::Loan asked(shared.queries, query);
  Watch watch(given, options);
  return watch.run([&, rigid = !query.allow_non_rigid] {
    if (rigid) require_rigid(asked.query());
    return session->search(asked.query(), options);
  });
}

void add_session_members(py::class_<SharedSession>& sessions) {
  sessions
      .def(
          "search", &answer_of,
          ("search(self, query: Query, *, " + signature_of(kQuestionFields) +
           R"DOC(, input_warnings: Messages = (), progress: Progress = None, message: Tell = None, stop: Stop = None)
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
      .def("__exit__", [](SharedSession& shared, const py::args&) { shared.close(); });
  add_repr(sessions, [](const SharedSession& shared) {
    const std::string path = shared.path().string();
    if (shared.is_closed()) return "<Session " + path + ": closed>";
    return "<Session " + path + ": " + std::to_string(shared.opened()->store().point_count()) +
           " points>";
  });
}

}  // namespace

void add_results(py::module_& module) {
  add_columns(module);
  add_result(module);
  add_session_answer(module);
  py::class_<SharedSession> session(
      module, "Session",
      "A store that stays open for many questions, with the GPUs that were started and with what "
      "was built for the models that were asked about, so that a question of one pose takes "
      "milliseconds.\n\nSeveral threads may ask at once, and share the memory of the session.");
  session.def(
      py::init([](const py::kwargs& given) {
        SessionOptions options;
        set_fields(kMachineFields<SessionOptions>, given, options);
        return without_gil([&, file = path_of(given["path"])] {
          return std::make_unique<SharedSession>(file, options);
        });
      }),
      ("__init__(self, path: Path, *, " + signature_of(kMachineFields<SessionOptions>) + R"DOC()
--

Open a store for questions. Use it in a with block, which closes it at its end.

All questions together share the machine.

path: the file that convert() made.
)DOC" + lines_of(kMachineFields<SessionOptions>))
          .c_str());
  add_session_members(session);
}

}  // namespace clearway::python
