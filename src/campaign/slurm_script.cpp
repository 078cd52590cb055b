#include "campaign/slurm_script.hpp"

#include <fmt/format.h>

#include "campaign/embedded.hpp"
#include "core/util/shell_words.hpp"

namespace clearway::campaign {
namespace {

/// Bytes that the program takes besides --memory: itself, its libraries, and buffers of the file
/// system.
constexpr std::uint64_t kProgramBytes = std::uint64_t{512} << 20;

std::string variables(const SlurmJob& job, const Plan& plan) {
  return fmt::format("program={}\nfolder={}\nname={}\n", shell_word(job.program),
                     shell_word(job.folder), shell_word(plan.name));
}

/// Escapes a string within quotes on a #SBATCH line, where a percent sign introduces a placeholder.
std::string sbatch_word(const std::string& text) {
  std::string word;
  for (const char c : text) {
    if (c == '%') word += c;
    if (c == '"' || c == '\\') word += '\\';
    word += c;
  }
  return word;
}

}  // namespace

std::string sbatch_text(const SlurmJob& job, const Plan& plan) {
  std::string text = fmt::format(
      "#!/usr/bin/env bash\n"
      "# One task of a campaign, made by clearway campaign plan. submit.sh submits it.\n"
      "#SBATCH --job-name=\"{}\"\n#SBATCH --output=\"{}/%A_%a.log\"\n"
      "#SBATCH --open-mode=append\n#SBATCH --requeue\n#SBATCH --signal=B:TERM@60\n"
      "#SBATCH --mem={}M\n",
      sbatch_word(plan.name), sbatch_word((job.folder / "slurm").string()),
      (job.memory_bytes + kProgramBytes) >> 20);
  if (!job.threads.empty()) text += "#SBATCH --cpus-per-task=" + job.threads + "\n";
  if (job.gpu) text += "#SBATCH --gres=gpu:1\n";
  for (const std::string& option : job.options) text += "#SBATCH " + option + "\n";
  return fmt::format("{}{}\n{}", text, variables(job, plan), kTaskScript);
}

std::string submit_text(const SlurmJob& job, const Plan& plan) {
  TaskList merges;
  for (const Task& task : plan.tasks) {
    if (task.shards > 0) merges.push_back(task.number);
  }
  std::string options;
  for (const std::string& option : job.options) options += shell_word(option) + " ";
  return fmt::format(
      "#!/usr/bin/env bash\n# Submits a campaign to Slurm: submit.sh [TASKS], for example\n"
      "#   submit.sh \"$(clearway campaign status DIR --missing)\"\n"
      "{}last={}\nmerges={}  # wait for their shards\nreport_options=({})\n{}",
      variables(job, plan), plan.tasks.size() - 1, task_list_text(merges), options, kSubmitScript);
}

}  // namespace clearway::campaign
