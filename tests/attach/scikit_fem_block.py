"""A block of hexahedra on a rough plane, pressed down, pushed and turned, with scikit-fem and an active set of its own.

    pip install scikit-fem==12.0.2

A block of 2 x 2 x 1 (E = 1000, nu = 0.3, 6 x 6 x 3 elements with eight nodes) rests on a rigid plane (mu = 0.4). Its top is moved
down by 0.01, along x by 0.006 and about the z axis by 0.006 in four increments, so that the outer nodes of the lower side slide, each
in its own direction, and the inner ones stick.

scikit-fem assembles the stiffness, which is condensed once to the lower side. An iteration solves f = K (w - q) with
w = (gap, u_1, u_2) of each node: free f = 0, fixed w = 0, sliding gap = 0 and f_t = mu f_n d. Then, with the spring k, a node is free
where f_n - k gap <= 0, sticks where |f_t - k u| is within mu (f_n - k gap), and slides beyond, in the direction d of f_t - k u.
"""

from importlib.metadata import version
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, ElementHex1, ElementVector, MeshHex, asm
from skfem.models.elasticity import lame_parameters, linear_elasticity

from stickslip_attach import Message, Parameter, Solver, attach

YOUNG, POISSON, FRICTION = 1000.0, 0.3, 0.4
DOWN, ALONG, TURN = 0.01, 0.006, 0.006
MOST, CLOSE = 200, 1e-10  # Iterations, and the change of a direction that ends them.


class Block:
    """The block, condensed to its lower side: the forces there are K w - load * pushed, (n, t, b) of each node in turn."""

    def __init__(self) -> None:
        self.mesh = mesh = MeshHex.init_tensor(np.linspace(-1, 1, 7), np.linspace(-1, 1, 7), np.linspace(0, 1, 4))
        basis = Basis(mesh, ElementVector(ElementHex1()))
        stiffness = asm(linear_elasticity(*lame_parameters(YOUNG, POISSON)), basis).tocsc()
        x, y, z = mesh.p
        self.lower = np.flatnonzero(z == 0.0)
        self.moved = np.zeros(stiffness.shape[0])
        top = z == 1.0
        self.top = basis.nodal_dofs[:, top].ravel()
        moves = np.array([ALONG - TURN * y[top], TURN * x[top], np.full(top.sum(), -DOWN)])
        self.moved[self.top] = moves.ravel()
        # n is z, t is x, and b = n x t is y.
        self.dofs = basis.nodal_dofs[[2, 0, 1]][:, self.lower].T.ravel()
        self.inner = np.setdiff1d(np.arange(len(self.moved)), np.concatenate([self.top, self.dofs]))
        self.inside = splu(stiffness[self.inner][:, self.inner])
        self.across = stiffness[self.inner][:, self.dofs]
        self.over = stiffness[self.inner][:, self.top] @ self.moved[self.top]
        own = stiffness[self.dofs]
        reduced = own[:, self.dofs].toarray() - self.across.T @ self.inside.solve(self.across.toarray())
        self.stiffness = (reduced + reduced.T) / 2
        self.pushed = own[:, self.top] @ self.moved[self.top] - self.across.T @ self.inside.solve(self.over)
        self.spring = reduced[0, 0]

    def motion(self, factor: float, w: Any) -> Any:
        """Displacements of all nodes under so much of the motion of the top."""
        u = factor * self.moved
        u[self.dofs] = w
        u[self.inner] = self.inside.solve(-factor * self.over - self.across @ w)
        return u.reshape(-1, 3)


