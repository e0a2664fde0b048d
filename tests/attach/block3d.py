"""A block of 8-node bricks, pressed on a rough plane and dragged on a bent path: a solver in space (protocol version 2).

    stickslip attach -- python3 block3d.py [R] [wrong]

Semi-smooth Newton method on the friction cone, one iteration per step. With R = 1 (the default) it converges; with R = 30 the
directions of sliding swing. With `wrong`, friction acts along -x from the second
increment on, whatever the slip. Python's standard library only.
"""
import sys
from math import hypot, sqrt
from stickslip_attach import Parameter, Solver, attach

CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
COUNT, SIZE, E, NU = (2, 1, 1), (4.0, 2.0, 2.0), 1000.0, 0.3
PATH = ((0, 0, -0.01), (0.006, 0, -0.01), (0.006, 0.008, -0.01))


def solve(a, columns):
    """The solutions of a x = b for each b, by Gaussian elimination with row exchanges."""
    n, rows = len(a), [list(row) + [column[i] for column in columns] for i, row in enumerate(a)]
    for k in range(n):
        p = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[p] = rows[p], rows[k]
        for row in rows[k + 1:]:
            if factor := row[k] / rows[k][k]:
                row[k:] = [x - factor * y for x, y in zip(row[k:], rows[k][k:])]
    for k in reversed(range(n)):
        for c in range(n, n + len(columns)):
            rows[k][c] = (rows[k][c] - sum(rows[k][j] * rows[j][c] for j in range(k + 1, n))) / rows[k][k]
    return [[row[n + c] for row in rows] for c in range(len(columns))]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def stiffness():
    """Nodes, bricks and the stiffness matrix."""
    nx, ny = COUNT[0] + 1, COUNT[1] + 1
    nodes = [tuple(i * L / n for i, L, n in zip(at, SIZE, COUNT))
             for at in ((i, j, k) for k in range(COUNT[2] + 1) for j in range(ny) for i in range(nx))]
    bricks = [[i + a + nx * (j + b + ny * (k + c)) for a, b, c in CORNERS]
              for k in range(COUNT[2]) for j in range(COUNT[1]) for i in range(COUNT[0])]
    h, lame, shear = [L / n for L, n in zip(SIZE, COUNT)], E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    matrix = [[0.0] * (3 * len(nodes)) for _ in range(3 * len(nodes))]
    signs = [[2 * x - 1 for x in corner] for corner in CORNERS]
    for point in signs:
        slopes = []
        for s in signs:
            f = [1 + x * y / sqrt(3) for x, y in zip(s, point)]
            slopes.append([s[a] * f[a - 1] * f[a - 2] / 8 * 2 / h[a] for a in range(3)])
        weight = h[0] * h[1] * h[2] / 8
        for brick in bricks:
            for p, d in zip(brick, slopes):
                for q, e in zip(brick, slopes):
                    for i in range(3):
                        for j in range(3):
                            same = shear * dot(d, e) if i == j else 0.0
                            matrix[3 * p + i][3 * q + j] += weight * (lame * d[i] * e[j] + shear * d[j] * e[i] + same)
    return nodes, bricks, matrix


