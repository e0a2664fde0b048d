#!/usr/bin/env python3
"""Does each fault of faults.csv fail the test that must catch it?

    python3 tests/mutants/run.py [FAULT]...

Applies faults.patch to a copy of the files that git tracks, and builds its tests once, both in target/mutants. Each named test
must pass without a fault and fail with its fault, which the environment variable STICKSLIP_MUTANT selects. Exits with 1 if a
fault survives.
"""
import csv
import json
import os
import shutil
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
PATCH = TOP / "tests/mutants/faults.patch"
COPY = TOP / "target/mutants/source"
# A fault that keeps a test from ending is caught. The slowest test takes 60 s.
SECONDS = 300


def plant():
    """Copies the sources and applies the faults. Times of files stay, so that cargo builds again only what changed."""
    shutil.rmtree(COPY, ignore_errors=True)
    for name in subprocess.check_output(["git", "ls-files", "-z"], cwd=TOP, text=True).rstrip("\0").split("\0"):
        (COPY / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(TOP / name, COPY / name, follow_symlinks=False)
    # Without the ceiling, git would take the copy for an ignored folder of this repository and skip it.
    alone = os.environ | {"GIT_CEILING_DIRECTORIES": str(COPY.parent)}
    subprocess.run(["git", "apply", PATCH], cwd=COPY, env=alone, check=True)
    for line in PATCH.read_text().splitlines():
        if line.startswith("+++ b/"):
            file = line.removeprefix("+++ b/")
            times = [path.stat().st_mtime for path in (PATCH, TOP / file) if path.exists()]
            os.utime(COPY / file, (max(times), max(times)))


def build(programs):
    """The test executable of each program (a test of tests/, or a package's library), by name."""
    wanted = sorted({"--lib" if name.startswith("stickslip") else f"--test={name}" for name in programs})
    command = ["cargo", "test", "--locked", "--no-run", *wanted, "--target-dir", COPY.parent]
    built = subprocess.run(
        [*command, "--message-format", "json-render-diagnostics"],
        cwd=COPY, stdout=subprocess.PIPE, text=True, check=True,
    )
    messages = map(json.loads, built.stdout.splitlines())
    made = [m for m in messages if m["reason"] == "compiler-artifact" and m["profile"]["test"]]
    return {m["target"]["name"]: (m["executable"], Path(m["manifest_path"]).parent) for m in made}


def passes(executable, test, fault):
    """Whether exactly this test passes in a process with this fault."""
    path, folder = executable
    environment = {k: v for k, v in os.environ.items() if k != "STICKSLIP_MUTANT"}
    environment |= {"INSTA_UPDATE": "no", "INSTA_WORKSPACE_ROOT": str(COPY)}
    if fault:
        environment["STICKSLIP_MUTANT"] = fault
    # A session of its own, so that what the test started ends with it.
    process = subprocess.Popen(
        [path, "--exact", test], cwd=folder, env=environment, start_new_session=True, text=True, errors="replace",
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )
    try:
        told, _ = process.communicate(timeout=SECONDS)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return False
    return process.returncode == 0 and "1 passed" in told


def main():
    with open(Path(__file__).with_name("faults.csv"), newline="") as table:
        rows = [row for row in csv.DictReader(table) if row["fault"] in sys.argv[1:] or not sys.argv[1:]]
    plant()
    programs = build({row["program"] for row in rows})
    tests = {(row["program"], row["test"]) for row in rows}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        sound = dict(zip(tests, pool.map(lambda t: passes(programs[t[0]], t[1], None), tests)))
        run = lambda row: passes(programs[row["program"]], row["test"], row["fault"])
        survives = list(pool.map(run, rows))
    bad = 0
    for row, survived in zip(rows, survives):
        broken = not sound[row["program"], row["test"]]
        result = "fails without it" if broken else "survives" if survived else "caught"
        bad += result != "caught"
        print(f"{result:20} {row['fault']:38} {row['program']} {row['test']}")
    print(f"{len(rows) - bad} of {len(rows)} faults are caught")
    return 1 if bad or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
