"""Two nodes on springs, pressed on a rough floor and dragged along it: their
modes follow Table 2 round and round, though a free and b sliding would do."""
import numpy as np
from stickslip_attach import Parameter, Solver, attach

NODES = np.array([(0, 0), (1, 0), (0, 2), (-1, 2), (3, 0), (-2, 0)], float)
SPRINGS = [(0, 1, 3), (0, 2, 4), (0, 3, 5), (1, 2, 1), (1, 3, 2)]
LOAD = [4, -3, 1, -4]  # x and y of a and b; c and d are held, e-f is the floor
FRAME = np.kron(np.eye(2), [[0, -1], [1, 0]])  # their n and t, in x and y


def compliance():
    """Motions of a and b along n and t by forces on them."""
    stiffness = np.zeros((8, 8))
    for a, b, k in SPRINGS:
        along = np.zeros((4, 2))
        along[b] = (NODES[b] - NODES[a]) / np.linalg.norm(NODES[b] - NODES[a])
        along[a] = -along[b]
        stiffness += k * np.outer(along, along)
    return FRAME.T @ np.linalg.inv(stiffness[:4, :4]) @ FRAME


class Springs(Solver):
    name, version, decides = "springs", "1", "table2"
    parameters = (Parameter("friction", "Coefficient mu", least=0),)

    def __init__(self):
        self.W = compliance()
        self.q = self.W @ FRAME.T @ LOAD
        self.friction = 0.5
        self.modes = ["free", "free"]
        self.sign = [1.0, 1.0]  # of the friction force while sliding
        self.count = 0

    def scene(self):
        law = {"surface": "floor", "friction": {"mu": self.friction}}
        return {
            "title": "Two nodes on springs", "lines": [s[:2] for s in SPRINGS],
            "nodes": [{"name": x, "at": at} for x, at in zip("abcdef", NODES)],
            "surfaces": [{"name": "floor", "nodes": [4, 5], "rigid": True}],
            "contacts": [{"id": k, "node": k, **law} for k in (0, 1)]}

    def step(self):
        A, b = np.eye(4), np.zeros(4)  # free: no force
        for k, mode in enumerate(self.modes):
            n, t = 2 * k, 2 * k + 1
            if mode != "free":
                A[n], b[n] = self.W[n], -self.q[n]
            if mode == "fixed":
                A[t], b[t] = self.W[t], -self.q[t]
            if mode == "sliding":
                A[t, n] = -self.sign[k] * self.friction
        f = np.linalg.solve(A, b)
        w = self.W @ f + self.q
        rows = zip((0, 1), self.modes, w[::2], w[1::2], f[::2], f[1::2])
        was, self.modes = self.modes, [self.table2(*row) for row in rows]
        following = [self.held.get(k, self.modes[k]) for k in (0, 1)]
        limit = self.friction * abs(f[::2]) * self.sign
        self.count += 1
        gives_up = following != was and self.count % 20 == 0
        return {
            "ended": "failure" if gives_up else
                     "done" if following == was else "iteration",
            "reason": "the modes do not settle" if gives_up else "",
            "load": 1,
            "contacts": {"mode": was, "next": self.modes, "gap": w[::2],
                         "f_n": f[::2], "f_t": f[1::2], "limit": limit,
                         "slip": -w[1::2]},
            "displacements": np.append(FRAME @ w, np.zeros(8)).reshape(6, 2)}

    def table2(self, k, mode, gap, u, f_n, f_t):
        if mode != "sliding":  # the way in which it would slide
            self.sign[k] = np.sign(f_t if mode == "fixed" else -u)
        if mode == "free":
            return "fixed" if gap < 0 else "free"
        if f_n <= 0:
            return "free"
        if mode == "fixed":
            slides = abs(f_t) > self.friction * f_n
            return "sliding" if slides else "fixed"
        return "fixed" if self.sign[k] * u > 0 else "sliding"

    def force(self, contact, mode):
        self.modes[contact] = mode

    def restore(self, saved):
        vars(self).update(saved)

    def problem(self):
        return {"matrix": self.W, "q": self.q, "mu": [self.friction] * 2}


attach(Springs)
