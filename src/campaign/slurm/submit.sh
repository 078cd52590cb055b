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
