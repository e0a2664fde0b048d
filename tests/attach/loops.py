"""The node of loops.c in Python."""
from math import copysign
from stickslip_attach import Loops

px, py, mu = 1.0, 0.25, 0.2
loops = Loops({
    "title": "A node that opens where it sticks", "nodes": [{"at": [0, 0]}, {"at": [5, 0]}, {"at": [-5, 0]}],
    "surfaces": [{"name": "floor", "nodes": [1, 2], "rigid": True}],
    "contacts": [{"node": 0, "surface": "floor", "friction": {"mu": mu}}]}, name="loops in Python")
chosen = "free"
for k in range(1, 41):
    [mode] = loops.modes([chosen])
    y = 2 * py - px if mode == "free" else 0.0
    x = {"free": px - py, "sliding": (px + mu * py) / (2 + mu), "fixed": 0.0}[mode]
    f_n = x + y - py
    f_t = px - 2 * x - y
    limit = copysign(mu * abs(f_n), f_t)
    if mode == "free":
        chosen = "fixed" if y < 0 else "free"
    elif f_n <= 0:
        chosen = "free"
    elif mode == "fixed":
        chosen = "sliding" if abs(f_t) > abs(limit) else "fixed"
    loops.pause(
        ended="done" if chosen == mode else "iteration" if k < 40 else "failure", load=1,
        displacements=[[x, y], [0, 0], [0, 0]],
        contacts=[{"mode": mode, "next": chosen, "gap": y, "f_n": f_n, "f_t": f_t, "limit": limit, "slip": x}])
loops.end()
