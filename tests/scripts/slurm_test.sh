#!/usr/bin/env bash
# Tests scripts/sweep.sbatch on a real Slurm: slurm_test.sh PROGRAM. The cluster consists of this machine, as one node
# with four processors. Its daemons, ports, key and folder exist only during the test. Exits with status 77, "skipped",
# if Slurm is missing or the user is not root.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
export HAPBENCH=$1

for tool in munged slurmctld slurmd sbatch setpriv; do
  command -v "$tool" >/dev/null ||
    { echo "no Slurm to test with, for want of $tool (scripts/setup --tests installs it)"; exit 77; }
done
((EUID == 0)) ||
  { echo 'no Slurm to test with, for want of the rights of root, which its daemons need to start jobs'; exit 77; }

folder=$(mktemp -d)
host=$(hostname -s)
export SLURM_CONF=$folder/slurm.conf
end() {
  scancel --full --signal=KILL --user=root 2>/dev/null || true
  jobs -p | xargs -r kill 2>/dev/null || true
  wait
  rm -rf "$folder"
}
trap end EXIT
fail() { printf 'slurm_test: %s\n' "$1" >&2; tail -n 20 "$folder"/*.log >&2; exit 1; }
free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }
# Starts a daemon that is killed when this script ends, also if the script is killed.
start() { setpriv --pdeathsig=KILL "$@" & }

mkdir "$folder"/{munge,state,spool}
(umask 077; head -c 128 /dev/urandom >"$folder/munge/key")  # jobs run as root: no other user may submit a job
chown -R munge "$folder/munge"
chmod 755 "$folder" "$folder/munge"
echo 'CgroupPlugin=cgroup/v1' >"$folder/cgroup.conf"
cat >"$SLURM_CONF" <<END
ClusterName=hapbench
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
SlurmdParameters=config_overrides
NodeName=$host NodeAddr=127.0.0.1 CPUs=4 RealMemory=100 State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
start --reuid=munge --regid=munge --clear-groups munged --foreground \
  --socket="$folder/munge/socket" --key-file="$folder/munge/key" \
  --pid-file="$folder/munge/pid" --seed-file="$folder/munge/seed" --log-file="$folder/munge/log"
start slurmctld -D -i -L "$folder/slurmctld.log"
start slurmd -D -L "$folder/slurmd.log"
for ((attempt = 0; attempt < 1000; ++attempt)); do
  [[ $(sinfo --noheader --format=%T 2>/dev/null) == idle ]] && break
  sleep 0.2
done
[[ $(sinfo --noheader --format=%T) == idle ]] || fail 'the daemons of Slurm do not answer'

# sweep FOLDER prints the arguments of a sweep, one per line. Each of its runs takes about 20 ms.
sweep() {
  printf '%s\n' single_spring --set record.trajectory=false --set time.steps=100000 \
    --vary "rendering.stiffness_N_per_m=1e3:1e4:$runs:log" --out "$folder/$1"
}
submit() {
  mapfile -t words < <(sweep out) &&
    sbatch --parsable --array=0-2 --output="$folder/task_%a.log" "$here/scripts/sweep.sbatch" "${words[@]}"
}
wait_for_the_queue() { while [[ -n $(squeue --noheader) ]]; do sleep 0.2; done; }
shard=$folder/out/sweep.
is_begun() { [[ -e $shard$1_of_3.csv ]] || (($(sed -n '$=' "$shard$1_of_3.csv.part" 2>/dev/null || true) > 2)); }

# Once tasks 0 and 1 have begun, kill task 1, and stop and requeue task 0, as preemption does. If a task ends before
# that, try again with four times as many runs.
for ((runs = 120; ; runs *= 4)); do
  rm -rf "$folder/out"
  array=$(submit)
  until is_begun 0 && is_begun 1; do sleep 0.05; done
  if scancel --full --signal=KILL "${array}_1" && scontrol requeue "${array}_0"; then
    # Restart task 0 after 2 s: Slurm would otherwise wait two minutes, and refuses a restart in the same second.
    scontrol update JobId="${array}_0" StartTime=now+2seconds
    wait_for_the_queue
    [[ -e ${shard}1_of_3.csv ]] || break
  fi
  wait_for_the_queue
done
[[ -e ${shard}0_of_3.csv && -e ${shard}2_of_3.csv ]] || fail 'a task that was requeued, or left alone, has no table'
[[ ! -e $folder/out/sweep.csv ]] || fail 'the tables are joined without that of the task that was killed'

submit >/dev/null
wait_for_the_queue
mapfile -t words < <(sweep whole)
"$HAPBENCH" sweep "${words[@]}" --quiet
for file in sweep.csv sweep.json; do
  cmp "$folder/out/$file" "$folder/whole/$file" || fail "$file is not that of one machine"
done