class Pressed(Solver):
    name, version = "scikit-fem hexahedra", version("scikit-fem")
    parameters = (Parameter("friction", "Coefficient mu", least=0.0),)

    def __init__(self) -> None:
        self.block = Block()
        self.count = len(self.block.lower)
        self.friction = FRICTION
        self.increment, self.iterations = 1, 0
        self.start = np.zeros(3 * self.count)  # w at the start of the increment.
        self.modes = ["fixed"] * self.count
        self.direction = np.zeros((self.count, 2))

    def scene(self) -> Message:
        mesh = self.block.mesh
        corners = [[-1.5, -1.5, 0.0], [1.5, -1.5, 0.0], [1.5, 1.5, 0.0], [-1.5, 1.5, 0.0]]
        nodes = [{"at": at} for at in [*mesh.p.T.tolist(), *corners]]
        return {
            "title": "A block of hexahedra pressed on a rough plane and turned",
            "dimension": 3,
            "nodes": nodes,
            "faces": mesh.facets[:, mesh.boundary_facets()].T,
            "surfaces": [{"name": "plane", "faces": [[len(nodes) - 4 + k for k in range(4)]], "rigid": True}],
            "contacts": [{"id": int(node), "node": int(node), "surface": "plane", "friction": {"mu": self.friction},
                          "mode": "fixed"} for node in self.block.lower],
            "monitors": ["pressing", "pushing"],
        }

    def frozen(self) -> tuple[Any, Any]:
        """K and q of this increment, whose motions u count from its start."""
        q = np.linalg.solve(self.block.stiffness, -self.increment / 4 * self.block.pushed)
        for k in (1, 2):
            q[k::3] -= self.start[k::3]
        return self.block.stiffness, q

    def step(self) -> Message:
        self.iterations += 1
        stiffness, q = self.frozen()
        matrix, right, force = np.eye(len(q)), np.zeros(len(q)), stiffness @ q
        for k, mode in enumerate(self.modes):
            rows = slice(3 * k, 3 * k + 3)
            if mode == "free":
                matrix[rows], right[rows] = stiffness[rows], force[rows]
            elif mode == "sliding":
                for part, row in zip(self.friction * self.direction[k], (3 * k + 1, 3 * k + 2)):
                    matrix[row] = stiffness[row] - part * stiffness[3 * k]
                    right[row] = force[row] - part * force[3 * k]
        w = np.linalg.solve(matrix, right)
        f = stiffness @ w - force
        gap, u, f_n, f_t = w[::3], w.reshape(-1, 3)[:, 1:], f[::3], f.reshape(-1, 3)[:, 1:]
        pressed, dragged = f_n - self.block.spring * gap, f_t - self.block.spring * u
        size = np.linalg.norm(dragged, axis=1)
        chosen = np.where(pressed <= 0.0, "free", np.where(size <= self.friction * pressed, "fixed", "sliding")).tolist()
        direction = dragged / np.maximum(size, 1e-300)[:, None]
        slides = np.array([mode == "sliding" for mode in chosen])
        change = np.abs((direction - self.direction)[slides]).max(initial=0.0)
        was, self.modes, self.direction = self.modes, chosen, direction
        held = [self.held.get(int(node), mode) for node, mode in zip(self.block.lower, chosen)]
        settled = was == held and change <= CLOSE
        ended = "iteration" if not settled else "done" if self.increment == 4 else "increment"
        reason = {}
        if ended == "iteration" and self.iterations >= MOST:
            ended, reason = "failure", {"reason": f"the directions do not settle within {MOST} iterations"}
        total = w.copy()
        for k in (1, 2):
            total[k::3] += self.start[k::3]
        load = self.increment / 4
        if settled:
            self.start, self.iterations = total, 0
            self.increment += 1
        return {
            "ended": ended, **reason, "load": load, "residual": {"relative": change},
            "contacts": [{"mode": was[k], "next": chosen[k], "gap": gap[k], "f_n": f_n[k], "f_t": f_t[k].tolist(),
                          "limit": self.friction * max(f_n[k], 0.0), "slip": (-u[k]).tolist()} for k in range(self.count)],
            "displacements": np.vstack([self.block.motion(load, total), np.zeros((4, 3))]),
            "monitors": [f_n.sum(), f_t[:, 0].sum()],
        }

    def force(self, contact: Any, mode: str) -> None:
        self.modes[self.block.lower.tolist().index(contact)] = mode

    def save(self) -> Any:
        return {name: value for name, value in vars(self).items() if name != "block"}

    def restore(self, saved: Any) -> None:
        vars(self).update(saved)

    def problem(self) -> Message:
        stiffness, q = self.frozen()
        return {"kind": "stiffness", "tangents": 2, "matrix": stiffness, "q": q, "mu": [self.friction] * self.count}


if __name__ == "__main__":
    attach(Pressed)
