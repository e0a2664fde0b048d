#!/usr/bin/env python3
"""Installs the program as a stranger would, and takes it for a walk where nothing else is.

The committed sources are copied far from the repository, and the program is installed from there (`cargo install --path .`). Then the walk of five minutes and more of the manual is done in a folder that holds the
program alone: where this is run as root, the folder is all that the program sees (chroot), with the libraries that the
program is linked with; else it is an empty folder, an empty home and a path with nothing else.

    tests/install/run.py [--debug] [--features LIST] [--program FILE]

--debug builds faster; --program walks with a program that is there. --features takes the place of the default ones; `--features ""`
is a cluster's build. What is built is kept below CARGO_TARGET_DIR, if that is set.
"""

import argparse
import fcntl
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
import time
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
MOST_BYTES = 15_000_000


def say(text):
    print(text, flush=True)


def installed(place, options):
    """Installs the program from a copy of what is committed."""
    sources, root = place / "sources", place / "root"
    sources.mkdir()
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=TOP, check=True, capture_output=True).stdout
    subprocess.run(["tar", "-x"], cwd=sources, input=archive, check=True)
    arguments = ["install", "--path", ".", "--root", str(root), "--locked", "--quiet"]
    arguments += ["--debug"] if options.debug else ["--profile", "dist"]
    if options.features is not None:
        arguments += ["--no-default-features", "--features", options.features]
    begin = time.monotonic()
    subprocess.run(["cargo", *arguments], cwd=sources, check=True)
    program = root / "bin" / "stickslip"
    size = program.stat().st_size
    say(f"installed   {size / 1e6:.2f} MB in {time.monotonic() - begin:.0f} s")
    if not options.debug and size >= MOST_BYTES:
        sys.exit(f"the program has {size} bytes; it must have less than {MOST_BYTES}")
    return program


class Place:
    """A folder in which the program is alone."""

    def __init__(self, folder, program):
        self.folder, self.own_root = folder, os.geteuid() == 0
        for name in ["bin", "home", "work", "tmp"]:
            (folder / name).mkdir(parents=True)
        shutil.copy(program, folder / "bin" / "stickslip")
        if self.own_root:
            linked = subprocess.run(["ldd", str(program)], capture_output=True, text=True).stdout
            for library in re.findall(r"(/\S+) \(0x", linked):
                to = folder / library.lstrip("/")
                to.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(library, to)
            self.root = ""
        else:
            self.root = str(folder)
        self.environment = {
            "PATH": f"{self.root}/bin",
            "HOME": f"{self.root}/home",
            "TMPDIR": f"{self.root}/tmp",
            "TERM": "xterm-256color",
        }
        say("alone       " + (
            "the folder is all that the program sees (chroot): "
            + ", ".join(sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()))
            if self.own_root else "in an empty folder; not as root, so the rest of the machine is there"
        ))

    def enter(self):
        if self.own_root:
            os.chroot(self.folder)
        os.chdir(f"{self.root}/work")

    def run(self, *arguments, code=0):
        """Runs the program without a terminal; gives what it wrote."""
        command = [f"{self.root}/bin/stickslip", *arguments]
        done = subprocess.run(
            command, env=self.environment, preexec_fn=self.enter, stdin=subprocess.DEVNULL, capture_output=True, text=True
        )
        if done.returncode != code:
            sys.exit(f"stickslip {' '.join(arguments)}: code {done.returncode}, and not {code}\n{done.stdout}{done.stderr}")
        return done.stdout, done.stderr

    def last_words(self, *arguments):
        """The last line that the program wrote."""
        return "".join(self.run(*arguments)).strip().splitlines()[-1]

    def redrawn(self, terminal):
        """All letters of the screen, in their order, without blanks."""
        os.write(terminal, b"\x0c")
        seen = b""
        while select.select([terminal], [], [], 0.3)[0]:
            seen += os.read(terminal, 65536)
        seen = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", seen.decode(errors="replace"))
        return re.sub(r"\s", "", seen)

    def first_screen(self, scene):
        """Seconds from the start of the debugger until its footer is drawn."""
        begin = time.monotonic()
        child, terminal = pty.fork()
        if child == 0:
            self.enter()
            os.execve(f"{self.root}/bin/stickslip", ["stickslip", scene], {**self.environment, "LINES": "40", "COLUMNS": "120"})
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
        seen = b""
        while b"quit" not in seen:
            seen += os.read(terminal, 65536)
        seconds = time.monotonic() - begin
        os.write(terminal, b"q")
        try:
            while os.read(terminal, 65536):
                pass
        except OSError:
            pass
        os.waitpid(child, 0)
        return seconds

    def starts(self, walks):
        """What starts take; nothing is concluded from it."""
        def timed(*arguments):
            begin = time.monotonic()
            self.run(*arguments)
            return time.monotonic() - begin
        told = {"--version": [timed("--version") for _ in range(30)], "list": [timed("list") for _ in range(30)]}
        if walks:
            told["first screen"] = [self.first_screen("01-pinned-beam-rough-floor") for _ in range(30)]
        for what, seconds in told.items():
            seconds.sort()
            say(f"starts      {what}: {1e3 * seconds[0]:.1f} ms at least, {1e3 * seconds[15]:.1f} in the middle of 30")

    def debug(self, scene, steps):
        """The debugger in a terminal: keys, and what it must say after them."""
        child, terminal = pty.fork()
        if child == 0:
            self.enter()
            os.execve(f"{self.root}/bin/stickslip", ["stickslip", scene], {**self.environment, "LINES": "40", "COLUMNS": "120"})
        subprocess.run(["stty", "rows", "40", "columns", "120"], stdin=terminal, check=True)
        for keys, wanted in steps:
            os.write(terminal, keys.encode())
            until = time.monotonic() + 30
            # What did not change is not sent, but for Ctrl-L; blanks are only passed over.
            while wanted.replace(" ", "") not in self.redrawn(terminal):
                if time.monotonic() > until:
                    sys.exit(f"{scene}, {keys!r}: '{wanted}' never appears: {self.redrawn(terminal)}")
            say(f"walked      {keys!r:8} {wanted}")
        os.write(terminal, b"q")
        until = time.monotonic() + 10
        while time.monotonic() < until and select.select([terminal], [], [], 1)[0]:
            try:
                if not os.read(terminal, 65536):
                    break
            except OSError:
                break
        _, status = os.waitpid(child, 0)
        if os.waitstatus_to_exitcode(status) != 0:
            sys.exit(f"the debugger ended with {status}")


