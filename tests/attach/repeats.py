"""A sliding node whose friction bound repeats with a period, or that sticks once per period."""
import sys
from stickslip_attach import Loops

period, repeats = int(sys.argv[1]), sys.argv[2]
loops = Loops({
    "title": "A node that repeats", "nodes": [{"at": [0, 0]}, {"at": [5, 0]}, {"at": [-5, 0]}],
    "surfaces": [{"name": "floor", "nodes": [1, 2], "rigid": True}],
    "contacts": [{"id": 0, "node": 0, "surface": "floor", "friction": {"mu": 0.2}}]}, name="repeats")
last = 3 * period
for k in range(1, last + 1):
    phase, following = k % period, (k + 1) % period
    sticks = [repeats == "modes" and at == 0 for at in (phase, following)]
    mode, chosen = ("fixed" if stick else "sliding" for stick in sticks)
    f_n = 1.0 + 0.1 * (phase if repeats == "values" else 0)
    loops.modes([mode])
    loops.pause(
        ended="failure" if k == last else "iteration", load=1, displacements=[[0.1 * f_n, 0], [0, 0], [0, 0]],
        contacts=[{"mode": mode, "next": chosen, "gap": 0, "f_n": f_n, "f_t": 0.2 * f_n, "limit": 0.2 * f_n,
                   "slip": -0.1 * f_n, "margin": 0.1 * f_n}])
loops.end()
