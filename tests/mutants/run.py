#!/usr/bin/env python3
"""Does each fault of faults.csv fail the test that must catch it?

    python3 tests/mutants/run.py [FAULT]...

Builds the tests once with `--cfg mutants` into target/mutants. Each named test must pass without a fault and fail with its
fault, which the environment variable STICKSLIP_MUTANT selects. Exits with 1 if a fault survives.
"""
import csv
import json
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
# A fault that keeps a test from ending is caught. The slowest test takes 60 s.
SECONDS = 300


def build(programs):
    """The test executable of each program (a test of tests/, or a package's library), by name."""
    flags = os.environ.get("RUSTFLAGS", "") + " --cfg mutants"
    wanted = sorted({"--lib" if name.startswith("stickslip") else f"--test={name}" for name in programs})
    command = ["cargo", "test", "--locked", "--no-run", *wanted, "--target-dir", "target/mutants"]
    built = subprocess.run(
        [*command, "--message-format", "json-render-diagnostics"],
        cwd=TOP, env=os.environ | {"RUSTFLAGS": flags}, stdout=subprocess.PIPE, text=True, check=True,
    )
    messages = map(json.loads, built.stdout.splitlines())
    made = [m for m in messages if m["reason"] == "compiler-artifact" and m["profile"]["test"]]
    return {m["target"]["name"]: (m["executable"], Path(m["manifest_path"]).parent) for m in made}


def passes(executable, test, fault):
    """Whether exactly this test passes in a process with this fault."""
    path, folder = executable
    environment = {k: v for k, v in os.environ.items() if k != "STICKSLIP_MUTANT"}
    environment |= {"INSTA_UPDATE": "no", "INSTA_WORKSPACE_ROOT": str(TOP)}
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