class Block(Solver):
    name, version = "block3d", "1"
    parameters = (Parameter("friction", "Coefficient", least=0), Parameter("r", "Scale of the augmentation", least=1e-6, tunes=True))

    def __init__(self):
        self.r, self.friction = float((sys.argv[1:2] or [1])[0]), 0.4
        self.nodes, self.bricks, k = stiffness()
        self.top = [i for i, at in enumerate(self.nodes) if at[2] == SIZE[2]]
        self.slaves = [i for i, at in enumerate(self.nodes) if at[2] == 0]
        self.free = [3 * i + a for i, at in enumerate(self.nodes) if i not in self.top for a in range(3)]
        self.inner = [[k[i][j] for j in self.free] for i in self.free]
        self.coupling = [[[k[i][3 * j + a] for j in self.top] for a in range(3)] for i in self.free]
        self.rows = [self.free.index(3 * i + a) for i in self.slaves for a in (2, 0, 1)]  # n, x, y of each contact.
        units = [[float(i == row) for i in range(len(self.free))] for row in self.rows]
        self.moved = solve(self.inner, units)  # Displacements by unit forces.
        self.w = [[moved[row] for moved in self.moved] for row in self.rows]
        self.f, self.modes = [0.0] * len(self.rows), ["free"] * len(self.slaves)
        self.increment, self.before = 0, [0.0] * len(self.rows)
        self.begin()

    def begin(self):
        """The next increment: motions without contact forces."""
        by = PATH[self.increment]
        load = [-sum(sum(part) * x for part, x in zip(row, by)) for row in self.coupling]
        [self.unloaded] = solve(self.inner, [load])
        self.q = [self.unloaded[row] - (last if k % 3 else 0.0) for k, (row, last) in enumerate(zip(self.rows, self.before))]
        self.count = 0

    def scene(self):
        floor = [(-1, -1, 0), (5, -1, 0), (5, 3, 0), (-1, 3, 0)]
        n = len(self.nodes)
        return {"title": "A block in space on a plane", "dimension": 3, "load": [0, len(PATH)],
                "nodes": [{"at": at} for at in self.nodes + floor],
                "faces": [[brick[i] for i in face] for brick in self.bricks for face in FACES],
                "surfaces": [{"name": "plane", "faces": [[n, n + 1, n + 2, n + 3]], "rigid": True}],
                "contacts": [{"id": i, "node": i, "surface": "plane", "friction": {"mu": self.friction}} for i in self.slaves]}

    def step(self):
        wrong, mu = "wrong" in sys.argv and self.increment > 0, self.friction
        size, r = len(self.f), 3 * self.r * len(self.slaves) / sum(self.w[k][k] for k in range(len(self.f)))
        y = [dot(row, self.f) + q for row, q in zip(self.w, self.q)]
        unit = [[float(i == j) for j in range(size)] for i in range(size)]
        jacobian, rest = [list(row) for row in unit], list(self.f)
        for n, mode in zip(range(0, size, 3), self.modes):
            if mode == "free":
                continue
            jacobian[n], rest[n] = list(self.w[n]), y[n]
            z = [self.f[t] - r * y[t] for t in (n + 1, n + 2)]
            b = hypot(*z)
            e = [-1.0, 0.0] if wrong else [x / b for x in z] if b > 0 else [1.0, 0.0]
            limit = mu * max(self.f[n] - r * y[n], 0.0)
            for i, t in enumerate((n + 1, n + 2)):
                if mode == "fixed":
                    jacobian[t], rest[t] = list(self.w[t]), y[t]
                    continue
                rest[t] = self.f[t] - limit * e[i]
                for j in range(size):
                    turned = 0.0 if wrong or b == 0 else sum(
                        limit * (float(s == t) - e[i] * e[m]) / b * (unit[s][j] - r * self.w[s][j]) for m, s in ((0, n + 1), (1, n + 2)))
                    jacobian[t][j] = unit[t][j] - mu * e[i] * (unit[n][j] - r * self.w[n][j]) - turned
        [change] = solve(jacobian, [rest])
        self.f = [f - c for f, c in zip(self.f, change)]
        y = [dot(row, self.f) + q for row, q in zip(self.w, self.q)]
        was, self.modes, error = self.modes, [], 0.0
        for n, mode in zip(range(0, size, 3), was):
            a, z = self.f[n] - r * y[n], [self.f[t] - r * y[t] for t in (n + 1, n + 2)]
            slides = wrong or hypot(*z) > mu * a
            self.modes.append("free" if a <= 0 else "sliding" if slides else "fixed")
            part = min(1.0, mu * max(a, 0.0) / (hypot(*z) or 1.0))
            parts = [self.f[n] - max(a, 0.0)] + [self.f[t] - part * x for t, x in zip((n + 1, n + 2), z)]
            error = max(error, *map(abs, parts[:1] if wrong else parts))
        relative = error / max(1e-12, *map(abs, self.f))
        u = [x + dot(self.f, [moved[i] for moved in self.moved]) for i, x in enumerate(self.unloaded)]
        place = {dof: x for dof, x in zip(self.free, u)}
        by = PATH[self.increment]
        displacements = [[place.get(3 * i + a, by[a]) for a in range(3)] for i in range(len(self.nodes))] + [[0, 0, 0]] * 4
        contacts = [{"mode": mode, "next": new, "gap": y[n], "f_n": self.f[n], "f_t": self.f[n + 1:n + 3],
                     "slip": [-y[n + 1], -y[n + 2]], "limit": mu * max(self.f[n], 0.0)}
                    for n, mode, new in zip(range(0, size, 3), was, self.modes)]
        state = {"load": self.increment + 1, "residual": {"relative": relative}, "displacements": displacements, "contacts": contacts}
        self.count += 1
        if relative < 1e-9 and self.modes == was:
            self.before = [u[row] for row in self.rows]
            self.increment += 1
            if self.increment == len(PATH):
                return {**state, "ended": "done"}
            self.begin()
            return {**state, "ended": "increment"}
        if self.count % 24 == 0:
            return {**state, "ended": "failure", "reason": "24 iterations"}
        return {**state, "ended": "iteration"}

    def problem(self):
        return {"tangents": 2, "matrix": self.w, "q": self.q, "mu": [self.friction] * len(self.slaves)}

    def force(self, contact, mode):
        self.modes[self.slaves.index(contact)] = mode

    CHANGING = ("f", "modes", "increment", "before", "unloaded", "q", "count")

    def save(self):
        return {name: getattr(self, name) for name in self.CHANGING}

    def restore(self, saved):
        vars(self).update(saved)


attach(Block)
