#!/usr/bin/env python3
"""Runs the program for Windows under wine: tests of packages and commands, a run, and a session with keys.

    apt install wine64 gcc-mingw-w64-x86-64
    rustup target add x86_64-pc-windows-gnu
    tests/wine/run.py [--program FILE.exe] [--native FILE]

--program skips the build and the tests. --native is the program for this system, whose files are compared (target/debug/stickslip).
Exit code 1 if anything differs. Wine 8 shows the screens with faults, so the session is judged by the files that it writes.
"""

import argparse
import csv
import os
import pathlib
import pty
import subprocess
import sys
import tempfile
import threading
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
TARGET = "x86_64-pc-windows-gnu"
# Largest difference that round-off explains, in parts of the largest number of a column: elementary functions differ in the last bit.
ROUND_OFF = 1e-9
SCENES = ["01-pinned-beam-rough-floor", "osc-two6", "02-two-cantilevers-rough"]
# Rust needs it since 1.78, and wine has it since 9.0.
RANDOM = """#include <windows.h>
#include <ntsecapi.h>
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T size) { return RtlGenRandom(data, (ULONG)size); }
"""


def wine():
    found = [path for path in ["/usr/lib/wine/wine64", "/usr/bin/wine64"] if os.path.exists(path)]
    return found[0] if found else sys.exit("wine64 is missing: apt install wine64")


def prepare(folder):
    """A prefix with the library that wine 8 lacks. Returns the environment."""
    environment = {**os.environ, "WINEPREFIX": str(folder / "prefix"), "WINEDEBUG": "-all"}
    subprocess.run([wine(), "wineboot", "-i"], env=environment, check=True, capture_output=True)
    library = folder / "prefix/drive_c/windows/system32/bcryptprimitives.dll"
    if not library.exists():
        source = folder / "random.c"
        source.write_text(RANDOM)
        subprocess.run(["x86_64-w64-mingw32-gcc", "-shared", "-o", library, source, "-ladvapi32"], check=True)
    return environment


def tested(environment):
    """Builds the program and its tests, and runs those of five packages and of snapshots. Returns the program."""
    environment = {**environment, f"CARGO_TARGET_{TARGET.upper().replace('-', '_')}_RUNNER": wine()}
    cargo = ["cargo", "test", "--locked", "--target", TARGET, "--quiet"]
    packages = ["stickslip-core", "stickslip-linalg", "stickslip-exchange", "stickslip-scene", "stickslip-platform"]
    for arguments in [["--lib", *(word for name in packages for word in ("-p", name))], ["--test", "debugger", "snapshot"]]:
        subprocess.run([*cargo, *arguments], cwd=TOP, env=environment, check=True)
    subprocess.run(["cargo", "build", "--locked", "--target", TARGET], cwd=TOP, check=True)
    return pathlib.Path(os.environ.get("CARGO_TARGET_DIR", TOP / "target")) / TARGET / "debug/stickslip.exe"


def session(program, folder, environment, keys):
    """The debugger in a pseudo-terminal: the keys, one after the other."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        os.execve(wine(), [wine(), str(program), "osc-two6"], {**environment, "LINES": "40", "COLUMNS": "120"})

    def drain():
        try:
            while os.read(terminal, 65536):
                pass
        except OSError:
            pass

    threading.Thread(target=drain, daemon=True).start()
    time.sleep(5)
    for key in keys:
        os.write(terminal, key.encode())
        time.sleep(2)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def deviation(ours, theirs):
    """The largest difference between two tables, in parts of the largest number of its column."""
    tables = [list(csv.reader(text.splitlines())) for text in (ours, theirs)]
    if [len(table) for table in tables] != [len(tables[1])] * 2 or tables[0][0] != tables[1][0]:
        return float("inf")
    worst = 0.0
    for column in zip(*(zip(*table[1:]) for table in tables)):
        numbers = [[float(cell or 0) for cell in cells] for cells in column]
        scale = max(map(abs, numbers[1]), default=0) or 1.0
        worst = max([worst, *(abs(a - b) / scale for a, b in zip(*numbers))])
    return worst


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=pathlib.Path)
    parser.add_argument("--native", type=pathlib.Path, default=TOP / "target/debug/stickslip")
    args = parser.parse_args()
    sound = True

    def check(holds, what):
        nonlocal sound
        sound &= holds
        print(f"{what}: {'yes' if holds else 'NO'}", flush=True)

    with tempfile.TemporaryDirectory(prefix="stickslip-wine-") as folder:
        folder = pathlib.Path(folder)
        environment = prepare(folder)
        program = (args.program or tested(environment)).resolve()

        def run(*arguments):
            return subprocess.run([wine(), program, *arguments], cwd=folder, env=environment, capture_output=True, text=True)

        def native(*arguments):
            return subprocess.run([args.native.resolve(), *arguments], cwd=folder, capture_output=True, text=True)

        for scene in SCENES:
            run("run", scene, "--csv", "windows.csv", "--quiet", "--force")
            native("run", scene, "--csv", "linux.csv", "--quiet", "--force")
            apart = deviation((folder / "windows.csv").read_text(), (folder / "linux.csv").read_text())
            check(apart <= ROUND_OFF, f"{scene}: the CSV of Linux, up to {apart:.1e}")
        crlf = (TOP / "problems/osc-two6.ron").read_text().replace("\n", "\r\n")
        (folder / "crlf.ron").write_text(crlf, newline="")
        check(run("check", r"Z:" + str(folder / "crlf.ron").replace("/", "\\")).returncode == 0, "a scene with CRLF by drive and backslashes")
        check(session(program, folder, environment, "cwq") == 0, "a session from the first key to q")
        check(native("replay", "osc-two6-1.1.6.ron").returncode == 0, "its snapshot is equal on Linux")
        check(run("replay", "osc-two6-1.1.6.ron").returncode == 0, "its snapshot is equal under wine")
        check(run("resume", "--check").returncode == 0, "its journal leads to the same bits")
    return 0 if sound else 1


sys.exit(main())
