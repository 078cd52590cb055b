#include "search/checks/checks.hpp"
#include "search/checks/facts/path_cover.hpp"
#include "search/checks/likely_remedy.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

/// The box around the model's boxes at all poses.
Box swept_box(const Question& question) {
  Box box = moved(question.model, question.query.poses.front());
  for (const Pose& pose : question.query.poses) box = box.united(moved(question.model, pose));
  return box;
}

std::string boxes_text(const Question& question, const Box& swept) {
  return "Environment: " + extent_text(question.environment) +
         ". Model on its path: " + extent_text(swept) +
         ". Model: " + size_text(question.model, question.unit);
}

void warn_out_of_reach(const Question& question, const PathCover& cover, const Box& swept,
                       MessageLog& log) {
  const double apart = swept.distance(question.environment);
  const std::string where =
      apart > 0 ? "their boxes are " + length_text(apart, question.unit) + " apart"
                : "the path crosses the environment's box where nothing was scanned";
  log.warn("out-of-reach",
           "nothing was scanned within " + length_text(cover.reach(), question.unit) +
               " of the path: " + where + ". " + boxes_text(question, swept) + ". " +
               likely_remedy(question, cover),
           {{"gap", apart}, {"reach", cover.reach()}});
}

void warn_leaves_scan(const Question& question, const PathCover& cover, const Box& swept,
                      MessageLog& log) {
  const double share =
      static_cast<double>(cover.outside()) / static_cast<double>(cover.looked_at());
  const std::uint32_t first = question.number_of(cover.first_outside());
  const std::uint32_t last = question.number_of(cover.last_outside());
  std::string text = "nothing was scanned within " + length_text(cover.reach(), question.unit) +
                     " of the model at " + share_text(share) + " of the poses, on " +
                     length_text(cover.length_outside(), question.unit) + " of the " +
                     length_text(cover.length(), question.unit) + " of the path, between pose " +
                     std::to_string(first) + " and pose " + std::to_string(last) +
                     ": there the result says nothing. ";
  constexpr double kWrongFrame = 0.5;
  if (share >= kWrongFrame) {
    text += boxes_text(question, swept) + ". " + likely_remedy(question, cover);
  } else {
    text += "Scan the rest of the way, or leave these poses out";
  }
  log.warn("leaves-scan", text,
           {{"share", share},
            {"reach", cover.reach()},
            {"length", cover.length_outside()},
            {"path_length", cover.length()},
            {"first_pose", first},
            {"last_pose", last},
            {"chainage_from", question.chainage(cover.first_outside())},
            {"chainage_to", question.chainage(cover.last_outside())}});
}

}  // namespace

void check_reach(const Question& question, const PathCover& cover, MessageLog& log) {
  if (cover.outside() == 0) return;
  const Box swept = swept_box(question);
  if (cover.outside() == cover.looked_at()) {
    warn_out_of_reach(question, cover, swept, log);
  } else {
    warn_leaves_scan(question, cover, swept, log);
  }
}

}  // namespace clearway
