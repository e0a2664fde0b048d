#!/usr/bin/env python3
"""Makes the decks of tests/calculix/causes, each of which fails in CalculiX for one cause, and the same decks with the cure that
stickslip advises. Runs both in ccx, and stores the deck, the .cel, .cvg and .sta of the failure, and all outcomes in causes.csv.
Usage: tests/peers/causes.py FOLDER (tests/calculix/causes holds the results of ccx 2.20; `.ci/decks` calls this).

A block of 2 x 2 x 1 elements (SLIDER) lies on one of 3 x 3 x 2 (BASE): mm, N, E = 210000. The meshes do not match."""
import csv, os, subprocess, sys

PRESS = "*BOUNDARY\nTOP, 1, 2, 0.\nTOP, 3, 3, -0.01"
LOAD = "*CLOAD\nTOP, 3, -50."
HOLD = "*BOUNDARY\nTOP, 1, 2, 0."
TIME = "0.25, 1., 0.02, 0.5"
SLOW = "0.1, 1., 0.02, 0.1"
TIE = "*TIE, NAME=GLUE, POSITION TOLERANCE={}\nSSLIDER, SBASE"


class Deck:
    """The lines of a deck; `bodies` are names with corner, size and elements along x, y and z, and perhaps the kind of element.
    Those in `turned` are turned by 45 degrees about their lower edge along y."""

    def __init__(self, bodies, turned=()):
        self.lines, self.nodes, self.elements = ["*NODE"], {}, {}
        count = 0
        for name, corner, size, n, *_ in bodies:
            grid = self.nodes[name] = {}
            for k in range(n[2] + 1):
                for j in range(n[1] + 1):
                    for i in range(n[0] + 1):
                        count += 1
                        grid[i, j, k] = count
                        x, y, z = (size[a] * v / n[a] for a, v in enumerate((i, j, k)))
                        if name in turned:
                            x, z = (x - z) / 2**0.5, (x + z) / 2**0.5
                        at = (corner[a] + v for a, v in enumerate((x, y, z)))
                        self.lines.append(f"{count}, " + ", ".join(f"{x:.10g}" for x in at))
        count = 0
        for name, _, _, n, *kind in bodies:
            self.lines.append(f"*ELEMENT, TYPE={(kind or ['C3D8'])[0]}, ELSET={name}")
            own, grid = self.elements.setdefault(name, {}), self.nodes[name]
            for k in range(n[2]):
                for j in range(n[1]):
                    for i in range(n[0]):
                        count += 1
                        own[i, j, k] = count
                        around = [(a, b, c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                        nodes = [grid[i + a, j + b, k + c] for a, b, c in around]
                        self.lines.append(", ".join(map(str, [count] + nodes)))

    def set(self, name, body, row, axis=2):
        nodes = [node for at, node in self.nodes[body].items() if at[axis] == row]
        self.lines += [f"*NSET, NSET={name}"]
        self.lines += [", ".join(map(str, nodes[k : k + 9])) + "," for k in range(0, len(nodes), 9)]

    def surface(self, name, body, row, face, axis=2):
        elements = [element for at, element in self.elements[body].items() if at[axis] == row]
        self.lines += [f"*SURFACE, NAME={name}"] + [f"{element}, {face}" for element in elements]


def deck(steps, gap=0.0, x=1.03, K="1e7", friction="0.3, 1e5", face="S2", pair="SSLIDER, SBASE", adjust="", extra=(), base=(3, 3, 2),
         top=(2, 2, 1), third=False, inc=60, foot=False, without=False, aside=False):
    bodies = [("BASE", (0, 0, 0), (4, 4, 2), base), ("SLIDER", (x, 0.97, 2 + gap), (1.9, 1.9, 1.4), top)]
    made = Deck(bodies + [("LOOSE", (6, 0, 0), (1, 1, 1), (1, 1, 1))] * third)
    made.set("FIX", "BASE", 0)
    made.set("TOP", "SLIDER", top[2])
    made.surface("SBASE", "BASE", base[2] - 1, face)
    if foot:
        made.set("FOOT", "SLIDER", 0)
    if third:
        made.set("NLOOSE", "LOOSE", 1)
    if not without:
        made.surface("SSLIDER", "SLIDER", 0, "S6" if aside else "S1", 0 if aside else 2)
    made.lines += extra
    return finished(made, steps, [pair], K, friction, adjust, inc)


def finished(made, steps, pairs, K="1e7", friction="0.3, 1e5", adjust="", inc=60):
    """The lines of a deck with material, contact and steps."""
    made.lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3"]
    made.lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL" for name in made.elements]
    made.lines += ["*SURFACE INTERACTION, NAME=RUB", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", K]
    made.lines += ["*FRICTION", friction] if friction else []
    for pair in pairs:
        made.lines += [f"*CONTACT PAIR, INTERACTION=RUB, TYPE=NODE TO SURFACE{adjust}", pair]
    made.lines += ["*BOUNDARY", "FIX, 1, 3"]
    for loads, time in steps:
        made.lines += [f"*STEP, NLGEOM, INC={inc}", "*STATIC", time, *loads]
        made.lines += ["*CONTACT FILE, CONTACT ELEMENTS", "CDIS", "*END STEP"]
    return made.lines


BASE = ("BASE", (0, 0, 0), (4, 4, 2), (3, 3, 2))


def stack(steps, friction, joined=True):
    """SLIDER between BASE and a lid; or, if they are not joined, under a lid with nodes of its own at the same places."""
    slider, lid = ("SLIDER", (1.03, 0.97, 2), (1.9, 1.9, 1.4), (2, 2, 1)), ("LID", (1.2, 1.1, 3.4), (1.5, 1.6, 1), (2, 2, 1))
    made = Deck([BASE, slider, lid if joined else ("LID", (1.03, 0.97, 3.4), (1.9, 1.9, 1), (2, 2, 1))])
    made.set("FIX", "BASE", 0)
    made.set("TOP", "LID", 1)
    made.set("SIDE", "SLIDER", 0, 0)
    made.surface("SBASE", "BASE", 1, "S2")
    made.surface("SSLIDER", "SLIDER", 0, "S1")
    if joined:
        made.surface("STOP", "SLIDER", 0, "S2")
        made.surface("SLID", "LID", 0, "S1")
    return finished(made, steps, ["SSLIDER, SBASE"] + ["SLID, STOP"] * joined, friction=friction)


def roll(steps):
    """SLIDER on its edge."""
    made = Deck([BASE, ("SLIDER", (2, 0.97, 2), (1.4, 1.9, 1.4), (1, 2, 1))], ["SLIDER"])
    made.set("FIX", "BASE", 0)
    ends = [made.nodes["SLIDER"][1, j, 1] for j in range(3)]
    made.lines += ["*NSET, NSET=TOP", ", ".join(map(str, ends))]
    made.surface("SBASE", "BASE", 1, "S2")
    made.surface("SSLIDER", "SLIDER", 0, "S1")
    return finished(made, steps, ["SSLIDER, SBASE"])


def beam(load):
    """A beam of a row of reduced elements above a post."""
    made = Deck([("POST", (15, -0.5, -2.1), (2, 2, 2), (2, 2, 2)), ("BEAM", (0, 0, 0), (20, 1, 1), (20, 1, 1), "C3D8R")])
    made.set("FIX", "POST", 0)
    made.set("CLAMP", "BEAM", 0, 0)
    made.set("TIP", "BEAM", 20, 0)
    made.surface("SPOST", "POST", 1, "S2")
    made.surface("SBEAM", "BEAM", 0, "S1")
    lines = finished(made, [([load], "0.1, 1., 1e-4, 0.2")], ["SBEAM, SPOST"], "3e6", "0.2, 3e4")
    return swap(lines, "FIX, 1, 3", "FIX, 1, 3\nCLAMP, 1, 3")


def swap(lines, old, new):
    """The lines with one of them replaced, which must occur."""
    assert old in lines, old
    at = lines.index(old)
    return lines[:at] + new.split("\n") + lines[at + 1 :]


def main_cases():
    """Name, rule, deck, and the cure: the lines of the deck as stickslip gives them, and the cured deck."""
    usual = [([PRESS], TIME)]
    made = deck(usual + [(["*BOUNDARY\nTOP, 1, 1, 0.05"], TIME)], K="1e11")
    yield "stiff", "stiff contact", made, "4e6", swap(made, "1e11", "4e6")
    made = deck(usual, friction="0.3, 1e12")
    yield "stick", "stick slope", made, "0.3, 1e5", swap(made, "0.3, 1e12", "0.3, 1e5")
    made = deck([([LOAD], TIME)], gap=0.05)
    cure = "*BOUNDARY\nTOP, 1, 1, 0.\nTOP, 2, 2, 0.\nTOP, 3, 3, -0.063"
    yield "open", "held by open contact", made, cure, swap(made, LOAD, cure)
    made = deck([([HOLD + "\n" + LOAD], TIME)], x=5.0)
    cure = "*BOUNDARY\nTOP, 1, 1, 0.\nTOP, 2, 2, 0.\nTOP, 3, 3, 0."
    yield "aside", "held by open contact", made, cure, swap(made, HOLD + "\n" + LOAD, f"{cure}\n{LOAD}")
    made = deck(usual, gap=0.05)
    cure = "*CONTACT PAIR, INTERACTION=RUB, TYPE=NODE TO SURFACE, ADJUST=0.052"
    yield "clearance", "contact never closed", made, cure, swap(made, cure.replace(", ADJUST=0.052", ""), cure)
    made = deck([([LOAD + "\nTOP, 1, 5."], TIME)], friction="")
    cure = "*BOUNDARY\nTOP, 1, 1, 0.\nTOP, 2, 2, 0."
    yield "slide", "free to slide", made, cure, swap(made, LOAD + "\nTOP, 1, 5.", f"{cure}\n{LOAD}\nTOP, 1, 5.")
    made = deck([([LOAD], TIME)], gap=0.2, extra=[TIE.format("0.1")])
    yield "tie", "tie out of reach", made, "*TIE, POSITION TOLERANCE=0.21", swap(made, TIE.format("0.1"), TIE.format("0.21"))
    made = deck(usual, face="S1")
    cure = "\n".join(f"{k}, S2" for k in range(10, 19))
    yield "reversed", "reversed faces", made, cure, deck(usual)
    made = deck([([LOAD], TIME), (["*CLOAD\nTOP, 1, 15."], TIME)], friction="0.1, 1e5")
    yield "friction", "load above friction", made, "0.39, 1e5", swap(made, "0.1, 1e5", "0.39, 1e5")
    push, cure = "*CLOAD\nTOP, 1, 5.", "*BOUNDARY\nTOP, 1, 1, 0."
    made = deck([([push], TIME)])
    yield "unpressed", "load above friction", made, cure, swap(made, push, cure)
    made = deck([([LOAD], TIME)], gap=-0.05)
    cure = "*CONTACT PAIR, INTERACTION=RUB, TYPE=NODE TO SURFACE, ADJUST=0."
    yield "overlap", "overlap at the start", made, cure, swap(made, cure.replace(", ADJUST=0.", ""), cure)
    made = deck([([HOLD, LOAD], TIME), (["*BOUNDARY\nTOP, 1, 1, 0.9"], "1., 1., 0.2, 1.")])
    yield "first", "large first increment", made, "0.1, 1, 0.001, 0.1", swap(made, "1., 1., 0.2, 1.", "0.1, 1, 0.001, 0.1")
    slid = [([HOLD, LOAD], TIME), (["*BOUNDARY\nTOP, 1, 1, 1.5"], SLOW)]
    made = deck(slid, friction="", x=1.95)
    cure = "*BOUNDARY\nTOP, 1, 1, 0.23"
    yield "edge", "past the edge", made, cure, swap(made, "*BOUNDARY\nTOP, 1, 1, 1.5", cure)
    made = deck([([PRESS], "0.05, 1., 1e-3, 0.05")], inc=15)
    yield "increments", "increments used up", made, "*STEP, NLGEOM, INC=150", swap(made, "*STEP, NLGEOM, INC=15", "*STEP, NLGEOM, INC=150")
    made = deck([([LOAD + "\nNLOOSE, 3, -1."], TIME)], third=True)
    cure = "*BOUNDARY\n67, 1, 3"
    nodes = ", ".join(map(str, range(67, 71)))
    yield "loose", "unconnected body", made, cure, swap(made, "*SOLID SECTION, ELSET=LOOSE, MATERIAL=STEEL", f"*SOLID SECTION, ELSET=LOOSE, MATERIAL=STEEL\n*NSET, NSET=HELD\n{nodes}\n*BOUNDARY\nHELD, 1, 3")
    made = deck([([HOLD, LOAD], TIME), (["*BOUNDARY\nTOP, 1, 1, 0.5"], SLOW)], base=(10, 10, 1), top=(1, 1, 1))
    yield "coarse", "coarse slave", made, "SBASE, SSLIDER", swap(made, "SSLIDER, SBASE", "SBASE, SSLIDER")
    made = deck([([HOLD, LOAD], TIME), (["*BOUNDARY\nTOP, 1, 1, .3"], "1., 1., 0.9, 1.")])
    yield "cuts", "no room for cuts", made, "1, 1, 0.001, 1", swap(made, "1., 1., 0.9, 1.", "1, 1, 0.001, 1")
    made = deck([([HOLD, LOAD], TIME), (["*BOUNDARY\nTOP, 1, 1, .3"], "1., 1.")])
    at = made.index("1., 1.") - 1
    yield "direct", "no room for cuts", made[:at] + ["*STATIC, DIRECT"] + made[at + 1 :], "*STATIC\n1, 1, 0.001", swap(made, "1., 1.", "1, 1, 0.001")
    pull, cure = "*CLOAD\nTOP, 3, 20.", "*BOUNDARY\nTOP, 1, 3, 0."
    made = deck([([LOAD], TIME), ([pull], TIME)])
    yield "pull", "pulled off", made, cure, swap(made, pull, cure)
    push, cure = "*CLOAD\nTOP, 1, 40.", "*BOUNDARY\nTOP, 1, 1, 0."
    made = deck([([LOAD], TIME), ([push], TIME)], friction="0.9, 1e5")
    yield "tip", "tipping over", made, cure, swap(made, push, f"{cure}\n{push}")
    made = deck([(["*BOUNDARY\nTOP, 1, 2, 0.\nFOOT, 3, 3, -0.5", LOAD], TIME)], foot=True)
    yield "supported", "constrained slave nodes", made, "** supports no other node", swap(made, "*BOUNDARY\nTOP, 1, 2, 0.\nFOOT, 3, 3, -0.5", HOLD + "\n** supports no other node")


def more_cases():
    """The same for bodies between others, on an edge, in a row of elements, and of other materials."""
    press = (["*BOUNDARY\nTOP, 1, 2, 0.\nTOP, 3, 3, -0.01"], TIME)
    push, cure = "*CLOAD\nSIDE, 1, 10.", "*BOUNDARY\nSIDE, 1, 1, 0.\nSIDE, 2, 2, 0."
    made = stack([press, ([push], TIME)], "")
    yield "middle", "free to slide", made, cure, swap(made, push, f"{cure}\n{push}")
    push, cure = "*CLOAD\nSIDE, 1, 500.", "*BOUNDARY\nSIDE, 1, 1, 0."
    made = stack([press, ([push], TIME)], "0.1, 1e5")
    yield "between", "held by friction", made, cure, swap(made, push, cure)
    made = stack([([*press[0], "*CLOAD\nSIDE, 1, 5."], TIME)], "0.3, 1e5", joined=False)
    cure = ["*SURFACE, NAME=JOIN1", *(f"{k}, S2" for k in range(19, 23)), "*SURFACE, NAME=JOIN2", *(f"{k}, S1" for k in range(23, 27))]
    cure = "\n".join(cure + ["*TIE, NAME=JOIN", "JOIN2, JOIN1"])
    yield "unmerged", "unmerged nodes", made, cure, swap(made, "*MATERIAL, NAME=STEEL", f"{cure}\n*MATERIAL, NAME=STEEL")
    made = deck([([LOAD], TIME)], aside=True)
    cure = "\n".join(f"{k}, S1" for k in range(19, 23))
    yield "side-faces", "reversed faces", made, cure, deck([([LOAD], TIME)])
    load, cure = LOAD + "\nTOP, 1, 5.", "*BOUNDARY\nTOP, 1, 1, 0."
    made = roll([([load], TIME)])
    yield "roll", "free to move", made, cure, swap(made, load, f"{cure}\n{load}")
    made = beam("*CLOAD\nTIP, 3, -25.")
    cure = "*ELEMENT, TYPE=C3D8, ELSET=BEAM"
    yield "row", "reduced integration", made, cure, swap(made, cure.replace("C3D8", "C3D8R"), cure)
    load, cure = "*CLOAD\nTOP, 3, -250.", "*BOUNDARY\nTOP, 3, 3, -0.06"
    made = swap(deck([([HOLD, load], TIME)], top=(3, 3, 2)), "*ELEMENT, TYPE=C3D8, ELSET=SLIDER", "*ELEMENT, TYPE=C3D8R, ELSET=SLIDER")
    made = swap(made, "210000., 0.3", "210000., 0.3\n*PLASTIC\n235., 0.\n240., 0.2")
    yield "plastic", "load above the plastic limit", made, cure, swap(made, load, cure)
    flat, cure = "*BOUNDARY\nTOP, 1, 2, 0.\nTOP, 3, 3, -1.3", "*BOUNDARY\nTOP, 3, 3, -0.4"
    made = swap(deck([([flat], SLOW)], K="40.", friction="0.3, 1.", top=(4, 4, 2)), "*MATERIAL, NAME=STEEL", "*MATERIAL, NAME=RUBBER\n*HYPERELASTIC, NEO HOOKE\n0.5, 0.1\n*MATERIAL, NAME=STEEL")
    made = swap(made, "*ELEMENT, TYPE=C3D8, ELSET=SLIDER", "*ELEMENT, TYPE=C3D8R, ELSET=SLIDER")
    made = swap(made, "*SOLID SECTION, ELSET=SLIDER, MATERIAL=STEEL", "*SOLID SECTION, ELSET=SLIDER, MATERIAL=RUBBER")
    yield "squeezed", "squeezed flat", made, cure, swap(made, flat, flat.replace("TOP, 3, 3, -1.3", "TOP, 3, 3, -0.4"))


def plane_cases(folder):
    """The two plane decks of the folder above, with the advised stiffness and stick slope."""
    for name, stiffness, friction, new in (
        ("two-blocks", "1e+07, 0.001", "0.3, 1e+06", ("40000", "0.3, 400")),
        ("pinned-beam", "1e+06, 1e-06", "0.5773502692, 100000", ("300", "0.5773502692, 3")),
    ):
        with open(os.path.join(folder, "..", f"{name}.inp")) as file:
            made = file.read().splitlines()
        tension = stiffness.split(",")[1]
        cured = swap(swap(made, stiffness, new[0] + "," + tension), friction, new[1])
        yield name, "stiff contact", made, f"{new[0]}\n*FRICTION\n{new[1]}", cured


def run(folder, name, lines):
    """Writes and runs a deck; what came of it: converged, or the time at which it ended and the number of cuts."""
    with open(os.path.join(folder, name + ".inp"), "w") as file:
        file.write("\n".join(lines) + "\n")
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    done = subprocess.run(["ccx", "-i", name], cwd=folder, env=environment, stdout=subprocess.DEVNULL, timeout=300)
    with open(os.path.join(folder, name + ".sta")) as file:
        rows = [row.split() for row in file.read().splitlines()[2:]]
    cuts = sum("U" in row[2] for row in rows)
    for end in ("frd", "dat", "12d"):
        file = os.path.join(folder, f"{name}.{end}")
        if os.path.exists(file):
            os.remove(file)
    reached = max([float(row[4]) for row in rows] or [0.0])
    if done.returncode == 0:
        touched = os.path.getsize(os.path.join(folder, name + ".cel")) > 0
        return f"converged, {len(rows) - cuts} increments" + ("" if touched else ", without contact")
    return f"failed at time {reached:.3g}, {cuts} attempts given up"


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    rows = [("deck", "rule", "outcome", "cure", "outcome with the cure")]
    for name, rule, made, cure, cured in [*main_cases(), *more_cases(), *plane_cases(folder)]:
        outcome = run(folder, name, made)
        after = run(folder, name + "-cured", cured)
        for end in ("inp", "cel", "cvg", "sta"):
            os.remove(os.path.join(folder, f"{name}-cured.{end}"))
        rows.append((name, rule, outcome, cure, after))
        print(*rows[-1][:3], repr(cure), after, os.path.getsize(os.path.join(folder, name + ".cel")), sep=" | ", flush=True)
    for name, *_ in plane_cases(folder):
        for end in ("inp", "cel", "cvg", "sta"):
            os.remove(os.path.join(folder, f"{name}.{end}"))
    for file in os.listdir(folder):
        if file.endswith(".nam") or file == "spooles.out":
            os.remove(os.path.join(folder, file))
    with open(os.path.join(folder, "causes.csv"), "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
