"""SSNV128, the plate of GRECO, with scikit-fem and an active set of its own: a semi-smooth Newton method.

    pip install scikit-fem==12.0.2

A square of 40 mm (E = 1.3e11 Pa, nu = 0.2, plane strain, 32 x 32 elements with four nodes) is pressed on a rough rigid plane
(mu = 1) by 5e7 Pa on its top, and pushed along it by 15e7 Pa on its left; its right side does not move along the plane.
Source: Code_Aster's test SSNV128.

scikit-fem assembles the stiffness, which is condensed once to the 33 nodes of the lower side. An iteration solves
f = K (w - q) with w = (gap, u) of each node, of which each mode gives two: free f = 0, fixed w = 0, sliding gap = 0 and
f_t = -sgn(u) mu f_n. Then, with the spring k, a node is free where f_n - k gap <= 0, sticks where |f_t - k u| is
within mu (f_n - k gap), and slides where it is beyond. The corner's motion along the plane is held, so that its f_t is 0.
Soft springs under the lower side hold the plate up where nothing touches; they carry some 1e-6 of the load.
"""

from importlib.metadata import version
from typing import Any

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu
from skfem import Basis, ElementQuad1, ElementVector, FacetBasis, LinearForm, MeshQuad, asm
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

from stickslip_attach import Message, Parameter, Solver, attach

SIDE, ELEMENTS = 0.04, 32
YOUNG, POISSON, FRICTION = 1.3e11, 0.2, 1.0
TOP, LEFT = 5e7, 15e7  # Pressures.
SOFT = 1e-6 * YOUNG  # All springs under the lower side together (force by length and thickness).
MONITORED = (0.0, 1.25e-3, 5e-3, 7.5e-3, 11.25e-3)  # Places on the lower side whose u_x is known from other codes.
MOST = 50  # Iterations.


class Plate:
    """The plate, condensed to its lower side: what it takes to give the nodes there a motion, (n, t) each."""

    def __init__(self) -> None:
        ticks = np.linspace(0.0, SIDE, ELEMENTS + 1)
        self.mesh = mesh = MeshQuad.init_tensor(ticks, ticks)
        basis = Basis(mesh, ElementVector(ElementQuad1()))
        stiffness = asm(linear_elasticity(*lame_parameters(YOUNG, POISSON)), basis)
        pressure = LinearForm(lambda v, w: -dot(w.n, v))
        sides = ((TOP, lambda x: x[1] == SIDE), (LEFT, lambda x: x[0] == 0.0))
        load = sum(p * asm(pressure, FacetBasis(mesh, basis.elem, facets=mesh.facets_satisfying(where))) for p, where in sides)
        lower = np.flatnonzero(mesh.p[1] == 0.0)
        self.lower = lower[np.argsort(mesh.p[0, lower])]
        x, y = basis.nodal_dofs[:, self.lower]
        soft = np.zeros(len(load))
        soft[y] = SOFT / len(y)
        stiffness = (stiffness + sparse.diags(soft)).tocsc()
        # Along n = (0, 1) and t = (-1, 0).
        self.dofs = np.column_stack([y, x]).ravel()
        self.turn = np.tile([1.0, -1.0], len(x))
        self.held = 2 * len(x) - 1  # The corner along the plane.
        fixed = basis.nodal_dofs[0, mesh.p[0] == SIDE]
        self.inner = np.setdiff1d(np.arange(len(load)), np.concatenate([fixed, self.dofs]))
        self.across = stiffness[self.inner][:, self.dofs]
        self.inside = splu(stiffness[self.inner][:, self.inner])
        self.load = load
        reduced = stiffness[self.dofs][:, self.dofs].toarray() - self.across.T @ self.inside.solve(self.across.toarray())
        reduced *= np.outer(self.turn, self.turn)
        # The load here, and what comes over from inside.
        self.pushed = self.turn * (load[self.dofs] - self.across.T @ self.inside.solve(load[self.inner]))
        spring = reduced[0, 0]
        reduced[self.held], reduced[:, self.held], self.pushed[self.held] = 0.0, 0.0, 0.0
        reduced[self.held, self.held] = spring
        self.stiffness = (reduced + reduced.T) / 2
        self.spring = spring

    def motion(self, factor: float, w: Any) -> Any:
        """Displacements of all nodes of the mesh under so much of the load, where the lower side has moved by w."""
        u = np.zeros(len(self.load))
        u[self.dofs] = self.turn * w
        u[self.inner] = self.inside.solve(factor * self.load[self.inner] - self.across @ u[self.dofs])
        return u.reshape(-1, 2)


