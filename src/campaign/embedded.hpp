#pragma once

#include <string_view>

/// The files of this folder that go into the program as they are.
namespace clearway::campaign {

extern const std::string_view kTaskScript;    ///< slurm/task.sh: what campaign.sbatch does
extern const std::string_view kSubmitScript;  ///< slurm/submit.sh: what submit.sh does

}  // namespace clearway::campaign