def without_terminal(place, features):
    """What every build does."""
    place.run("run", "01-pinned-beam-rough-floor", "--csv", "01.csv", "--snapshot", "01.snapshot")
    rows = (place.folder / "work/01.csv").read_text().splitlines()
    say(f"run         01-pinned-beam-rough-floor: {len(rows) - 1} increments, last {rows[-1][:60]}")
    say("replay      " + place.last_words("replay", "01.snapshot"))
    place.run("check", "01-pinned-beam-rough-floor")
    scenes = [line.split()[0] for line in place.run("list")[0].splitlines() if line and not line.startswith(" ")]
    for scene in scenes:
        place.run("show", scene, "-o", f"{scene}.ron")
        place.run("check", f"{scene}.ron")
    say(f"shown       {len(scenes)} scenes, each written and checked from its file")
    lessons = [line.split()[0] for line in place.run("lesson")[0].splitlines()]
    for lesson in lessons:
        place.run("lesson", lesson, "--check")
    say(f"lessons     {len(lessons)} played through")
    text = place.run("help")[0]
    pages = re.findall(r"^  (\S+)  ", text, re.M)
    size = sum(len(place.run("help", page)[0]) for page in pages)
    say(f"help        {len(pages)} pages, {size / 1e3:.0f} kB")
    place.run("study", "fig-11-roles", "--csv", "study.csv", "--quiet")
    place.run("study", "benchmarks", "--csv", "benchmarks.csv", "--quiet")
    place.run("map", "--random", "200", "--csv", "map.csv", "--quiet")
    place.run("chart", "01-pinned-beam-rough-floor", "--repeats", "1", "--csv", "chart.csv", "--quiet")
    say("sweeps      study fig-11-roles, study benchmarks, map --random 200, chart 01-pinned-beam-rough-floor")
    place.run("completions", "bash", "-o", "stickslip.bash")
    place.run("man", "-o", "man1")
    say(f"files       stickslip.bash, {len(list((place.folder / 'work/man1').iterdir()))} pages for man")
    for feature, arguments in [
        ("plot", ["export", "01-pinned-beam-rough-floor", "-o", "01.svg"]),
        ("plot", ["map", "--random", "20", "--png", "map.png", "--quiet"]),
        ("tui", ["01-pinned-beam-rough-floor"]),
    ]:
        if feature in features:
            # The debugger itself needs a terminal, and has one below.
            place.run(*arguments, code=2 if feature == "tui" else 0)
        else:
            say(f"{feature:11} {place.run(*arguments, code=2)[1].strip()}")


def walk(place):
    """Five minutes with problem 01, as on page tour."""
    work = place.folder / "work"
    before = set(work.iterdir())
    place.debug("01-pinned-beam-rough-floor", [
        ("", "nothing is solved yet"),
        ("s", "sliding"),
        ("f", "increment 1"),
        ("24f", "0.25"),
        ("s", "fixed"),
        ("17f", "0.08"),
        ("c", "the history is complete"),
        ("w", "wrote"),
    ])
    for snapshot in set(work.iterdir()) - before or sys.exit("no snapshot was written"):
        say("replay      " + place.last_words("replay", snapshot.name))
    say("resume      " + place.last_words("resume", "--check"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--debug", action="store_true")
    parser.add_argument("--features")
    parser.add_argument("--program", help="takes a walk with this program, and builds nothing")
    options = parser.parse_args()
    features = ["tui", "plot"] if options.features is None else options.features.split(",")
    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        folder = Path(folder)
        if options.program:
            program = Path(options.program)
        else:
            program = installed(folder, options)
        place = Place(folder / "alone", program)
        say(place.run("--version", "--verbose")[0].rstrip())
        place.starts("tui" in features)
        without_terminal(place, features)
        if "tui" in features:
            walk(place)
    say("all is well")


main()