class Greco(Solver):
    name, version, decides = "scikit-fem", version("scikit-fem"), "newton"
    parameters = (Parameter("increment", "Size of the load increment", least=1e-3, most=1.0),
                  Parameter("friction", "Coefficient mu", least=0.0))

    def __init__(self) -> None:
        self.plate = Plate()
        self.count = len(self.plate.lower)
        self.friction = FRICTION
        self.size = 0.5
        self.base = 0.0  # Load factor at the start of the increment.
        self.w = np.zeros(2 * self.count)
        self.start = (self.w, ["fixed"] * self.count, np.ones(self.count))
        self.modes, self.sign = list(self.start[1]), self.start[2].copy()
        self.iterations = 0

    @property
    def increment(self) -> float:
        return self.size

    @increment.setter
    def increment(self, size: float) -> None:
        """The present increment starts again with this size."""
        self.size, self.iterations = size, 0
        self.modes, self.sign = list(self.start[1]), self.start[2].copy()

    def scene(self) -> Message:
        mesh, lower = self.plate.mesh, self.plate.lower
        nodes = [{"name": f"plate.{k + 1}", "at": at} for k, at in enumerate(mesh.p.T)]
        plane = [{"name": "plane.1", "at": [1.5 * SIDE, 0.0]}, {"name": "plane.2", "at": [-0.5 * SIDE, 0.0]}]
        area = SIDE / ELEMENTS
        return {
            "title": "SSNV128: a plate between pressure and a rough plane",
            "about": "scikit-fem; metres and pascals, plane strain, mu = 1.",
            "nodes": nodes + plane,
            "lines": mesh.facets[:, mesh.boundary_facets()].T,
            "surfaces": [{"name": "plane", "nodes": [len(nodes), len(nodes) + 1], "rigid": True}],
            "contacts": [{"id": int(node), "node": int(node), "surface": "plane", "friction": {"mu": self.friction},
                          "mode": "fixed", "area": area / 2 if k in (0, self.count - 1) else area}
                         for k, node in enumerate(lower)],
            "load": [0.0, 1.0],
            "monitors": [f"u_{1e3 * x:g}" for x in MONITORED],
        }

    @property
    def target(self) -> float:
        return min(1.0, self.base + self.size)

    def frozen(self) -> tuple[Any, Any]:
        """K and q of this increment: u counts from its start."""
        q = np.linalg.solve(self.plate.stiffness, self.target * self.plate.pushed)
        q[1::2] -= self.start[0][1::2]
        return self.plate.stiffness, q

    def step(self) -> Message:
        self.iterations += 1
        stiffness, q = self.frozen()
        matrix, right, force = np.zeros_like(stiffness), np.zeros(len(q)), stiffness @ q
        for k, mode in enumerate(self.modes):
            n, t = 2 * k, 2 * k + 1
            matrix[n, n], matrix[t, t] = 1.0, 1.0
            if mode == "free":
                matrix[[n, t]], right[[n, t]] = stiffness[[n, t]], force[[n, t]]
            elif mode == "sliding":
                share = self.sign[k] * self.friction
                matrix[t], right[t] = stiffness[t] - share * stiffness[n], force[t] - share * force[n]
        w = np.linalg.solve(matrix, right)
        f = stiffness @ w - force
        state = self.judged(w, f)
        if state["ended"] in ("increment", "done"):
            w[1::2] += self.start[0][1::2]
            self.base, self.iterations = self.target, 0
            self.start = (w, list(self.modes), self.sign.copy())
        return state

    def judged(self, w: Any, f: Any) -> Message:
        """The state, with Newton's choice of the next modes."""
        gap, u, f_n, f_t, spring = w[::2], w[1::2], f[::2], f[1::2], self.plate.spring
        pressed, dragged = f_n - spring * gap, f_t - spring * u
        was, room = self.modes, self.friction * pressed - abs(dragged)
        self.sign = np.where(dragged < 0.0, -1.0, 1.0)
        self.modes = np.where(pressed <= 0.0, "free", np.where(room >= 0.0, "fixed", "sliding")).tolist()
        ids = self.plate.lower.tolist()
        settled = was == [self.held.get(k, mode) for k, mode in zip(ids, self.modes)]
        total = w.copy()
        total[1::2] += self.start[0][1::2]
        motion = self.plate.motion(self.target, total)
        places = np.searchsorted(self.plate.mesh.p[0, self.plate.lower], MONITORED)
        ended = "iteration" if not settled else "done" if self.target >= 1.0 else "increment"
        reason = {}
        if ended == "iteration" and self.iterations >= MOST:
            ended, reason = "failure", {"reason": f"the modes do not settle within {MOST} iterations"}
        return {
            "ended": ended, **reason, "load": self.target, "spring": spring,
            "contacts": {"mode": was, "next": self.modes, "gap": gap, "slip": -u, "f_n": f_n, "f_t": f_t,
                         "limit": self.sign * self.friction * abs(f_n),
                         "margin": np.where(pressed <= 0.0, -pressed, np.minimum(pressed, abs(room)))},
            "displacements": np.vstack([motion, np.zeros((2, 2))]),
            "monitors": motion[self.plate.lower[places], 0],
        }

    def force(self, contact: Any, mode: str) -> None:
        self.modes[self.plate.lower.tolist().index(contact)] = mode

    def save(self) -> Any:
        return {name: value for name, value in vars(self).items() if name != "plate"}

    def restore(self, saved: Any) -> None:
        vars(self).update(saved)

    def problem(self) -> Message:
        stiffness, q = self.frozen()
        return {"kind": "stiffness", "matrix": stiffness, "q": q, "mu": [self.friction] * self.count}


if __name__ == "__main__":
    attach(Greco)
