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
  5) again=yes ;;
  4|137) if [ "${SLURM_RESTART_COUNT:-0}" -lt 2 ]; then again=yes; fi ;;
esac
# A job that was cancelled is not to come back.
job=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
if [ $again = yes ] && [ "$(squeue -h -j "$job" -o %T 2>/dev/null)" = RUNNING ]; then
  echo "task $task: exit code $code, queued again"
  scontrol requeue "$job" && exit 0
fi
exit $code
