"""Two blocks of Kratos in space, one pressed on the other, pushed and turned: its frictional augmented Lagrangian, stepped.

    pip install KratosContactStructuralMechanicsApplication==10.4.4

Each block has 2 x 2 x 1 bricks with eight nodes (E = 2.069e11 Pa, nu = 0.29, sides of 1 m); the 9 slave nodes are on top of the lower
one, mu = 0.3. The top moves down, along x and about the z axis, so that the nodes slide in different directions. One call of
`SolveSolutionStep` is one iteration, as in `kratos.py`, in a loop of this file that pauses after each: Kratos cannot put its state
back, but copies of the process restore it.
"""

import copy
import math
from typing import Any

from kratos import SETTINGS, Kratos, moved
from stickslip_attach import Loops, Message

SIDE, GAP = 3, 1e-4  # Nodes along a side of a block.
DOWN, ALONG, TURN = 1e-3, 2e-3, 4e-4
LAYER = SIDE * SIDE
HEIGHTS = (0.0, 1.0, 1.0 + GAP, 2.0 + GAP)
PLACES = {1 + i + SIDE * j + LAYER * k: (i, j, z) for k, z in enumerate(HEIGHTS) for j in range(SIDE) for i in range(SIDE)}
CORNERS = (0, 1, SIDE + 1, SIDE)
BRICKS = [[1 + i + SIDE * j + LAYER * (k + up) + corner for up in (0, 1) for corner in CORNERS]
          for k in (0, 2) for j in range(SIDE - 1) for i in range(SIDE - 1)]
SIDES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def layer(k: int) -> list[int]:
    return list(range(1 + LAYER * k, 1 + LAYER * (k + 1)))


def settings() -> Message:
    changed = copy.deepcopy(SETTINGS)
    changed["solver_settings"]["domain_size"] = 3
    held = [True, True, True]
    changed["processes"]["constraints_process_list"] = [
        moved("floor", held, [0.0, 0.0, 0.0]),
        moved("top", held, [f"{ALONG} - {TURN} * (y - 1)", f"{TURN} * (x - 1)", -DOWN])]
    return changed


def dot(a: Any, b: Any) -> float:
    return sum(x * y for x, y in zip(a, b))


class Blocks(Kratos):
    slave_numbers, settings = layer(1), settings()
    components = "XYZ"

    def build(self, structural: Any) -> None:
        core = self.core
        for number, at in PLACES.items():
            self.part.CreateNewNode(number, *map(float, at))
        material = self.part.CreateNewProperties(1)
        material[core.YOUNG_MODULUS], material[core.POISSON_RATIO], material[core.DENSITY] = 2.069e11, 0.29, 1e3
        material[core.CONSTITUTIVE_LAW] = structural.LinearElastic3DLaw()
        for number, nodes in enumerate(BRICKS, 1):
            self.part.CreateNewElement("SmallDisplacementElement3D8N", number, nodes, material)
        half = len(BRICKS) // 2
        elements = list(range(1, 2 * half + 1))
        for name, nodes, own in (("lower", layer(0) + layer(1), elements[:half]), ("upper", layer(2) + layer(3), elements[half:]),
                                 ("interface", layer(1) + layer(2), []), ("floor", layer(0), []), ("top", layer(3), [])):
            part = self.part.CreateSubModelPart(name)
            part.AddNodes(nodes)
            part.AddElements(own)

    def scene(self) -> Message:
        return {
            "title": "Two blocks of Kratos in space", "dimension": 3,
            "about": "Augmented Lagrangian with friction, mortar; one iteration a step. Metres and newtons.",
            "nodes": [{"name": str(number), "at": at} for number, at in PLACES.items()],
            "faces": [[brick[k] - 1 for k in side] for brick in BRICKS for side in SIDES],
            "surfaces": [{"name": "upper", "faces": [[brick[k] - 1 for k in (3, 2, 1, 0)] for brick in BRICKS[len(BRICKS) // 2:]]}],
            "contacts": [{"id": number, "node": number - 1, "surface": "upper", "mode": self.mode(node),
                          "friction": {"mu": self.friction}, "area": node.GetValue(self.core.NODAL_AREA)}
                         for number, node in zip(self.slave_numbers, self.slaves)],
        }

    def found(self, number: int, mode: str) -> Message:
        """What the iteration found at a slave node. Its normal looks out of the slave, and n out of the master."""
        node, law = self.part.Nodes[number], self.law
        normal = [-x for x in self.vector(node, self.core.NORMAL)]
        size = math.hypot(*normal)
        normal = [x / size for x in normal]
        tangent = [float(k == 0) - normal[0] * x for k, x in enumerate(normal)]
        size = math.hypot(*tangent)
        t = [x / size for x in tangent]
        b = [normal[k - 2] * t[k - 1] - normal[k - 1] * t[k - 2] for k in range(3)]  # n x t
        area = node.GetValue(self.core.NODAL_AREA)
        # Multipliers are tractions on the slave by the scale factor.
        force = [area * self.part.ProcessInfo[self.core.SCALE_FACTOR] * x
                 for x in self.vector(node, self.core.VECTOR_LAGRANGE_MULTIPLIER)]
        slip = self.vector(node, law.WEIGHTED_SLIP)
        f_n = dot(force, normal)
        return {"id": number, "mode": mode, "next": self.mode(node), "normal": normal, "tangent": t,
                "gap": node.GetSolutionStepValue(law.WEIGHTED_GAP) / area, "f_n": f_n, "f_t": [dot(force, t), dot(force, b)],
                "limit": self.friction * max(f_n, 0.0), "slip": [dot(slip, t) / area, dot(slip, b) / area]}


if __name__ == "__main__":
    # Kratos prints: the connection to the debugger is made after it is set up, and what it prints goes to standard error until then.
    import os
    line = os.dup(1)
    os.dup2(2, 1)
    blocks = Blocks()
    os.dup2(line, 1)
    os.close(line)
    loops = Loops(blocks.scene(), name=Blocks.name, version=Blocks.version)
    while True:
        modes = [blocks.mode(node) for node in blocks.slaves]
        for number, mode in zip(blocks.slave_numbers, loops.modes(modes)):
            blocks.force(number, mode)
        state = blocks.step()
        loops.pause(**state)
        if state["ended"] == "done":
            break
    loops.end()
