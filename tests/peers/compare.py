#!/usr/bin/env python3
"""stickslip beside CalculiX and GetFEM on the same scenes, measured in one run.

    cargo build --release && tests/peers/compare.py [--out DIR] [--repeats N] [--scenes a,d] [--sizes 8,23,52,72]

Scene A is problem 04 (a cantilever wrapping round a rigid circle; error: of its tip at P = 3.5 against the elastica). Every
program takes the load as a good user would let it: stickslip in 4 increments, with beams of 3 to 7 nodes an element and a
tolerance of 1e-7, which leaves errors above 1e-6 of the tip as they are with 1e-11; GetFEM in 100, since it
fails with fewer, down to a residual of 1e-4; CalculiX as it chooses. What a mesh errs by depends on where the wrapped length
ends between two of its nodes, in all of them: a peer's run is set beside the cheapest of stickslip's with no more error.
Scene D is two Q8 blocks, non-matching, pressed and sheared with friction (error: of the end force at the interface against
stickslip's own finest run: codes and contact laws differ by more than that). Each program runs as a process of its own,
single-threaded; time is processor time of the whole process, start included, the median of N. Repetitions take turns, so
that a busy machine harms all alike. A peer that is not installed is skipped, and said to be.

It writes a.csv and d.csv, their charts (a.svg, d.svg, drawn by `stickslip chart --from`), and a table of ratios to standard
output. Peers come with `apt-get install calculix-ccx python3-getfem`; $CCX and $GETFEM_PYTHON name other ones.
"""
import argparse
import csv
import math
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from runlib import dat, run1, sta  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(HERE))
CIRCLE = "04-cantilever-rigid-circle"
# What GetFEM stops at on scene D; the errors that are measured there are above it.
TOLERANCE = "settings.tolerance=1e-6"
# Of scene A: nodes an element, with the numbers of elements.
MESHES = ((3, (5, 10, 15, 20, 30, 40)), (4, (3, 5, 8, 10, 15, 20, 30)), (5, (3, 5, 10, 20)), (6, (3, 5, 10)), (7, (3, 5, 8, 10)))
COLUMNS = ["scene", "series", "run", "status", "error", "seconds", "repeats", "megabytes", "unknowns", "iterations"]


def truth():
    """The tip's displacement at P = 3.5: (u, v), by the program's own reference."""
    path = os.path.join(ROOT, "problems", "references", CIRCLE + ".csv")
    with open(path) as f:
        rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
    last = rows[-1]
    assert float(last["load"]) == 3.5
    return float(last["u_x"]), float(last["u_y"])


class Case:
    """One program on one scene with one mesh; `prepare` makes its input, `read` finds error, unknowns and iterations."""

    def __init__(self, series, name, command, prepare, read):
        self.series, self.name, self.command = series, name, command
        self.prepare, self.read = prepare, read
        self.times, self.memory, self.status = [], [], "whole"
        self.result = None

    def run(self, work, timeout):
        log = re.sub(r"[^a-z0-9]+", "-", (self.series + "-" + self.name).lower()) + ".log"
        if self.prepare:
            self.prepare(work)
        r = run1(self.command, work, log, timeout, {"OMP_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"})
        self.times.append(r["cpu"])
        self.memory.append(r["rss"])
        if r["rc"] == "timeout":
            self.status = "no end within %g s" % timeout
            return
        with open(os.path.join(work, log)) as f:
            text = f.read()
        result = self.read(work, text)
        if isinstance(result, str):
            self.status = result
        else:
            self.result = result


def generate(script, *arguments):
    def prepare(work):
        subprocess.run([sys.executable, os.path.join(HERE, script), *arguments], cwd=work, check=True,
                       stdout=subprocess.DEVNULL)
    return prepare


