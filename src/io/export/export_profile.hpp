#pragma once

#include <filesystem>

#include "clearway/trajectory.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// Writes the profile of `result` as text with a header and one line per pose:
/// pose,time,name,chainage,distance,source,x,y,z. The columns time and name exist where `labels`
/// has them, for each pose of the result. chainage_start: the chainage of the first pose. The last
/// five columns are empty where the pose has no point. With several bodies there is one more
/// column, searched: 0 where no body has a pose, so that nothing is known, otherwise 1. Throws
/// UsageError for a result without a profile or a name that does not end in .csv; otherwise like
/// export_result().
void export_profile(const ResultReader& result, const PoseLabels& labels, double chainage_start,
                    const std::filesystem::path& output, bool overwrite, Progress& progress);

}  // namespace clearway
