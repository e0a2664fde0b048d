#!/usr/bin/env python3
"""A stiffness that CalculiX stores, condensed and solved by stickslip.

    apt-get install -y calculix-ccx
    cargo build && tests/peers/stored.py [--stickslip target/debug/stickslip] [--ccx ccx]

A block of 2 x 1, in plane strain, 4 x 2 elements of 8 nodes, E = 1000, nu = 0.3, stands on a rigid floor with friction 0.3; its top
goes down by 0.01 and aside by 0.004. ccx writes its stiffness (*FREQUENCY, SOLVER=MATRIXSTORAGE), a file `Stored(` names the nodes
that may touch and those that are moved, and stickslip does the rest. The same stiffness condensed by numpy and solved by Siconos
(Lemke, NSGS and CPG alike) gives the sums of forces 24.4305501 and 2.60120024; ccx's own penalty contact 24.42987 and 2.59585.
It ends with code 1 where a sum is off by more than its last digit, or a mode is another.
"""
import argparse
import csv
import io
import math
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ACROSS, UP, WIDTH, HEIGHT = 4, 2, 2.0, 1.0
NORMAL, TANGENT, MODES = 24.4305501, 2.60120024, "SXXXXXXSS"


def deck():
    """The deck, and the nodes of the bottom and of the top from left to right."""
    numbers, lines = {}, ["*NODE"]
    for j in range(2 * UP + 1):
        for i in range(2 * ACROSS + 1):
            if i % 2 and j % 2:
                continue
            numbers[i, j] = len(numbers) + 1
            lines.append(f"{numbers[i, j]},{i * WIDTH / (2 * ACROSS)!r},{j * HEIGHT / (2 * UP)!r},0.")
    lines.append("*ELEMENT,TYPE=CPE8,ELSET=BLOCK")
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    places = [(2 * i, 2 * j) for j in range(UP) for i in range(ACROSS)]
    for k, (i, j) in enumerate(places):
        nodes = [numbers[i + a, j + b] for a, b in around]
        lines.append(",".join(map(str, [k + 1, *nodes])))
    lines += ["*MATERIAL,NAME=M", "*ELASTIC", "1000.,0.3", "*DENSITY", "1.", "*SOLID SECTION,ELSET=BLOCK,MATERIAL=M", "1."]
    lines += ["*STEP", "*FREQUENCY,SOLVER=MATRIXSTORAGE", "*END STEP", ""]
    row = lambda j: [numbers[i, j] for i in range(2 * ACROSS + 1)]  # noqa: E731
    return "\n".join(lines), row(0), row(2 * UP)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--stickslip", default=os.path.join(ROOT, "target", "debug", "stickslip"))
    options.add_argument("--ccx", default="ccx")
    args = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        text, bottom, top = deck()
        with open(os.path.join(folder, "block.inp"), "w", encoding="utf-8") as file:
            file.write(text)
        subprocess.run([args.ccx, "block"], cwd=folder, check=True, capture_output=True)
        scene = f"""Stored(
    title: "A block pressed on a floor and sheared",
    stiffness: "block.sti",
    contacts: [(nodes: {bottom}, friction: (angle: {math.degrees(math.atan(0.3))!r}))],
    moved: [(nodes: {top}, x: Some(0.004), y: Some(-0.01))],
)
"""
        with open(os.path.join(folder, "block.ron"), "w", encoding="utf-8") as file:
            file.write(scene)
        print(scene, end="")
        command = [args.stickslip, "run", "block.ron", "-q", "--trace", "-"]
        done = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    rows = list(csv.DictReader(io.StringIO(done.stdout)))[-len(bottom) :]
    modes = "".join({"free": "F", "sliding": "S", "fixed": "X"}[row["mode"]] for row in rows)
    normal, tangent = (sum(float(row[key]) for row in rows) for key in ("f_n", "f_t"))
    print(f"sum of F_n {normal:.7f}, of F_t {tangent:.8f}, modes {' '.join(modes)}")
    right = abs(normal - NORMAL) < 1e-7 and abs(tangent - TANGENT) < 1e-8 and modes == MODES
    return int(not right)


if __name__ == "__main__":
    sys.exit(main())
