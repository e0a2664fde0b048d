#!/usr/bin/env python3
"""Makes the runs of CalculiX that the tests and the manual look at: pinned-beam and two-blocks, each a deck, its .cel, .sta and
.cvg. Usage: tests/peers/past.py FOLDER (tests/calculix holds those of ccx 2.20; ccx has to be installed).

pinned-beam: the first problem (problems/01-pinned-beam-rough-floor.ron) in increments of a tenth of each leg of its path, a
beam of B32R elements. ccx goes round in two iterations where the load turns, and gives up.

two-blocks: one block of CPE8 elements pressed on another and pushed along it, the meshes not matching, with a contact
stiffness far above that of the blocks. Contacts open and close in turn, and increments are cut."""
import math, os, subprocess, sys


def pinned_beam():
    length, elements = 4.0, 4
    foot = length / math.sqrt(2)
    lines = ["*NODE, NSET=NALL"]
    for k in range(2 * elements + 1):
        part = k / (2 * elements)
        lines.append(f"{k + 1}, {foot * part:.12g}, {foot * (1 - part):.12g}, 0.")
    end = 2 * elements + 1
    # The floor: one brick below y = 0, held.
    floor = [(x, y, z) for y in (-0.5, 0.0) for x, z in ((-4, -2), (8, -2), (8, 2), (-4, 2))]
    lines += [f"{1001 + k}, {x:g}, {y:g}, {z:g}" for k, (x, y, z) in enumerate(floor)]
    lines.append("*ELEMENT, TYPE=B32R, ELSET=BEAM")
    lines += [f"{k + 1}, {2 * k + 1}, {2 * k + 2}, {2 * k + 3}" for k in range(elements)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=FLOOR", "1000, 1001, 1004, 1003, 1002, 1005, 1008, 1007, 1006"]
    lines += ["*NSET, NSET=NFLOOR, GENERATE", "1001, 1008", "*NSET, NSET=TIP", f"{end}"]
    # EA = 100 and EI = 100/12: a square of side 1.
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", "100., 0."]
    lines += ["*BEAM SECTION, ELSET=BEAM, MATERIAL=M, SECTION=RECT", "1., 1.", "0., 0., 1."]
    lines += ["*SOLID SECTION, ELSET=FLOOR, MATERIAL=M"]
    lines += ["*BOUNDARY", "NFLOOR, 1, 3", "1, 1, 5"] + [f"{k}, 3, 5" for k in range(2, end + 1)]
    lines += contact("TIP", "FLOOR, S2", (1e6, 1e-6), 1e5, math.tan(math.pi / 6))
    for load in (0.25, 0.0):
        lines += step("0.1, 1., 1e-6, 0.1", [f"*CLOAD\n{end}, 1, {-load}"])
    return lines


def two_blocks():
    lines, count = ["*NODE, NSET=NALL"], 0
    elements, rows = {}, {}

    def block(name, corner, size, nx, ny):
        nonlocal count
        nodes = {}
        for j in range(2 * ny + 1):
            for i in range(2 * nx + 1):
                if i % 2 == 0 or j % 2 == 0:
                    count += 1
                    nodes[i, j] = count
                    x, y = corner[0] + size[0] * i / (2 * nx), corner[1] + size[1] * j / (2 * ny)
                    lines.append(f"{count}, {x:.10g}, {y:.10g}, 0.")
        around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        elements[name] = [[nodes[2 * i + a, 2 * j + b] for a, b in around] for j in range(ny) for i in range(nx)]
        rows[name] = [[nodes[i, j] for i in range(2 * nx + 1)] for j in (0, 2 * ny)]

    block("LOW", (0.0, 0.0), (2.0, 1.0), 4, 2)
    block("HIGH", (0.5, 1.0), (1.0, 0.5), 3, 1)
    number = 0
    for name in ("LOW", "HIGH"):
        lines.append(f"*ELEMENT, TYPE=CPE8, ELSET={name}")
        for nodes in elements[name]:
            number += 1
            lines.append(", ".join(map(str, [number] + nodes)))
    # The elements along the top of the lower block.
    lines += ["*ELSET, ELSET=ROW, GENERATE", "5, 8"]
    for name, nodes in (("BASE", rows["LOW"][0]), ("SOLE", rows["HIGH"][0]), ("TOP", rows["HIGH"][1])):
        lines += [f"*NSET, NSET={name}"] + [f"{node}," for node in nodes]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3"]
    for name in ("LOW", "HIGH"):
        lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL=M", "1."]
    lines += ["*BOUNDARY", "BASE, 1, 2"]
    lines += contact("SOLE", "ROW, S3", (1e7, 1e-3), 1e6, 0.3)
    lines += step("0.5, 1., 1e-4, 0.5", ["*BOUNDARY\nTOP, 1, 1, 0.\nTOP, 2, 2, -0.01"])
    lines += step("0.25, 1., 1e-2, 0.25", ["*BOUNDARY\nTOP, 1, 1, 0.02\nTOP, 2, 2, -0.01"])
    return lines


def contact(slave, master, normal, stick, friction):
    # Stiffness, and the tension that is left far above the surface.
    stiffness, tension = normal
    return [
        "*SURFACE, NAME=SLAVE, TYPE=NODE", f"{slave},",
        "*SURFACE, NAME=MASTER", master,
        "*SURFACE INTERACTION, NAME=RUB",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:g}, {tension:g}",
        "*FRICTION", f"{friction:.10g}, {stick:g}",
        "*CONTACT PAIR, INTERACTION=RUB, TYPE=NODE TO SURFACE", "SLAVE, MASTER",
    ]


def step(increments, loads):
    # The keyword that has the contact elements of every iteration written.
    return ["*STEP, NLGEOM, INC=400", "*STATIC", increments, *loads, "*CONTACT FILE, CONTACT ELEMENTS", "CDIS", "*END STEP"]


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    for name, deck in (("pinned-beam", pinned_beam()), ("two-blocks", two_blocks())):
        with open(os.path.join(folder, name + ".inp"), "w") as file:
            file.write("\n".join(deck) + "\n")
        # A run that gives up has another exit code, and that is what it is for.
        environment = dict(os.environ, OMP_NUM_THREADS="1")
        subprocess.run(["ccx", "-i", name], cwd=folder, env=environment, stdout=subprocess.DEVNULL, timeout=300)
        for file in (f"{name}.frd", f"{name}.dat", f"{name}.12d", "spooles.out"):
            file = os.path.join(folder, file)
            if os.path.exists(file):
                os.remove(file)
        print(name, *(f"{end} {os.path.getsize(os.path.join(folder, f'{name}.{end}'))} bytes" for end in ("cel", "sta", "cvg")))


if __name__ == "__main__":
    main()