def scene_a(tools):
    u, v = truth()

    def error(x, y):
        return math.hypot(x - u, y - v)

    cases = []
    for nodes, counts in MESHES:
        for elements in counts:
            command = [tools["stickslip"], "run", CIRCLE, "--quiet", "--csv", "-", "--set",
                       "nodes.beam.elements=%d" % elements, "--set", "nodes.beam.per_element=%d" % nodes, "--set", "history.increment=0.875",
                       "--set", "settings.tolerance=1e-7"]

            def read(work, text):
                rows = [line for line in text.splitlines() if re.match(r"\d+,", line)]
                fields = rows[-1].split(",") if rows else []
                if not fields or float(fields[1]) != 3.5:
                    return "stopped: " + text.strip().splitlines()[-1][:60]
                iterations = sum(int(row.split(",")[3]) for row in rows)
                return error(float(fields[4]), float(fields[5])), None, iterations
            cases.append(Case("stickslip, %d nodes an element" % nodes, "elements=%d" % elements, command, None, read))
    if tools["ccx"]:
        for elements in (5, 10, 20, 40, 80):
            name = "a%d" % elements

            def read(work, text, name=name):
                increments, iterations, _, time = sta(os.path.join(work, name + ".sta"))
                values = dat(os.path.join(work, name + ".dat"))
                if abs(time - 1) > 1e-9 or not values:
                    return "stopped at %g of the load" % time
                # Its beam lies along +x and is pressed towards -y.
                x, y = values[-1][0], values[-1][1]
                return error(-y, x), None, iterations
            prepare = generate("gen_ccx_a.py", name + ".inp", "nel=%d" % elements, "R=1", "ctype=NODE TO SURFACE")
            cases.append(Case("CalculiX, node to surface", "elements=%d" % elements, [tools["ccx"], "-i", name], prepare,
                              read))
    if tools["getfem"]:
        for series, settings in (("GetFEM, penalty term", ["penalty=1"]), ("GetFEM, augmented Lagrangian", [])):
            for elements in (5, 10, 20, 40, 80) if settings else (10, 20, 40):
                command = [tools["getfem"], os.path.join(HERE, "getfem_a.py"), "nel=%d" % elements, "ninc=100"] + settings

                def read(work, text):
                    m = re.search(r"RESULT ok=(\d) inc=\d+ it=(\d+) ux=(\S+) uy=(\S+)", text)
                    if not m or m[1] != "1":
                        return "stopped without convergence"
                    return error(-float(m[4]), float(m[3])), None, int(m[2])
                cases.append(Case(series, "elements=%d" % elements, command, None, read))
    return cases


def scene_d(tools, sizes):
    """Errors are forces here: (tangential, normal); they become errors when all are there."""
    cases = []
    for n in sizes:
        file = "d%d.ron" % n
        command = [tools["stickslip"], "run", file, "--quiet", "--csv", "-", "--set", TOLERANCE]

        def read(work, text, file=file):
            rows = [line for line in text.splitlines() if re.match(r"\d+,", line)]
            fields = rows[-1].split(",") if rows else []
            if not fields or float(fields[1]) != 15:
                return "stopped: " + text.strip().splitlines()[-1][:60]
            iterations = sum(int(row.split(",")[2]) for row in rows)
            return (abs(float(fields[4])), float(fields[5])), None, iterations
        made = generate("gen_stickslip_d.py", file, "n=%d" % n)
        cases.append(Case("stickslip", "n=%d" % n, command, made, read))
        old = command + ["--set", "settings.factor=needed"]
        cases.append(Case("stickslip, old factors", "n=%d" % n, old, made, read))
        deck = generate("gen_ccx_d.py", "d%d.inp" % n, "n=%d" % n, "ctype=NODE TO SURFACE")

        def read(work, text):
            rows = [row.split(",") for row in text.splitlines() if re.match(r"\d+,", row)]
            if not rows or float(rows[-1][1]) != 2:
                return "stopped: " + text.strip().splitlines()[-1][:60]
            iterations = sum(int(row[2]) for row in rows)
            return (abs(float(rows[-1][4])), float(rows[-1][5])), len(rows), iterations
        command = [tools["stickslip"], "run", "d%d.inp" % n, "--quiet", "--csv", "-"]
        cases.append(Case("stickslip, CalculiX's deck", "n=%d" % n, command, deck, read))
        if tools["ccx"]:
            name = "d%d" % n

            def read(work, text, name=name):
                _, iterations, _, time = sta(os.path.join(work, name + ".sta"))
                forces = []
                with open(os.path.join(work, name + ".dat")) as f:
                    for line in f:
                        words = line.split()
                        if len(words) == 3 and re.match(r"[-+0-9.]", words[0]):
                            forces.append([float(word) for word in words])
                if abs(time - 2) > 1e-9 or not forces:
                    return "stopped at %g of 2 steps" % time
                return (abs(forces[-1][0]), abs(forces[-1][1])), None, iterations
            cases.append(Case("CalculiX, node to surface", "n=%d" % n, [tools["ccx"], "-i", name], deck, read))
        if tools["getfem"]:
            command = [tools["getfem"], os.path.join(HERE, "getfem_d.py"), "n=%d" % n]

            def read(work, text):
                m = re.search(r"RESULT ok=(\d) dof=(\d+) inc=\d+ it=(\d+) \S+ Fx_end=(\S+) Fy_end=(\S+)", text)
                if not m or m[1] != "1":
                    return "stopped without convergence"
                return (abs(float(m[4])), abs(float(m[5]))), None, int(m[3])
            cases.append(Case("GetFEM, augmented Lagrangian", "n=%d" % n, command, None, read))
    return cases


