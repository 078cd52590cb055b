#include "campaign/slurm_script.hpp"

#include "core/util/exit_code.hpp"
#include "core/util/shell_words.hpp"

namespace clearway::campaign {
namespace {

/// Bytes that the program takes besides --memory: itself, its libraries, and buffers of the file
/// system.
constexpr std::uint64_t kProgramBytes = std::uint64_t{512} << 20;

std::string resources(const SlurmJob& job) {
  std::string text =
      "#SBATCH --mem=" + std::to_string((job.memory_bytes + kProgramBytes) >> 20) + "M\n";
  if (job.threads > 0) text += "#SBATCH --cpus-per-task=" + std::to_string(job.threads) + "\n";
  if (job.gpu) text += "#SBATCH --gres=gpu:1\n";
  for (const std::string& option : job.options) text += "#SBATCH " + option + "\n";
  return text;
}

std::string task_script() {
  return R"sh(
# Slurm sends TERM 60 seconds before the end. The task then keeps what it found and ends with 5.
set -u
task=$((SLURM_ARRAY_TASK_ID + ${CLEARWAY_FIRST:-0}))
"$program" campaign run "$folder" --task "$task" &
child=$!
trap 'kill -TERM "$child" 2>/dev/null' TERM
wait "$child"; code=$?
while kill -0 "$child" 2>/dev/null; do wait "$child"; code=$?; done  # a trap ends a wait

# 5: interrupted, to go on. 4, or killed: the machine, may work later. 2, 3: the same again, and a
# merge without all of its parts.
again=no
case $code in
)sh" + ("  " + std::to_string(kInterrupted)) +
         ") again=yes ;;\n  " + std::to_string(kResource) +
         R"sh(|137) if [ "${SLURM_RESTART_COUNT:-0}" -lt 2 ]; then again=yes; fi ;;
esac
# A job that was cancelled is not to come back.
job=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
if [ $again = yes ] && [ "$(squeue -h -j "$job" -o %T 2>/dev/null)" = RUNNING ]; then
  echo "task $task: exit code $code, queued again"
  scontrol requeue "$job" && exit 0
fi
exit $code
)sh";
}

constexpr const char* kSubmitScript = R"sh(
set -euo pipefail
fail() { echo "error: $1" >&2; exit "$2"; }

# Without an argument all tasks are submitted. An empty list has no task.
if [ $# -gt 1 ]; then fail "expected one list of tasks, such as 3,7-9, or none for all tasks" 2; fi
list=${1-0-$last}
list=${list//[[:space:]]/}
if [ -z "$list" ]; then
  echo "nothing is submitted, because the list of tasks is empty"
  exit 0
fi
if ! [[ $list =~ ^[0-9]{1,8}(-[0-9]{1,8})?(,[0-9]{1,8}(-[0-9]{1,8})?)*$ ]]; then
  fail "$1: expected numbers of tasks from 0 to $last, such as 3,7-9" 2
fi
IFS=, read -ra parts <<< "$list"
for part in "${parts[@]}"; do
  if [ "${part%-*}" -gt "${part#*-}" ] || [ "${part#*-}" -gt "$last" ]; then
    fail "$part: expected numbers of tasks that ascend, from 0 to $last" 2
  fi
done
most=$(scontrol show config | awk '/^MaxArraySize/ {print $3}')
if ! [[ $most =~ ^[1-9][0-9]*$ ]]; then
  fail "scontrol show config: expected a MaxArraySize above 0, found \"$most\"" 4
fi

numbers_of() {  # 3,7-9: a number a line
  local part parts
  IFS=, read -ra parts <<< "$1"
  for part in ${parts[@]+"${parts[@]}"}; do
    seq "${part%-*}" "${part#*-}"
  done
}

script() {  # a merge needs no GPU
  if [ "$gpu" = yes ]; then cat "$folder/campaign.sbatch"; else
    grep -vx '#SBATCH --gres=gpu:1' "$folder/campaign.sbatch"
  fi
}

# Numbers of an array stay below MaxArraySize: more tasks become several arrays.
submit() {  # numbers and options of sbatch in the variables of these names, gpu: adds to jobs
  local first=0 array rest number job
  while [ ${#numbers[@]} -gt 0 ]; do
    array= rest=()
    for number in "${numbers[@]}"; do
      if [ "$number" -lt $((first + most)) ]; then
        array+=${array:+,}$((number - first))
      else
        rest+=("$number")
      fi
    done
    if [ -n "$array" ]; then
      job=$(script | CLEARWAY_FIRST=$first sbatch --parsable --export=ALL --array="$array" \
        ${options[@]+"${options[@]}"})
      jobs+=:${job%%;*}
    fi
    numbers=(${rest[@]+"${rest[@]}"})
    first=$((first + most))
  done
}

declare -A is_merge=()
for number in $(numbers_of "$merges"); do is_merge[$number]=1; done
runs=() later=()
for number in $(numbers_of "$list" | sort -nu); do
  if [ -n "${is_merge[$number]:-}" ]; then later+=("$number"); else runs+=("$number"); fi
done
jobs= options=() gpu=yes numbers=(${runs[@]+"${runs[@]}"})
submit
if [ -n "$jobs" ]; then options=(--dependency="afterany$jobs"); fi
gpu=no numbers=(${later[@]+"${later[@]}"})
submit
report=$(sbatch --parsable --dependency="afterany$jobs" --job-name="$name-report" \
  --output="$folder/slurm/report.log" ${report_options[@]+"${report_options[@]}"} \
  --wrap="exec $(printf '%q ' "$program" campaign report "$folder" --force)")
echo "tasks: job ${jobs#:}; report: job ${report%%;*}"
)sh";

std::string variables(const SlurmJob& job) {
  return "program=" + shell_word(job.program.string()) +
         "\nfolder=" + shell_word(job.folder.string()) + "\nname=" + shell_word(job.name) + "\n";
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

std::string sbatch_text(const SlurmJob& job) {
  return "#!/usr/bin/env bash\n"
         "# One task of a campaign, made by clearway campaign plan. submit.sh submits it.\n"
         "#SBATCH --job-name=\"" +
         sbatch_word(job.name) + "\"\n#SBATCH --output=\"" +
         sbatch_word((job.folder / "slurm").string()) +
         "/%A_%a.log\"\n#SBATCH --open-mode=append\n#SBATCH --requeue\n"
         "#SBATCH --signal=B:TERM@60\n" +
         resources(job) + variables(job) + task_script();
}

std::string submit_text(const SlurmJob& job) {
  std::string options = "report_options=(";
  for (const std::string& option : job.options) options += shell_word(option) + " ";
  const std::string last = std::to_string(job.tasks - 1);
  return "#!/usr/bin/env bash\n"
         "# Submits a campaign to Slurm: submit.sh [TASKS], for example\n"
         "#   submit.sh \"$(clearway campaign status DIR --missing)\"\n" +
         variables(job) + "last=" + last + "\nmerges=" + task_list_text(job.merges) +
         "  # wait for their shards\n" + options + ")" + kSubmitScript;
}

}  // namespace clearway::campaign
