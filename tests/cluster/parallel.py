"""GNU parallel: `python3 tests/cluster/parallel.py`.

Two jobs at a time. One of them is killed, which `--retries` does again; then parallel and all of its jobs are killed, as where a
machine goes down, and `--resume-failed` goes on by the log of the jobs.
"""

import os
import signal
import subprocess
import sys
import time

import common


def start(sweep, more):
    """Starts parallel in a process group of its own."""
    words = ["parallel", "--will-cite", "--jobs", "2", "--joblog", str(sweep.folder / "joblog"), "--retries", "3", *more]
    numbers = [str(k) for k in range(1, common.SHARDS + 1)]
    told = open(sweep.folder / "told", "a", encoding="utf-8")
    return subprocess.Popen([*words, *sweep.shard("{}"), ":::", *numbers], stderr=told, start_new_session=True)


def main():
    common.install("parallel", ["parallel"])
    sweep = common.Sweep()
    alone = sweep.whole()
    begun = time.monotonic()
    parallel = start(sweep, [])
    work = sweep.wait_for_middle()
    lost, process = next(iter(work.items()))
    kept = sweep.kept(lost)
    os.kill(process, signal.SIGKILL)
    common.tell(f"killed a job (-9) that had {kept} cells of shard {lost}")
    while sweep.log(lost).exists() and lost not in sweep.at_work():
        time.sleep(0.01)
    common.tell(f"parallel does shard {lost} again")
    time.sleep(5)
    work = sweep.at_work()
    os.killpg(parallel.pid, signal.SIGKILL)
    parallel.wait()
    # Jobs have process groups of their own.
    for process in sweep.at_work().values():
        os.kill(process, signal.SIGKILL)
    done = len((sweep.folder / "joblog").read_text().splitlines()) - 1
    shards = " and ".join(str(k) for k in sorted(work))
    common.tell(f"killed parallel (-9) and its jobs: {done} shards done, {shards} at work")
    code = start(sweep, ["--resume-failed"]).wait()
    seconds = time.monotonic() - begun
    if code != 0:
        sys.exit(f"FAILED: parallel ended with {code}: {(sweep.folder / 'told').read_text()}")
    sweep.finish("GNU parallel, two jobs at a time", seconds, alone)


if __name__ == "__main__":
    main()
