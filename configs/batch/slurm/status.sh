#!/bin/sh
# status.sh JOB: the state of a SLURM job as Snakemake asks for it: running, success or failed. Says on standard error
# why a job failed. `scontrol` forgets a job some minutes after its end; `sacct` knows it where there is accounting.
job=${1%%;*}  # of a federation: JOB;CLUSTER
name=
if text=$(scontrol --oneliner show job "$job" 2>&1); then
  name=$(echo "$text" | sed -n 's/.* JobName=\([^ ]*\).*/\1/p')
  state=$(echo "$text" | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p')
  reason=$(echo "$text" | sed -n 's/.* Reason=\([^ ]*\).*/\1/p')
else
  case $text in
    *"Invalid job id"*)
      state=$(sacct --noheader --parsable2 --allocations --jobs="$job" --format=State 2>/dev/null | sed 's/ .*//;1q')
      state=${state:-FORGOTTEN} reason= ;;
    *) state=RUNNING ;;  # the controller does not answer: ask again later
  esac
fi
case $state in
  COMPLETED) echo success ;;
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | STOPPED | RESIZING | SIGNALING | STAGE_OUT | REQUEUED | \
    REQUEUE_FED | REQUEUE_HOLD | RESV_DEL_HOLD | SPECIAL_EXIT) echo running ;;
  *)
    echo "SLURM job $job ($name) was ended: $state${reason:+, reason $reason}" >&2
    echo failed ;;
esac
