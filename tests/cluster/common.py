"""What the runners share: the map, its shards, the whole to compare with, and what is told.

The program is $STICKSLIP, else target/release/stickslip. Cells of the map: 200 angles of friction by 100 increments of problem 02,
some 3 ms each.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SHARDS = 40
SWEEP = "map 02-two-cantilevers-rough --over friction=5..45/200 --over increment=0.1..0.5/100".split()
# A picture of pixels would have 230 million of them.
FILES = ["csv", "svg"]
# What test harnesses take for "could not be tried".
SKIPPED = 77


def skip(why):
    print(f"SKIPPED: {why}", flush=True)
    sys.exit(SKIPPED)


def tell(text):
    print(text, flush=True)


def program():
    own = Path(__file__).resolve().parents[2] / "target/release/stickslip"
    found = Path(os.environ.get("STICKSLIP", own)).resolve()
    if not found.is_file():
        skip(f"there is no {found}; cargo build --release makes it, or STICKSLIP names another")
    return str(found)


def install(package, commands):
    """Debian's package, unless its commands are there."""
    def missing():
        paths = os.environ["PATH"].split(":") + ["/usr/sbin", "/sbin"]
        return [c for c in commands if not any(os.access(f"{p}/{c}", os.X_OK) for p in paths)]
    if not missing():
        return
    apt = ["apt-get", "install", "-y", "-q", "--no-install-recommends", *package.split()]
    subprocess.run(["apt-get", "update", "-q"], capture_output=True, check=False)
    done = subprocess.run(apt, capture_output=True, text=True, check=False)
    if done.returncode != 0 or missing():
        skip(f"{package} cannot be installed: {(done.stderr or done.stdout).strip()[-300:]}")


class Sweep:
    """One map in a folder: whole, in shards, and put together again."""

    def __init__(self):
        self.program = program()
        self.folder = Path(tempfile.mkdtemp(prefix="stickslip-cluster-"))
        version = subprocess.run([self.program, "--version"], capture_output=True, text=True, check=True)
        tell(f"{version.stdout.strip()}, {os.cpu_count()} cores")
        tell(" ".join(["stickslip", *SWEEP]))

    def log(self, k):
        return self.folder / f"shard-{k}.log"

    def shard(self, k):
        """The command of a shard."""
        return [self.program, *SWEEP, "--jobs", "1", "--shard", f"{k}/{SHARDS}", "--log", str(self.log(k))]

    def kept(self, k):
        """Cells of a shard that its log has."""
        log = self.log(k)
        # A line for the program, and one for the input.
        return max(log.read_bytes().count(b"\n") - 2, 0) if log.exists() else 0

    def at_work(self, but=()):
        """The shards that are being done, by their processes: number to process."""
        found = {}
        for process in Path("/proc").iterdir():
            if process.name.isdigit():
                try:
                    words = (process / "cmdline").read_bytes().split(b"\0")
                    state = (process / "stat").read_text().rsplit(")", 1)[1].split()[0]
                except OSError:
                    continue
                if words[0] != self.program.encode() or state == "Z":
                    continue
                for k in range(1, SHARDS + 1):
                    if str(self.log(k)).encode() in words and k not in but:
                        found[k] = int(process.name)
        return found

    def wait_for_middle(self, but=()):
        """Waits until a fourth of the shards have begun; those that have done a part that leaves time to stop them."""
        while True:
            begun = sum(self.log(k).exists() for k in range(1, SHARDS + 1))
            work = {k: process for k, process in self.at_work(but).items() if 20 < self.kept(k) < 250}
            if begun > SHARDS / 4 and work:
                return work
            if begun == SHARDS and not self.at_work(but):
                sys.exit("FAILED: all shards were done before one could be stopped")
            time.sleep(0.02)

    def whole(self):
        """Runs the map on this machine without any engine; seconds."""
        start = time.monotonic()
        self.run(["--jobs", "2", *self.outputs("whole")])
        seconds = time.monotonic() - start
        rows = sum(1 for line in open(self.folder / "whole.csv") if not line.startswith("#")) - 1
        tell(f"one machine, --jobs 2: {rows} cells in {seconds:.1f} s")
        return seconds

    def outputs(self, name):
        return [word for kind in FILES for word in (f"--{kind}", str(self.folder / f"{name}.{kind}"))]

    def run(self, words):
        done = subprocess.run([self.program, *SWEEP, "--quiet", *words], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"FAILED: exit {done.returncode}: {done.stderr}")

    def finish(self, engine, seconds, alone):
        """Puts the shards together and compares."""
        start = time.monotonic()
        self.run(["--merge", *(str(self.log(k)) for k in range(SHARDS, 0, -1)), *self.outputs("merged")])
        merging = time.monotonic() - start
        size = sum(self.log(k).stat().st_size for k in range(1, SHARDS + 1))
        tell(f"{engine}: {SHARDS} shards in {seconds:.1f} s, {100 * (seconds / alone - 1):+.0f} % beside one machine")
        tell(f"merged {size / 1e6:.1f} MB of logs in {merging:.1f} s")
        for kind in FILES:
            one, other = ((self.folder / f"{name}.{kind}").read_bytes() for name in ("whole", "merged"))
            if one != other:
                sys.exit(f"FAILED: the {kind} differs: {self.folder}")
        tell("csv and svg: the same bytes as the unsharded run")
