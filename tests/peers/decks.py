#!/usr/bin/env python3
"""Decks of CalculiX, read here and run by CalculiX, beside what their authors keep as the right answer.

    cargo build --release && tests/peers/decks.py [--program FILE] [--all] [--set PATH=VALUE] [DECK or FOLDER ...]

Without names: the decks of Debian's calculix-ccx-test (`apt-get install calculix-ccx calculix-ccx-test`). Of a folder all decks
are taken that have plane or axisymmetric elements (CPS, CPE, CAX) and contact (*CONTACT PAIR, *TIE, *GAP); how many there are
beside these is said, and --all takes them too. A deck named by its file is always taken.

For each deck it prints either why stickslip does not read it, with the line, or

- the displacements that the deck prints (*NODE PRINT, U): the largest difference between stickslip and ccx's own run, and
  between stickslip and the deck's .dat.ref where there is one, over the largest displacement;
- the contact force of all pairs together where the deck prints it (*CONTACT PRINT), here and in ccx.

--nodes prints each of these displacements. Where ccx is not installed or fails, or has nothing to compare, that is printed.
Exit code: 0 if every deck was read or refused, 1 if a deck that was read did not run to its end, or a program was not found.
"""
import argparse
import csv
import gzip
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SUITE = "/usr/share/doc/calculix-ccx-test/examples/test"
PLANE = re.compile(r"^\*ELEMENT\b.*TYPE\s*=\s*C(PS|PE|AX)", re.I | re.M)
CONTACT = re.compile(r"^\*(CONTACT\s*PAIR|TIE|GAP)\b", re.I | re.M)
# Seconds that a program may take for a deck.
PATIENCE = 300


def text(path):
    """The text of a file, unpacked if it ends with .gz."""
    opened = gzip.open(path, "rb") if path.endswith(".gz") else open(path, "rb")
    with opened as f:
        return f.read().decode("utf-8", "replace")


def decks(folder, everything):
    """Decks of a folder, and how many it has beside them."""
    names = sorted(n for n in os.listdir(folder) if re.search(r"\.inp(\.gz)?$", n))
    taken, left = [], 0
    for name in names:
        path = os.path.join(folder, name)
        whole = text(path)
        if everything or (PLANE.search(whole) and CONTACT.search(whole)):
            taken.append(path)
        else:
            left += 1
    return taken, left


def displacements(dat):
    """Displacements of the last block of a .dat file that has some, by node."""
    found = {}
    for block in re.split(r"(?m)^ (?=[a-z])", dat):
        if block.startswith("displacements"):
            rows = (line.split() for line in block.splitlines()[1:])
            found = {int(r[0]): (float(r[1]), float(r[2])) for r in rows if len(r) == 4}
    return found


def contact_force(dat):
    """The total force on the slaves of all pairs in the last increment of a .dat file; None where none is printed."""
    blocks = re.findall(
        r"statistics for slave set (.*?) and time\s+(\S+)\s+total surface force.*?\n\s*\n\s*(\S+)\s+(\S+)", dat, re.S
    )
    first = {}
    for pair, time, x, y in blocks:
        # The first block of a pair and a time is the whole force; others are its normal and tangential part.
        first.setdefault((time, pair), (float(x), float(y)))
    if not first:
        return None
    last = list(first)[-1][0]
    forces = [force for (time, _), force in first.items() if time == last]
    return tuple(sum(part) for part in zip(*forces))


def run(command, folder, env=None):
    """Exit code, standard output and error of a program."""
    done = subprocess.run(command, cwd=folder, env=env, timeout=PATIENCE, capture_output=True, text=True, errors="replace")
    return done.returncode, done.stdout, done.stderr


def ours(program, job, folder, sets):
    """Displacements and contact force by stickslip: (refusal, failure, displacements, force)."""
    code, _, err = run([program, "check", job] + sets, folder)
    if code == 2:
        return err.strip().splitlines()[-1], None, {}, None
    code, out, err = run([program, "run", job, "-q", "--csv", "-"] + sets, folder)
    rows = list(csv.DictReader(line for line in io.StringIO(out) if not line.startswith("#")))
    if code != 0 or not rows:
        return None, f"exit code {code}: {err.strip().splitlines()[-1] if err.strip() else 'no increment'}", {}, None
    last = rows[-1]
    found = {}
    for name, value in last.items():
        match = re.fullmatch(r"u_([xy]) (\d+)", name)
        if match:
            at = found.setdefault(int(match[2]), [0.0, 0.0])
            at["xy".index(match[1])] = float(value)
    force = None
    if "contact x" in last:
        force = (float(last["contact x"]), float(last["contact y"]))
    return None, None, {node: tuple(u) for node, u in found.items()}, force


