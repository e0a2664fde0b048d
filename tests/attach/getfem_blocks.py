"""Two blocks of GetFEM, one pressed on the other by 0.01 and sheared by 0.02: its large-sliding contact, iteration by iteration.

    apt-get install -y python3-getfem++

          .---------.      moved in 6 increments
          |  slave  |      (0.5, 1) to (1.5, 1.5)
      .---'---------'---.
      |     master      |  (0, 0) to (2, 1), held below
      '-----------------'

Plane strain, St Venant-Kirchhoff, E = 1000, nu = 0.3, mu = 0.3, elements with eight nodes, multipliers with four. A step is
one iteration of `Model.solve`, Newton's method on the augmented Lagrangian; it is a major iteration here.

GetFEM holds its contact laws in the points of integration and has no modes. Those that are told belong to the nodes of the
multiplier: with the tractions (p, q) of the multiplier there, and the augmentation r, a node is free where p - r gap <= 0,
sticks where |q + r slip| is within mu (p - r gap), and slides else. So they can be read, and not be forced. There is no
`restore`: with all variables put back it goes on with other last digits, as it does when its memory lies elsewhere.
"""

import ctypes
import json
import os
import sys

import getfem as gf
import numpy as np

from stickslip_attach import Message, Parameter, Solver, attach

FINE = 4  # Elements a unit of length.
YOUNG, POISSON, FRICTION = 1000.0, 0.3, 0.3
MOVES = [(0.0, -0.01 * k / 2) for k in (1, 2)] + [(0.02 * k / 4, -0.01) for k in (1, 2, 3, 4)]  # Of the upper side.
AUGMENTATION = 1e4
TOLERANCE, MOST = 1e-6, 60


class Block:
    """A rectangle of elements: region 1 is its lower side, region 2 its upper one."""

    def __init__(self, left: float, right: float, low: float, high: float, columns: int, rows: int) -> None:
        self.mesh = gf.Mesh("cartesian", np.linspace(left, right, columns + 1), np.linspace(low, high, rows + 1))
        self.mesh.set_region(1, self.mesh.outer_faces_with_direction([0, -1], 0.1))
        self.mesh.set_region(2, self.mesh.outer_faces_with_direction([0, 1], 0.1))
        self.fem = gf.MeshFem(self.mesh, 2)
        self.fem.set_fem(gf.Fem("FEM_Q2_INCOMPLETE(2)"))
        self.integration = gf.MeshIm(self.mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,4)"))
        self.points = self.mesh.pts().T
        # Unknowns come in pairs; those along x, of the corners of elements.
        unknowns = {tuple(np.round(at, 9)): k for k, at in enumerate(self.fem.basic_dof_nodes().T[::2])}
        self.corners = np.array([unknowns[tuple(np.round(at, 9))] for at in self.points])
        side = [k for at, k in sorted(unknowns.items()) if at[1] == high]
        self.top, self.top_at = np.array(side), self.fem.basic_dof_nodes().T[::2][side]

    def lines(self, first: int) -> list[list[int]]:
        """The elements' edges, by the places of their nodes from `first` on."""
        points, starts = self.mesh.pid_from_cvid()
        edges = {tuple(sorted((points[start + a], points[start + b])))
                 for start in starts[:-1] for a, b in ((0, 1), (1, 3), (3, 2), (2, 0))}
        return [[first + int(a), first + int(b)] for a, b in sorted(edges)]


