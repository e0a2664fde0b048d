#!/usr/bin/env python3
"""Files for ParaView, read by others: meshio and, where it is installed, PyVista (VTK itself).

    pip install meshio pyvista
    cargo build && tests/peers/vtu.py [SCENE ...] [--stickslip target/debug/stickslip] [--picture FILE.png] [--keep DIR]

For each scene `run --vtu --csv --trace` is run. Of every file: the time of the collection is the load of the table; where the scene
monitors a displacement as u_x and u_y, a node has these, to the last digit; F_n, F_t, T_max, gap, slip and modes of the slave nodes
are those of the trace, to the last digit; contact_force is as long as F_n and F_t together; and both readers agree on every array.
PyVista draws the last state of the first scene where --picture asks for it: the stress YY on the deformed shape, with the forces on
the slave nodes. It ends with code 1 if anything differs.
"""
import argparse
import csv
import importlib.util
import io
import math
import os
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

import meshio
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENES = ["hertz-cylinder-on-block", "osc-block-slide", "02-two-cantilevers-rough", "05-cantilever-elastic-block"]
MODES = ["free", "sliding", "fixed"]


def run(program, scene, folder):
    table = os.path.join(folder, "table.csv")
    os.makedirs(folder, exist_ok=True)
    command = [program, "run", scene, "--vtu", folder, "--trace", "-", "--csv", table, "--force"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{' '.join(command)}: {done.stderr}")
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    last = {}
    for row in rows:
        last.setdefault((int(row["increment"]), row["node"]), row)
        last[int(row["increment"]), row["node"]] = row
    with open(table, encoding="utf-8") as file:
        return last, {int(row["increment"]): row for row in csv.DictReader(file)}


def collected(folder):
    (name,) = [name for name in os.listdir(folder) if name.endswith(".pvd")]
    root = xml.etree.ElementTree.parse(os.path.join(folder, name)).getroot()
    return [(float(one.get("timestep")), os.path.join(folder, one.get("file"))) for one in root.iter("DataSet")]


def names(mesh, which):
    return bytes(np.asarray(mesh.field_data[which], dtype=np.uint8).ravel()).decode().splitlines()


def number(mesh, which):
    return np.asarray(mesh.field_data[which]).ravel()[0]


def compared(mesh, last):
    """Slave nodes of a file against the trace: their count, or what differs."""
    nodes, increment = names(mesh, "node_names"), int(number(mesh, "increment"))
    data = mesh.point_data
    assert len(nodes) == len(mesh.points) and list(data["node"]) == list(range(1, len(nodes) + 1))
    seen = 0
    for place, node in enumerate(nodes):
        mode = data["contact_mode"][place] if "contact_mode" in data else -1
        row = last.get((increment, node))
        if increment == 0 or mode < 0:
            continue
        if row is None or row["mode"] != MODES[mode]:
            raise SystemExit(f"node {node}: mode {mode} and the trace's {row}")
        pairs = [(key, row[key.lower()]) for key in ("F_n", "F_t", "T_max", "gap", "slip") if key.lower() in row]
        assert len(pairs) >= 4, row.keys()
        for key, told in pairs:
            if float(told) != data[key][place]:
                raise SystemExit(f"node {node}: {key} is {data[key][place]!r}, and {told} in the trace")
        length = math.hypot(data["F_n"][place], data["F_t"][place])
        assert math.isclose(np.linalg.norm(data["contact_force"][place]), length, rel_tol=1e-12, abs_tol=1e-300)
        seen += 1
    return seen


def monitored(mesh, when, table):
    """Whether a file has the load of the table, and a node that moves as its monitors say."""
    row = table.get(int(number(mesh, "increment")))
    if row is None:
        return 0
    assert float(row["load"]) == number(mesh, "TimeValue") == when
    if not {"u_x", "u_y"} <= row.keys():
        return 0
    told = [float(row["u_x"]), float(row["u_y"]), 0.0]
    if not (mesh.point_data["displacement"] == told).all(axis=1).any():
        raise SystemExit(f"no node moves by {told}")
    return 1


def agree(file, mesh):
    """Whether VTK finds the same in a file."""
    import pyvista

    grid = pyvista.read(file)
    assert np.array_equal(grid.points, mesh.points.astype(grid.points.dtype))
    assert grid.n_cells == sum(len(block.data) for block in mesh.cells)
    for key, values in mesh.point_data.items():
        theirs = np.asarray(grid.point_data[key])
        assert np.array_equal(theirs.reshape(values.shape), values, equal_nan=True), key
    return grid


def draw(grid, picture):
    import pyvista

    shown = pyvista.Plotter(off_screen=True, window_size=(900, 600))
    warped = grid.warp_by_vector("displacement")
    stress = "stress" in grid.point_data
    if stress:
        warped["stress YY"] = grid.point_data["stress"][:, 1]
    body = warped.extract_cells(np.flatnonzero(warped.cell_data["body"] > 0))
    shown.add_mesh(body, scalars="stress YY" if stress else None, nan_color="white", line_width=2)
    rigid = warped.extract_cells(np.flatnonzero(warped.cell_data["rigid"] > 0))
    if rigid.n_cells:
        shown.add_mesh(rigid, color="black", line_width=4)
    if "contact_force" in grid.point_data:
        slaves = warped.extract_points(warped.point_data["contact_mode"] >= 0, include_cells=False)
        force = np.linalg.norm(slaves["contact_force"], axis=1).max()
        if force > 0:
            shown.add_mesh(slaves.glyph(orient="contact_force", scale="contact_force", factor=0.15 * body.length / force), color="red")
    shown.view_xy()
    shown.camera.zoom(1.6)
    shown.screenshot(picture)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("scenes", nargs="*", default=SCENES)
    options.add_argument("--stickslip", default=os.path.join(ROOT, "target", "debug", "stickslip"))
    options.add_argument("--picture")
    options.add_argument("--keep")
    args = options.parse_args()
    vtk = importlib.util.find_spec("pyvista") is not None
    print("read by meshio", meshio.__version__, "and PyVista" if vtk else "alone: PyVista is not installed")
    for place, scene in enumerate(args.scenes):
        with tempfile.TemporaryDirectory() as folder:
            folder = os.path.join(args.keep, os.path.basename(scene)) if args.keep else folder
            began = time.time()
            last, table = run(args.stickslip, scene, folder)
            took = time.time() - began
            files = collected(folder)
            assert [when for when, _ in files] == sorted(when for when, _ in files)
            slaves, moved, grid = 0, 0, None
            for when, file in files:
                mesh = meshio.read(file)
                moved += monitored(mesh, when, table)
                slaves += compared(mesh, last)
                grid = agree(file, mesh) if vtk else None
            kinds = ", ".join(sorted({block.type for block in mesh.cells}))
            print(
                f"{os.path.basename(scene)}: {len(files)} files in {took:.1f} s, {len(mesh.points)} points, cells: {kinds}; "
                f"arrays: {', '.join(mesh.point_data)}; {slaves} slave nodes as in the trace, {moved} displacements as in the table"
            )
            if args.picture and vtk and place == 0:
                draw(grid, args.picture)
                print("drawn:", args.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