def theirs(ccx, job, folder):
    """Displacements and contact force by ccx, or why there are none."""
    env = dict(os.environ, OMP_NUM_THREADS="1")
    try:
        code, out, _ = run([ccx, job.removesuffix(".inp")], folder, env)
    except subprocess.TimeoutExpired:
        return f"took more than {PATIENCE} s", {}, None
    path = os.path.join(folder, job.removesuffix(".inp") + ".dat")
    if code != 0 or "*ERROR" in out or not os.path.exists(path):
        lines = [line.strip() for line in out.splitlines() if "*ERROR" in line]
        return f"failed: {lines[0] if lines else f'exit code {code}'}", {}, None
    dat = text(path)
    return None, displacements(dat), contact_force(dat)


def differ(here, there):
    """The largest difference of displacements over the largest displacement, or why there is none."""
    common = here.keys() & there.keys()
    if not common:
        return "nothing printed by both"
    size = max(abs(u) for node in common for u in there[node])
    apart = max(abs(a - b) for node in common for a, b in zip(here[node], there[node]))
    return f"{apart / size:.1e} of {size:.6e} ({len(common)} nodes)" if size else f"{apart:.1e} absolute"


def deck(path, arguments, ccx):
    """Runs one deck and prints what comes of it; whether it went well."""
    job = os.path.basename(path).removesuffix(".gz")
    print(f"{job}")
    sets = [part for s in arguments.set for part in ("--set", s)]
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, job), "w") as f:
            f.write(text(path))
        for beside in includes(text(path)):
            place = os.path.join(os.path.dirname(path), beside)
            if os.path.exists(place):
                os.makedirs(os.path.dirname(os.path.join(folder, beside)), exist_ok=True)
                shutil.copy(place, os.path.join(folder, beside))
        refusal, failure, here, force = ours(arguments.program, job, folder, sets)
        if refusal:
            print(f"  refused: {refusal}")
            return True
        if failure:
            print(f"  failed here: {failure}")
        why, there, their_force = theirs(ccx, job, folder) if ccx else ("not installed", {}, None)
    print(f"  against ccx:      {why or differ(here, there)}")
    reference = next((p for p in references(path) if os.path.exists(p)), None)
    known = displacements(text(reference)) if reference else {}
    print(f"  against .dat.ref: {differ(here, known) if reference else 'there is none'}")
    if force and their_force:
        print("  contact force:    ({:.6g}, {:.6g}) here, ({:.6g}, {:.6g}) in ccx".format(*force, *their_force))
    if arguments.nodes:
        for node in sorted(here):
            row = [here[node]] + [u[node] for u in (there, known) if node in u]
            print(f"  {node:8} " + "   ".join(f"{x:14.6e} {y:14.6e}" for x, y in row))
    return failure is None


def includes(whole):
    return [name.strip().strip('"') for name in re.findall(r"(?im)^\*INCLUDE\s*,\s*INPUT\s*=\s*(.+)$", whole)]


def references(path):
    base = path.removesuffix(".gz").removesuffix(".inp")
    return [base + ".dat.ref", base + ".dat.ref.gz"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("decks", nargs="*", default=[SUITE])
    parser.add_argument("--program", default=os.path.join(ROOT, "target", "release", "stickslip"))
    parser.add_argument("--all", action="store_true", help="all decks of a folder, those of space too")
    parser.add_argument("--nodes", action="store_true", help="each displacement: here, in ccx, in the reference")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="as stickslip takes it")
    arguments = parser.parse_args()
    arguments.program = os.path.abspath(arguments.program)
    if not os.path.exists(arguments.program):
        sys.exit(f"{arguments.program} is not there; cargo build --release makes it, --program names another")
    ccx = shutil.which(os.environ.get("CCX", "ccx"))
    if not ccx:
        print("ccx is not installed (apt-get install calculix-ccx; $CCX names another one)")
    good = True
    for name in arguments.decks:
        if not os.path.exists(name):
            print(f"{name} is not there (apt-get install calculix-ccx-test brings {SUITE})")
            good = False
            continue
        taken, left = decks(name, arguments.all) if os.path.isdir(name) else ([name], 0)
        for path in taken:
            try:
                good &= deck(path, arguments, ccx)
            except subprocess.TimeoutExpired:
                print(f"  took more than {PATIENCE} s here")
                good = False
        if left:
            print(f"{name}: {left} more decks have no plane elements or no contact (--all)")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
