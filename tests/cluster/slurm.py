"""Slurm: `sudo python3 tests/cluster/slurm.py`.

Starts munged, slurmctld and two slurmd on this machine, with everything in a folder of its own, submits an array job that may be
queued again, and kills one slurmd with all that it had at work. The controller finds the node down and queues its shard again.
"""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import common

CONFIGURATION = """\
ClusterName=stickslip
SlurmctldHost={host}
SlurmctldPort={ports[0]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.out
SlurmdLogFile={folder}/slurmd-%n.out
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobRequeue=1
ReturnToService=2
SlurmdTimeout=5
SchedulerParameters=sched_min_interval=100000
NodeName=worker1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 State=UNKNOWN
NodeName=worker2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""

# The shell hands SIGTERM on, and waits until the shard has ended by it. 75: the log is busy, or the file system failed; 130: stopped
# by SIGTERM.
JOB = """\
#!/bin/sh
#SBATCH --array=1-{shards} --ntasks=1 --signal=B:TERM@120
#SBATCH --requeue --open-mode=append --output={folder}/shard-%a.told
{command} &
shard=$!
trap 'kill -TERM $shard' TERM
until wait $shard; code=$?; ! kill -0 $shard 2>/dev/null; do :; done
case $code in
75 | 130) scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID" ;;
esac
exit $code
"""


def free_ports(count):
    """Ports that nobody has."""
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [own.getsockname()[1] for own in sockets]
    for own in sockets:
        own.close()
    return ports


class Slurm:
    """The daemons, and the commands that talk to them."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = {}
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        os.environ["PATH"] += ":/usr/sbin:/sbin"
        for name in ["state", "spool-worker1", "spool-worker2"]:
            (folder / name).mkdir()
        text = CONFIGURATION.format(host=socket.gethostname(), folder=folder, ports=free_ports(3))
        (folder / "slurm.conf").write_text(text, encoding="utf-8")
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)

    def start(self, name, *words):
        told = open(self.folder / f"{name}.start", "w", encoding="utf-8")
        self.processes[name] = subprocess.Popen(words, stdout=told, stderr=told, start_new_session=True)

    def start_all(self):
        own = self.folder
        files = [f"--{kind}-file={own}/munge.{kind}" for kind in ("key", "pid", "log", "seed")]
        self.start("munged", "munged", "--foreground", "--force", f"--socket={own}/munge.socket", *files)
        time.sleep(1)
        self.start("slurmctld", "slurmctld", "-D", "-i")
        for k in (1, 2):
            self.start_worker(k)
        for _ in range(60):
            if self.ask("sinfo", "-h", "-o", "%T %D") == "idle 2":
                return
            time.sleep(0.5)
        told = "\n".join(f"{file.name}: {file.read_text()[-800:]}" for file in own.glob("*.start"))
        common.skip(f"the daemons do not come up: {self.ask('sinfo', '-N', '-l')}\n{told}")

    def start_worker(self, k):
        self.start(f"worker{k}", "slurmd", "-D", "-N", f"worker{k}")

    def ask(self, *words):
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        return (done.stdout or done.stderr).strip()

    @staticmethod
    def node_of(process):
        """The node that a shard runs on, by its environment: to ask Slurm takes longer than a shard may last."""
        try:
            words = Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
        except OSError:
            return None
        names = [word.split(b"=", 1)[1].decode() for word in words if word.startswith(b"SLURMD_NODENAME=")]
        return names[0] if names else None

    def stop_one(self, sweep, job):
        """Sends SIGTERM to a shard, as where another job is more urgent; its number."""
        while True:
            k = next(iter(sweep.wait_for_middle()))
            told = sweep.folder / f"shard-{k}.told"
            # It may wait for the end of the job for longer than all other shards take.
            subprocess.Popen(["scancel", "--batch", "--signal=TERM", f"{job}_{k}"], stderr=subprocess.DEVNULL)
            for _ in range(100):
                if "interrupted" in told.read_text():
                    common.tell(f"SIGTERM to shard {k}")
                    return k
                time.sleep(0.1)

    def lose_one(self, sweep, but):
        """Kills a slurmd, the step that it watches, and what that runs: the machine is gone. The number of the shard, the node."""
        while True:
            work = sweep.wait_for_middle({but})
            for k, process in work.items():
                node = self.node_of(process)
                if node is None:
                    continue
                kept, family = sweep.kept(k), self.family(process)
                worker = self.processes[node]
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    continue
                for one in [worker.pid, *family]:
                    try:
                        os.kill(one, signal.SIGKILL)
                    except ProcessLookupError:
                        pass
                worker.wait()
                common.tell(f"killed {node} (-9) that had {kept} cells of shard {k}")
                return k, node

    @staticmethod
    def family(process):
        """The shell of a job, and the step that watches it."""
        found = []
        while process > 1 and process != os.getpid():
            try:
                process = int(Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[1])
            except OSError:
                break
            if process > 1 and process != os.getpid():
                found.append(process)
        return found

    def stop(self):
        for process in reversed(self.processes.values()):
            process.terminate()
        for process in self.processes.values():
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def main():
    if os.geteuid() != 0:
        common.skip("only root can start slurmd")
    common.install("slurm-wlm munge", ["munged", "slurmctld", "slurmd", "sbatch"])
    sweep = common.Sweep()
    slurm = Slurm(sweep.folder)
    try:
        slurm.start_all()
        alone = sweep.whole()
        shard = sweep.shard("$SLURM_ARRAY_TASK_ID")
        text = JOB.format(shards=common.SHARDS, folder=sweep.folder, command=" ".join(shard))
        job = sweep.folder / "job.sh"
        job.write_text(text, encoding="utf-8")
        begun = time.monotonic()
        submitted = slurm.ask("sbatch", f"--chdir={sweep.folder}", str(job))
        common.tell(submitted)
        number = submitted.split()[-1]
        stopped = slurm.stop_one(sweep, number)
        lost, node = slurm.lose_one(sweep, stopped)
        while "down" not in (state := slurm.ask("sinfo", "-h", "-n", node, "-o", "%T")):
            time.sleep(0.2)
        queue = slurm.ask("squeue", "-h", "-r", "-o", "%K %T").splitlines()
        shard = next((line.split()[1] for line in queue if line.split()[0] == str(lost)), "gone")
        common.tell(f"slurmctld: {node} is {state.strip('*')}, shard {lost} is {shard.lower()}")
        slurm.start_worker(int(node[-1]))
        while queue := slurm.ask("squeue", "-h", "-r"):
            if "slurm_load_jobs error" in queue:
                sys.exit(f"FAILED: {queue}")
            time.sleep(0.5)
        seconds = time.monotonic() - begun
        for k in (stopped, lost):
            common.tell("\n".join((sweep.folder / f"shard-{k}.told").read_text().strip().splitlines()))
        sweep.finish("Slurm, two nodes", seconds, alone)
    finally:
        slurm.stop()


if __name__ == "__main__":
    main()