class Blocks(Solver):
    name, version = "GetFEM", gf.getfem_env("version")
    parameters = (Parameter("friction", "Coefficient mu", least=0.0),)

    def __init__(self) -> None:
        gf.util("trace level", 0)
        self.master = Block(0.0, 2.0, 0.0, 1.0, 2 * FINE, FINE)
        self.slave = Block(0.5, 1.5, 1.0, 1.5, round(1.5 * FINE), round(0.75 * FINE))
        self.model = model = gf.Model("real")
        model.add_fem_variable("u1", self.master.fem)
        model.add_fem_variable("u2", self.slave.fem)
        lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
        model.add_initialized_data("lame", lame)
        for block, u in ((self.master, "u1"), (self.slave, "u2")):
            model.add_finite_strain_elasticity_brick(block.integration, "SaintVenant Kirchhoff", u, "lame")
        model.add_Dirichlet_condition_with_simplification("u1", 1)
        model.add_initialized_data("move", [0.0, 0.0])
        model.add_Dirichlet_condition_with_simplification("u2", 2, "move")
        self.multiplier = gf.MeshFem(self.slave.mesh, 2)
        self.multiplier.set_fem(gf.Fem("FEM_QK(2,1)"))
        model.add_filtered_fem_variable("traction", self.multiplier, 1)
        model.add_fem_data("was1", self.master.fem)
        model.add_fem_data("was2", self.slave.fem)
        model.add_initialized_data("r", [AUGMENTATION])
        model.add_initialized_data("mu", [FRICTION])
        brick = model.add_integral_large_sliding_contact_brick_raytracing("r", 0.1, "mu")
        model.add_slave_contact_boundary_to_large_sliding_contact_brick(
            brick, self.slave.integration, 1, "u2", "traction", "was2")
        model.add_master_contact_boundary_to_large_sliding_contact_brick(
            brick, self.master.integration, 2, "u1", "was1")
        lower = np.flatnonzero(self.slave.points[:, 1] == 1.0)
        self.nodes = lower[np.argsort(self.slave.points[lower, 0])]
        self.areas = np.full(len(self.nodes), 1.0 / (len(self.nodes) - 1))
        self.areas[[0, -1]] /= 2
        self.increment, self.iteration, self.first = 0, 0, 0.0
        self.modes = ["free"] * len(self.nodes)

    @property
    def friction(self) -> float:
        return float(self.model.variable("mu")[0])

    @friction.setter
    def friction(self, mu: float) -> None:
        self.model.set_variable("mu", [mu])

    def scene(self) -> Message:
        offset = len(self.master.points)
        nodes = [{"name": f"{name}.{k + 1}", "at": at} for name, block in (("lower", self.master), ("upper", self.slave))
                 for k, at in enumerate(block.points)]
        top = np.flatnonzero(self.master.points[:, 1] == 1.0)
        return {
            "title": "Two blocks of GetFEM", "nodes": nodes,
            "lines": self.master.lines(0) + self.slave.lines(offset),
            # The outward side is on the right of a walk to the left.
            "surfaces": [{"name": "lower", "nodes": top[np.argsort(-self.master.points[top, 0])]}],
            "contacts": [{"id": int(k) + 1, "node": offset + int(k), "surface": "lower", "friction": {"mu": self.friction},
                          "area": area} for k, area in zip(self.nodes, self.areas)],
            "load": [0.0, float(len(MOVES))],
            "monitors": ["force_x", "force_y"],
        }

    def step(self) -> Message:
        if self.iteration == 0:
            self.begin()
        self.iteration += 1
        _, converged = self.iterate(1)
        self.model.assembly("build_rhs")
        residual = float(np.abs(self.model.rhs()).max())
        self.first = residual if self.iteration == 1 else self.first
        at = {"increment": self.increment + 1, "major": self.iteration}
        if not np.isfinite(residual):
            return {"at": at, "ended": "failure", "reason": "the displacements are no numbers any more"}
        state = {"at": at, "load": float(self.increment + 1), **self.found(),
                 "after": {"relative": residual / self.first if self.first else 0.0, "force": residual}}
        if converged and self.increment + 1 == len(MOVES):
            return {**state, "ended": "done"}
        if converged:
            self.increment, self.iteration = self.increment + 1, 0
            return {**state, "ended": "increment"}
        if self.iteration >= MOST:
            return {**state, "ended": "failure", "reason": f"no equilibrium within {MOST} iterations"}
        return {**state, "ended": "equilibrium"}

    def begin(self) -> None:
        """A new increment: its motion; slip counts from here."""
        self.model.set_variable("move", MOVES[self.increment])
        self.model.set_variable("was1", self.model.variable("u1"))
        self.model.set_variable("was2", self.model.variable("u2"))

    def iterate(self, most: int) -> tuple[int, bool]:
        """At most so many iterations: how many, and whether that was the last."""
        iterations, converged = self.model.solve("max_res", TOLERANCE, "max_iter", most, "lsearch", "simplest")
        return int(iterations), bool(converged)

    def found(self) -> Message:
        """Contacts, displacements and forces as they are now. n = (0, 1) and t = (-1, 0)."""
        lower, upper = (self.model.variable(name).reshape(-1, 2) for name in ("u1", "u2"))
        was_lower, was_upper = (self.model.variable(name).reshape(-1, 2) for name in ("was1", "was2"))
        at = self.slave.points[self.nodes]
        mine = self.slave.corners[self.nodes]
        x, y = (at + upper[mine]).T
        surface = self.master.top_at + lower[self.master.top]
        gap = y - np.interp(x, *surface.T)
        slip = (upper - was_upper)[mine, 0] - np.interp(x, surface[:, 0], (lower - was_lower)[self.master.top, 0])
        q, p = (self.model.interpolation(f"traction({k})", at.T, self.slave.mesh) for k in (1, 2))
        pressed, dragged = p - AUGMENTATION * gap, AUGMENTATION * slip - q
        room = self.friction * pressed - abs(dragged)
        was = self.modes
        self.modes = np.where(pressed <= 0.0, "free", np.where(room >= 0.0, "fixed", "sliding")).tolist()
        f_n, f_t = self.areas * p, -self.areas * q
        return {
            "contacts": {"mode": was, "next": self.modes, "gap": gap, "slip": slip, "f_n": f_n, "f_t": f_t,
                         "limit": np.copysign(self.friction * abs(f_n), f_t)},
            "displacements": np.vstack([lower[self.master.corners], upper[self.slave.corners]]),
            "monitors": [-f_t.sum(), f_n.sum()],
        }


def whole() -> list[Message]:
    """Each increment by one call of GetFEM's, for comparison."""
    blocks, done = Blocks(), []
    for blocks.increment in range(len(MOVES)):
        blocks.begin()
        iterations, _ = blocks.iterate(MOST)
        done.append({"iterations": iterations, "force": blocks.found()["monitors"]})
    return done


def keep_addresses() -> None:
    """GetFEM sums in the order of addresses, which Linux shuffles: starts again without that, where it is allowed."""
    unshuffled, libc = 0x0040000, ctypes.CDLL(None)  # ADDR_NO_RANDOMIZE of personality(2).
    now = libc.personality(0xFFFFFFFF)
    if not now & unshuffled and libc.personality(now | unshuffled) != -1:
        os.execv(sys.executable, [sys.executable, *sys.argv])


if __name__ == "__main__":
    keep_addresses()
    if "--whole" in sys.argv:
        print(json.dumps(whole()))
    else:
        attach(Blocks)