def unknowns_d(n):
    """Displacements of the mesh of scene D: two of each node."""
    def nodes(x, y):
        return (2 * x + 1) * (2 * y + 1) - x * y
    return 2 * (nodes(2 * n, n) + nodes(max(1, round(1.5 * n)), max(1, round(0.75 * n))))


def measure(cases, work, repeats, timeout):
    """Runs all, in turns; what takes long runs less often."""
    for turn in range(repeats):
        for case in cases:
            if case.status != "whole" or (turn > 0 and sum(case.times) > 60):
                continue
            case.run(work, timeout)
            print("  %d  %-32s %-14s %8.2f s  %s" % (turn + 1, case.series, case.name, case.times[-1], case.status),
                  file=sys.stderr, flush=True)


def write(path, scene, about, cases, errors):
    with open(path, "w") as f:
        for line in about:
            f.write("# %s\n" % line)
        table = csv.writer(f, lineterminator="\n")
        table.writerow(COLUMNS)
        for case, error in zip(cases, errors):
            status = "reference" if case.status == "whole" and error is None else case.status
            unknowns = unknowns_d(int(case.name[2:])) if case.name.startswith("n=") else ""
            iterations = case.result[2] if case.result else ""
            table.writerow([scene, case.series, case.name, status, "" if error is None else repr(error),
                            "%.4f" % statistics.median(case.times), len(case.times), "%.0f" % max(case.memory), unknowns,
                            iterations])


def draw(tools, path, picture):
    subprocess.run([tools["stickslip"], "chart", "--from", path, "--svg", picture, "--force", "--quiet"], check=True)


def ratios_a(cases):
    ours = [(c.result[0], statistics.median(c.times)) for c in cases if c.series.startswith("stickslip") and c.result]
    print("| scene A | run | error | s | stickslip at no more error, s | ratio |\n|---|---|---|---|---|---|")
    for case in cases:
        if case.series.startswith("stickslip"):
            continue
        time = statistics.median(case.times)
        if not case.result:
            print("| %s | %s | %s | %.2f | | |" % (case.series, case.name, case.status, time))
            continue
        near = [t for error, t in ours if error <= case.result[0]]
        best = "%.3f | %.0f" % (min(near), time / min(near)) if near else "none so near |"
        print("| %s | %s | %.1e | %.2f | %s |" % (case.series, case.name, case.result[0], time, best))


