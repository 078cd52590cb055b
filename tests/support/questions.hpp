#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "clearway/clearway.hpp"
#include "clearway/session.hpp"
#include "core/query/search_result.hpp"
#include "io/result/tables.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

/// Random questions about a scan, and their true answers, which brute force finds from every pair
/// of a point and a pose.
namespace clearway::test {

struct Question {
  Query query;
  Engine engine = Engine::kSweep;
};

/// The first pose of the path at which a point is touched, and the body that touches it.
struct FirstTouch {
  std::uint32_t pose = kNoPose, body = kNoPose;
  auto operator<=>(const FirstTouch&) const = default;
};

/// The first touch of each place within a radius. Floors are as much lower as the radius is larger
/// than that of the query.
std::vector<FirstTouch> first_touches(std::span<const Vec3> places, const Query& query,
                                      double radius);

/// The true answer to a question.
struct Truth {
  Collisions collisions;
  Nearby near;
  Clearances clearances;
  ProfileRows profile;
  Answer answer = {};  ///< has numbers and places, without warnings, budget and seen space
};

void check_tables(const Truth& truth, const Collisions& collisions, const Nearby& near,
                  const Clearances& clearances, const Profile& profile);
void check_answer(const Truth& truth, const Answer& answer);

/// Checks the tables of an answer, and what it says of them.
void check(const Truth& truth, const Result& result);
void check(const Truth& truth, const SessionAnswer& answer);

/// Three bodies on a path. The second one lacks the first and the last poses, and with gaps the
/// third one lacks some here and there. The third has the model of the first, and is where that is
/// at every third pose, so that they tie.
std::vector<Body> three_bodies(Random& random, const std::vector<Pose>& path, bool gaps);

/// A scan of a room in a store of small cells. Some of its points are there twice.
class AskedScan {
 public:
  /// plain: the points have neither classes nor origins.
  explicit AskedScan(std::uint64_t seed, bool plain = false);

  /// Converts the scan into cells of other sizes, or only what is near a path.
  std::filesystem::path converted(const std::string& name, ConvertOptions how) const;

  /// A smooth path through the room.
  static std::vector<Pose> path(Random& random, std::size_t poses);

  /// three_bodies() on a path, without a model.
  Query vehicle(std::uint64_t seed, std::size_t poses = 40, bool gaps = true) const;

  /// A random question that search() accepts.
  Question question(Random& random) const;

  /// budget: the one that search() reports for the query.
  Truth truth(const Query& query, const std::optional<ErrorBudget>& budget = {}) const;

  ScratchFolder folder;
  std::filesystem::path store;
  std::vector<Vec3> places;
  std::vector<std::uint8_t> classes;  ///< empty for a plain scan
  std::vector<Model> models;          ///< of 1, 25 and 120 points, of triangles, and of solids

 private:
  Question any_question(Random& random) const;
};

/// Searches on the CPU and returns the bytes of the result, which is left in the scan's folder.
std::string searched(const AskedScan& scan, const Query& query, const std::string& name,
                     const SearchOptions& options = {});

/// The same by parts that are searched alone, in reverse order, and merged.
std::string searched_in_parts(const AskedScan& scan, const Query& query, std::uint32_t count,
                              const SearchOptions& options, MergeReport& report);

/// The same by a search that is stopped again and again, and resumed.
std::string searched_in_pieces(const AskedScan& scan, const Query& query, Random& random,
                               const SearchOptions& options, SearchReport& report);

}  // namespace clearway::test
