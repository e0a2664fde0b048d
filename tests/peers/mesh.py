"""A mesh to be imported: half a disc on a block, drawn and meshed by Gmsh (`pip install gmsh`).

    python tests/peers/mesh.py hertz.msh

Units are free. The block is 4 wide and 1 high, of quadrilaterals; the half disc of radius 1 stands on the middle of it, of
triangles. The two share no points or curves: in Gmsh, what is to be in contact must lie apart, or it is one body.

Physical groups: `block` and `disc` (bodies), `bottom` (the support), `top` (the master surface), `arc` (the slave nodes), `flat`
(what is pressed down).
"""

import argparse

import gmsh

arguments = argparse.ArgumentParser(description="Half a disc on a block, as a mesh of Gmsh.")
arguments.add_argument("file", help="where to; .msh")
arguments.add_argument("--order", type=int, choices=(1, 2), default=2, help="of the elements")
arguments.add_argument("--size", type=float, default=0.25, help="of the elements")
arguments.add_argument("--version", type=float, choices=(2.2, 4.1), default=4.1, help="of the format")
arguments.add_argument("--binary", action="store_true", help="numbers as bytes")
asked = arguments.parse_args()

gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 2)
geometry, mesh = gmsh.model.geo, gmsh.model.mesh

# The block, walked anticlockwise from its lower left corner.
corners = [geometry.addPoint(x, y, 0) for x, y in ((0, 0), (4, 0), (4, 1), (0, 1))]
sides = [geometry.addLine(corners[k], corners[(k + 1) % 4]) for k in range(4)]
block = geometry.addPlaneSurface([geometry.addCurveLoop(sides)])
columns, rows = round(4 / asked.size), round(1 / asked.size)
for side, count in zip(sides, (columns, rows, columns, rows)):
    geometry.mesh.setTransfiniteCurve(side, count + 1)
geometry.mesh.setTransfiniteSurface(block)
geometry.mesh.setRecombine(2, block)

# The half disc: its lowest point touches the block's top at (2, 1), and is a point of its own.
left, low, right, middle = (geometry.addPoint(x, y, 0, asked.size) for x, y in ((1, 2), (2, 1), (3, 2), (2, 2)))
arc = [geometry.addCircleArc(left, middle, low), geometry.addCircleArc(low, middle, right)]
flat = geometry.addLine(right, left)
disc = geometry.addPlaneSurface([geometry.addCurveLoop([*arc, flat])])
geometry.synchronize()

for dimension, entities, name in (
    (2, [block], "block"),
    (2, [disc], "disc"),
    (1, [sides[0]], "bottom"),
    (1, [sides[2]], "top"),
    (1, arc, "arc"),
    (1, [flat], "flat"),
):
    gmsh.model.addPhysicalGroup(dimension, entities, name=name)

# Quadrilaterals of second order have 8 nodes, not 9.
gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
mesh.generate(2)
mesh.setOrder(asked.order)
gmsh.option.setNumber("Mesh.MshFileVersion", asked.version)
gmsh.option.setNumber("Mesh.Binary", asked.binary)
gmsh.write(asked.file)
gmsh.finalize()
