"""The Snakemake workflow of configs/batch on a SLURM of its own: jobs that the cluster ends are tried again.

    python3 tests/batch/slurm_test.py build/release/foci

As root, with Debian's slurm-wlm and munge. Takes some three minutes: SLURM's clock has minutes.
"""

import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from workflow_test import ROOT, STUDY, recording

SUBJECTS = ["sub-01", "sub-02", "sub-03", "sub-04"]
CONFIGURATION = """
ClusterName=foci
SlurmctldHost={host}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
JobAcctGatherParams=OverMemoryKill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=batch_sched_delay=0,sched_interval=1
ReturnToService=2
SlurmctldPort=26817
SlurmdPort=26818
SlurmdParameters=config_overrides
SlurmdTimeout=5
InactiveLimit=0
KillWait=1
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmdSpoolDir={folder}/spool
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} CPUs=4 RealMemory=16000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""

# The program, which on the first try of each recording gives the cluster a reason to end its job.
PROGRAM = """#!/bin/sh
case "$*" in
  *"--frames 0:"*) ;;  # measures the cost
  replay*sub-0[1-4]*)
    subject=$(echo "$*" | grep -o 'sub-0[1-4]' | head -1)
    echo "$subject" >> {folder}/begun
    if [ "$(grep -c "$subject" {folder}/begun)" -eq 1 ]; then
      case $subject in
        sub-01) exec sleep 600 ;;  # until scancel
        sub-02) exec sleep 600 ;;  # until the time limit
        sub-03) exec python3 -c 'import time; data = bytearray(3 << 30); time.sleep(600)' ;;  # more than its memory
        sub-04) exec sleep 600 ;;  # until its node is lost
      esac
    fi ;;
esac
exec {foci} "$@"
"""


class Cluster:
    """SLURM on this machine, in a folder, with daemons of its own."""

    def __init__(self, folder):
        self.folder = folder
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf"), "HOME": str(folder),
                            "XDG_CACHE_HOME": str(folder)}
        host = socket.gethostname().split(".")[0]
        (folder / "slurm.conf").write_text(CONFIGURATION.format(host=host, folder=folder))
        for name in ("spool", "state"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self.daemons = {}

    def begin(self):
        folder = self.folder
        self.daemons["munged"] = self.start("munged", "--foreground", "--force", f"--key-file={folder}/munge.key",
                                            f"--socket={folder}/munge.socket", f"--pid-file={folder}/munge.pid",
                                            f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        self.wait(lambda: (folder / "munge.socket").exists(), "munge")
        self.daemons["slurmctld"] = self.start("slurmctld", "-D", "-i")
        self.start_node()
        self.wait(lambda: "idle" in self.run("sinfo", "--noheader", "--format=%T"), "an idle node")

    def start(self, *command):
        return subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def start_node(self):
        self.daemons["slurmd"] = self.start("slurmd", "-D")

    def kill_node(self):
        """The daemon and its jobs' parents, which have files of the folder open: no other SLURM of this machine."""
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if (process / "comm").read_text().strip() not in ("slurmd", "slurmstepd"):
                    continue
                log = self.folder / "slurmd.log"
                if any(file.exists() and file.samefile(log) for file in (process / "fd").iterdir()):
                    os.kill(int(process.name), signal.SIGKILL)
            except OSError:
                pass  # it has ended
        self.daemons["slurmd"].wait(timeout=30)

    def run(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True).stdout

    def wait(self, condition, what, seconds=120):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"{what}: not within {seconds} s"
            time.sleep(0.2)

    def job(self, subject):
        """The running replay of a recording."""
        for line in self.run("squeue", "--noheader", "--states=RUNNING", "--format=%A %j").splitlines():
            number, name = line.split(maxsplit=1)
            if name.startswith("replay") and subject in name:
                return number
        return None

    def stop(self):
        self.run("scancel", "--signal=KILL", "--user=root")
        for daemon in reversed(self.daemons.values()):
            daemon.terminate()
        for daemon in self.daemons.values():
            daemon.wait(timeout=30)


def missing():
    tools = [tool for tool in ("snakemake", "munged", "slurmctld", "slurmd", "sbatch") if shutil.which(tool) is None]
    if tools:
        return f"{tools[0]} is not installed"
    return "needs root" if os.geteuid() != 0 else None


def main():
    if missing():
        print(f"{missing()}: not tested")
        sys.exit(77)  # skipped
    foci = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)  # munge asks for it
        program = folder / "program"
        program.write_text(PROGRAM.format(folder=folder, foci=foci))
        program.chmod(0o755)
        for subject in SUBJECTS:
            recording(foci, folder, subject)
        (folder / "study.toml").write_text(STUDY)
        cluster = Cluster(folder)
        try:
            cluster.begin()
            run(cluster, folder, program)
        finally:
            cluster.stop()
        same_hashes(folder, foci, cluster.environment)
    print("passed")


def run(cluster, folder, program):
    log = open(folder / "snakemake.log", "w+")
    workflow = subprocess.Popen(
        ["snakemake", "-s", ROOT / "configs/batch/Snakefile", "--profile", ROOT / "configs/batch/slurm",
         "--nolock", "--latency-wait", "5", "--config", "bids=data", "study=study.toml", f"foci={program}"],
        cwd=folder, env=cluster.environment, stdout=log, stderr=subprocess.STDOUT)
    try:
        begun = folder / "begun"
        cluster.wait(lambda: workflow.poll() is not None or
                     begun.exists() and {*begun.read_text().split()} >= {*SUBJECTS}, "four jobs", 300)
        assert workflow.poll() is None
        cluster.run("scancel", cluster.job("sub-01"))
        # SLURM checks its limits each half minute.
        cluster.run("scontrol", "update", f"jobid={cluster.job('sub-02')}", "timelimit=1")
        cluster.wait(lambda: cluster.job("sub-03") is None or begun.read_text().count("sub-03") > 1, "memory limit")
        cluster.wait(lambda: begun.read_text().count("sub-02") > 1, "a time limit", 240)
        cluster.kill_node()
        cluster.wait(lambda: "down" in cluster.run("sinfo", "--noheader", "--format=%T"), "a lost node")
        cluster.start_node()
        assert workflow.wait(timeout=400) == 0
    except BaseException:
        workflow.send_signal(signal.SIGINT)
        log.seek(0)
        print(log.read())
        raise
    log.seek(0)
    said = log.read()
    for state in ("CANCELLED", "TIMEOUT", "NODE_FAIL"):
        assert f"was ended: {state}" in said, (state, said)
    assert said.count("was ended:") >= len(SUBJECTS), said


def same_hashes(folder, foci, environment):
    """A run on one machine has the frames of the cluster's."""
    out = folder / "data/derivatives/foci"
    for subject in SUBJECTS:
        one = folder / "one" / subject
        trace = folder / "data" / subject / "beh" / f"{subject}_task-look_recording-eye1_physio.tsv.gz"
        subprocess.run([foci, "replay", folder / "study.toml", "--trace", trace, "--out", one, "--threads", "1"],
                       env=environment, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        ours = out / subject / "beh" / f"{subject}_task-look_recording-eye1_foci" / "manifest.json"
        hashes = [json.loads(path.read_text())["frames_sha256"] for path in (ours, one / "manifest.json")]
        assert hashes[0] == hashes[1], subject


if __name__ == "__main__":
    main()
