#!/usr/bin/env python3
"""What stickslip does with the contact decks of CalculiX' own tests (Debian: calculix-ccx-test): read and solved in the plane, read
by the rules for 3-D decks, or refused and why; with the largest difference of the solved ones from ccx if that is installed.
Usage: tests/peers/ccx_test.py STICKSLIP FOLDER (the folder of the decks: /usr/share/doc/calculix-ccx-test/examples/test)"""
import collections, gzip, os, re, shutil, subprocess, sys, tempfile
import decks

program, packed = sys.argv[1:3]
folder = tempfile.mkdtemp()
for name in os.listdir(packed):
    opened = gzip.open if name.endswith(".gz") else open
    with opened(os.path.join(packed, name), "rb") as source, open(os.path.join(folder, name.removesuffix(".gz")), "wb") as copy:
        shutil.copyfileobj(source, copy)
counts = collections.Counter()
for name in sorted(os.listdir(folder)):
    if not name.endswith(".inp"):
        continue
    path = os.path.join(folder, name)
    with open(path, encoding="latin-1") as file:
        cards = re.findall(r"^\*(contact *pair|tie)\b", file.read(), re.IGNORECASE | re.MULTILINE)
    if not cards:
        continue
    checked = subprocess.run([program, "check", path], capture_output=True, text=True)
    causes = checked.stderr.count("warning: ")
    if checked.returncode:
        reason = checked.stderr.strip().splitlines()[-1].replace(path, name)
        outcome, shown = "refused", reason[:150]
    elif "three-dimensional deck" in checked.stdout:
        outcome, shown = "read by the rules for 3-D decks", f"{causes} findings"
    else:
        solved = subprocess.run([program, "run", path, "--quiet"], capture_output=True, timeout=300).returncode == 0
        outcome, shown = ("solved" if solved else "read, not solved"), f"{causes} findings"
        if solved and shutil.which("ccx"):
            _, _, here, _ = decks.ours(os.path.abspath(program), name, folder, [])
            why, there, _ = decks.theirs("ccx", name, folder)
            shown += f"; against ccx: {why or decks.differ(here, there)}"
    counts[outcome] += 1
    print(f"{name}: {outcome}: {shown}", flush=True)
print(", ".join(f"{count} {outcome}" for outcome, count in counts.most_common()))
