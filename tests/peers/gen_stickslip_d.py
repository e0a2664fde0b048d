#!/usr/bin/env python3
"""Scene D for stickslip: the two blocks and meshes of gen_ccx_d.py.  Usage: gen_stickslip_d.py out.ron n=8

Load factors 0 to 5 press (5 increments), 5 to 15 shear (10)."""
import sys

out = sys.argv[1]
n = int(dict(a.split("=", 1) for a in sys.argv[2:]).get("n", 8))
low, up = (2 * n, n), (max(1, round(1.5 * n)), max(1, round(0.75 * n)))
with open(out, "w") as f:
    f.write("""// Two blocks, meshes that do not match: the upper one is pressed down by 0.01 and dragged along by 0.02.
(
    title: "Two blocks, pressed and sheared",
    nodes: [
        Block(id: "low", corners: [(0, 0), (2, 1)], elements: (%d, %d)),
        Block(id: "up", corners: [(0.5, 1), (1.5, 1.5)], elements: (%d, %d)),
    ],
    materials: [Elastic(id: "e", E: 1000, nu: 0.3)],
    bodies: [Solid(id: "low", mesh: "low", material: "e"), Solid(id: "up", mesh: "up", material: "e")],
    surfaces: [(id: "face", along: "low.top")],
    slaves: [(nodes: ["up.bottom"], on: ["face"])],
    friction: (angle: 16.69924423399362), // coefficient 0.3
    supports: [(node: "low.bottom", fix: [x, y])],
    loads: [
        Displacement(node: "up.top.all", component: y, value: -0.01, scale: [(0, 0), (5, 1)]),
        Displacement(node: "up.top.all", component: x, value: 0.02, scale: [(5, 0), (15, 1)]),
    ],
    history: (path: [0, 15], increment: 1),
    monitors: [(name: "contact_x", of: Contact(component: x)), (name: "contact_y", of: Contact(component: y))],
)
""" % (low + up))