def ratios_d(cases, sizes):
    print("\n| scene D, unknowns | program | tangential, normal force | iterations | MB | s | ratio | to old factors |")
    print("|---|---|---|---|---|---|---|---|")
    for n in sizes:
        own = [c for c in cases if c.name == "n=%d" % n]
        mine = [statistics.median(case.times) for case in own[:2]]
        for case in own:
            time = statistics.median(case.times)
            told = case.status + " |"
            if case.result:
                force, increments, iterations = case.result
                told = "%.4f, %.4f | %d" % (*force, iterations) + (" in %d increments" % increments if increments else "")
            ratio = " | ".join("%.1f" % (time / t) for t in mine) if case not in own[:2] else " | "
            print("| %d | %s | %s | %.0f | %.2f | %s |" % (unknowns_d(n), case.series, told, max(case.memory), time, ratio))


def machine():
    try:
        with open("/proc/cpuinfo") as f:
            names = [line.split(":", 1)[1].strip() for line in f if line.startswith("model name")]
    except OSError:
        names = []
    return "%s, %d cores, %s" % (names[0] if names else platform.machine(), os.cpu_count(), platform.system())


def tools(arguments):
    """The programs that there are; None for a peer that is not installed."""
    def works(command):
        try:
            return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
        except OSError:
            return None
    ccx = shutil.which(os.environ.get("CCX", "ccx"))
    # The system's own interpreter has what apt installs, whatever python3 stands first.
    pythons = [os.environ.get("GETFEM_PYTHON"), "python3", "/usr/bin/python3"]
    getfem = next((p for p in pythons if p and works([p, "-c", "import getfem"]) == 0), None)
    for name, found in (("CalculiX (ccx)", ccx), ("GetFEM (python3-getfem)", getfem)):
        print("%s: %s" % (name, found or "not installed, skipped"), file=sys.stderr)
    if works([arguments.stickslip, "--version"]) != 0:
        sys.exit("%s: no stickslip there; cargo build --release makes one" % arguments.stickslip)
    return {"stickslip": os.path.abspath(arguments.stickslip), "ccx": ccx, "getfem": getfem}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stickslip", default=os.path.join(ROOT, "target", "release", "stickslip"))
    parser.add_argument("--out", default=os.path.join(ROOT, "target", "peers"))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--scenes", default="a,d")
    parser.add_argument("--sizes", default="8,23,52,72", help="elements along the lower block's height, of scene D")
    parser.add_argument("--timeout", type=float, default=900, help="seconds for one run")
    arguments = parser.parse_args()
    found = tools(arguments)
    sizes = [int(n) for n in arguments.sizes.split(",")]
    os.makedirs(arguments.out, exist_ok=True)
    by = subprocess.run([found["stickslip"], "--version"], capture_output=True, text=True).stdout.strip()
    made = "%s on %s; time: processor time of the whole process, median" % (by, machine())
    for scene in arguments.scenes.split(","):
        cases = scene_a(found) if scene == "a" else scene_d(found, sizes)
        measure(cases, arguments.out, arguments.repeats, arguments.timeout)
        table = os.path.join(arguments.out, scene + ".csv")
        if scene == "a":
            about = ["Scene: problem 04 in three codes", "Error: distance of the tip at P = 3.5 to the elastica's"]
            errors = [case.result and case.result[0] for case in cases]
            ratios_a(cases)
        else:
            finest = [c for c in cases if c.series == "stickslip" and c.result]
            if not finest:
                sys.exit("scene D: stickslip failed on all sizes: %s" % cases[0].status)
            x, y = finest[-1].result[0]
            about = ["Scene: two Q8 blocks, pressed and sheared, in three codes",
                     "Error: of the end force on the interface against stickslip, %s" % finest[-1].name]
            errors = [math.hypot(c.result[0][0] - x, c.result[0][1] - y) / math.hypot(x, y)
                      if c.result and c is not finest[-1] else None for c in cases]
            ratios_d(cases, sizes)
        write(table, about[0].removeprefix("Scene: "), about + [made], cases, errors)
        draw(found, table, os.path.join(arguments.out, scene + ".svg"))
        print("\n%s, %s" % (table, scene + ".svg"), file=sys.stderr)


if __name__ == "__main__":
    main()
