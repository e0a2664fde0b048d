"""HyperQueue: `python3 tests/cluster/hyperqueue.py`.

Installs the package from PyPI into a folder of its own, starts its LocalCluster with two workers, kills one of them, and lets the
server give its shard to another. The workers of LocalCluster are threads of its process; so that one can be killed, each is
started by a process of its own, whose server folder is pointed to the server of the LocalCluster.
"""

import os
import signal
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

sys.path.append(sys.path[0])
import common

# This file has the name of the package.
here = sys.path.pop(0)
sys.path.remove(here)

RELEASE = "hyperqueue==0.27.0"


def worker(server):
    """Serves a server until it is killed."""
    from hyperqueue.ffi.cluster import Cluster

    cluster = Cluster(tempfile.mkdtemp())
    access = Path(cluster.server_dir) / "hq-current"
    access.unlink()
    access.symlink_to((Path(server) / "hq-current").resolve())
    cluster.add_worker(1)
    print("ready", flush=True)
    signal.pause()


def start_worker(server):
    words = [sys.executable, __file__, "worker", server]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    while "ready" not in (line := process.stdout.readline()):
        if not line:
            sys.exit("FAILED: a worker did not start")
    return process


def children(process):
    """The shards that a worker has at work."""
    text = Path(f"/proc/{process.pid}/task").glob("*/children")
    return [int(child) for thread in text for child in thread.read_text().split()]


def main():
    from hyperqueue import Job, LocalCluster

    sweep = common.Sweep()
    alone = sweep.whole()
    with LocalCluster() as cluster:
        server = cluster.cluster.server_dir
        workers = [start_worker(server) for _ in range(2)]
        job = Job(max_fails=1)
        for k in range(1, common.SHARDS + 1):
            told = str(sweep.folder / f"shard-{k}.told")
            job.program(sweep.shard(k), stdout=None, stderr=told, cwd=str(sweep.folder), crash_limit=5)
        client = cluster.client()
        start = time.monotonic()
        submitted = client.submit(job)
        lost = None
        while lost is None:
            work = sweep.wait_for_middle()
            own = children(workers[0])
            lost = next((k for k, process in work.items() if process in own), None)
        os.kill(workers[0].pid, signal.SIGKILL)
        workers[0].wait()
        common.tell(f"killed a worker (-9) that had {sweep.kept(lost)} cells of shard {lost}")
        workers.append(start_worker(server))
        client.wait_for_jobs([submitted])
        seconds = time.monotonic() - start
        common.tell("done again: " + (sweep.folder / f"shard-{lost}.told").read_text().strip())
        for process in workers[1:]:
            process.kill()
    sweep.finish("HyperQueue, two workers", seconds, alone)


if __name__ == "__main__":
    if sys.argv[1:2] == ["worker"]:
        worker(sys.argv[2])
    elif sys.argv[1:2] == ["installed"]:
        main()
    else:
        folder = Path(tempfile.mkdtemp(prefix="hyperqueue-"))
        venv.create(folder, with_pip=True)
        python = str(folder / "bin/python")
        pip = [python, "-m", "pip", "install", "-q", RELEASE]
        done = subprocess.run(pip, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            common.skip(f"{RELEASE} cannot be installed: {done.stderr.strip()[-300:]}")
        common.tell(f"installed {RELEASE} from PyPI")
        sys.exit(subprocess.run([python, __file__, "installed"], check=False).returncode)
