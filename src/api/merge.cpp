#include "clearway/merge.hpp"

#include "core/util/callback_progress.hpp"
#include "io/merge/merge_parts.hpp"
#include "io/system/pending_file.hpp"
#include "search/threads.hpp"

namespace clearway {

MergeReport merge(const std::vector<std::filesystem::path>& parts,
                  const std::filesystem::path& output, const MergeOptions& options) {
  refuse_overwriting(output, parts);
  PendingFile pending(output, options.overwrite);
  CallbackProgress progress(options.progress, options.stop);
  const PartSet set(parts);
  const MergedResult merged = in_threads(options.threads, [&] {
    return merge_parts(set, pending.partial(), options.memory_bytes, progress);
  });
  pending.publish();
  const ResultHeader& header = set.header();
  return {.parameters = header,
          .parts = static_cast<std::uint32_t>(set.parts().size()),
          .environment_points = header.environment_points,
          .model_points = header.model_points,
          .poses = header.poses,
          .colliding_points = merged.collisions,
          .clearance_points = merged.clearances,
          .profile_poses = merged.profile_poses,
          .first_place = merged.first_place,
          .least_clearance = merged.least_clearance,
          .least_profile = merged.least_profile};
}

}  // namespace clearway
