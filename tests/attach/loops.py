"""The node of loops.c in Python."""
from math import copysign, cos, radians, sin
from stickslip_attach import Loops

a, b, mu, g0, px, py, t_max = radians(95), radians(30), 0.2, 0.05, -1, -0.05, 0.0
xx, yy = (10 * f(a) ** 2 + 0.1 * f(b) ** 2 for f in (cos, sin))
xy = 10 * cos(a) * sin(a) + 0.1 * cos(b) * sin(b)
det = xx * yy - xy * xy
loops = Loops({
    "title": "A node that opens where it sticks", "nodes": [{"at": [0, g0]}, {"at": [5, 0]}, {"at": [-5, 0]}],
    "surfaces": [{"name": "floor", "nodes": [1, 2], "rigid": True}],
    "contacts": [{"id": 0, "node": 0, "surface": "floor", "friction": {"mu": mu}}]}, name="loops in Python")
chosen = "free"
for k in range(1, 41):
    [mode] = loops.modes([chosen])
    f_n, f_t, y = 0.0, 0.0, -g0  # n = (0, 1), t = (-1, 0): K u = p + f
    if mode == "free":
        x, y = (yy * px - xy * py) / det, (xx * py - xy * px) / det
    elif mode == "fixed":
        x, f_t, f_n = 0.0, px - xy * y, yy * y - py
    else:
        f_t = t_max
        x = (px - f_t - xy * y) / xx
        f_n = xy * x + yy * y - py
    t_max = copysign(mu * abs(f_n), f_t)
    if mode == "free":
        chosen = "fixed" if g0 + y < 0 else "free"
    elif f_n <= 0:
        chosen = "free"
    elif mode == "fixed":
        chosen = "sliding" if abs(f_t) > abs(t_max) else "fixed"
    else:
        chosen = "fixed" if t_max * x < 0 else "sliding"
    loops.pause(
        ended="failure" if k == 40 else "iteration", load=1, displacements=[[x, y], [0, 0], [0, 0]],
        contacts=[{"mode": mode, "next": chosen, "gap": g0 + y, "f_n": f_n, "f_t": f_t, "limit": t_max, "slip": -x}])
loops.end()
