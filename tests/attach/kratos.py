"""Two square elements of Kratos, one pressed on the other and sheared: its frictional augmented Lagrangian, stepped.

    pip install KratosContactStructuralMechanicsApplication==10.4.4

        7 .-------. 8   moved by (0.02, -0.01)
          | upper |
        5 '-------' 6   gap 0.001, mu = 0.3
        4 .-------. 3   slave nodes
          | lower |
        1 '-------' 2   held

Plane strain, E = 2.069e11 Pa, nu = 0.29 below and 0 above, sides of 1 m. With `max_iteration: 1` every call of
`SolveSolutionStep` is one iteration of its semi-smooth Newton method, which is a major iteration here; there are no others.
The modes are flags of the slave nodes: ACTIVE, and SLIP of those that are. Its residuals are set against those of the first
iteration in each call, so that such a call never finds itself converged before they are 0. Here they are set against those
of the first iteration of all, as in a call that makes all iterations itself: the same iteration is the last then. It compares
sums of squares, so that its 1e-4 is 1e-2 of the norms that are told here.

A call always begins as a first iteration does, with which Kratos counts slip in another way. With mu = 0.3 the iterations
are those of a single call all the same; with mu = 0.1 they are not: a single call converges in 5 iterations, and calls of one
iteration each leave it in the third. Nothing of Kratos' state can be put back, so that there is no `restore`.
"""

import json
import math
from importlib.metadata import version
from typing import Any

from stickslip_attach import Message, Solver, attach

PLACES = {1: (0, 0), 2: (1, 0), 3: (1, 1), 4: (0, 1), 5: (0, 1.001), 6: (1, 1.001), 7: (1, 2), 8: (0, 2)}
ELEMENTS = {1: ([1, 2, 3, 4], 0.29), 2: ([5, 6, 7, 8], 0.0)}  # Nodes, Poisson's ratio.
PARTS = {"lower": ([1, 2, 3, 4], [1]), "upper": ([5, 6, 7, 8], [2]), "interface": ([3, 4, 5, 6], []),
         "floor": ([1, 2], []), "top": ([7, 8], [])}  # Nodes, elements.
SLAVES = (3, 4)
FRICTION = 0.3
TOLERANCE = 1e-2  # Of the residuals' norms, relative to the first ones.
MOST = 60  # Iterations.


def moved(part: str, fixed: list[bool], value: list[Any]) -> Message:
    return {"python_module": "assign_vector_variable_process", "kratos_module": "KratosMultiphysics",
            "Parameters": {"model_part_name": f"Structure.{part}", "variable_name": "DISPLACEMENT",
                           "constrained": fixed, "value": value}}


SETTINGS = {
    "problem_data": {"problem_name": "blocks", "parallel_type": "OpenMP", "echo_level": 0, "start_time": 0.0, "end_time": 1.0},
    "solver_settings": {
        "solver_type": "Static", "analysis_type": "non_linear", "model_part_name": "Structure", "domain_size": 2,
        "echo_level": 0, "time_stepping": {"time_step": 1.0}, "max_iteration": 1,
        "model_import_settings": {"input_type": "use_input_model_part"},
        "material_import_settings": {"materials_filename": ""},
        "contact_settings": {"mortar_type": "ALMContactFrictional", "fancy_convergence_criterion": False},
        "convergence_criterion": "contact_residual_criterion",
        "linear_solver_settings": {"solver_type": "skyline_lu_factorization"},
    },
    "processes": {
        "constraints_process_list": [moved("floor", [True, True, True], [0.0, 0.0, 0.0]),
                                     moved("top", [True, True, False], [0.02, -0.01, None])],
        "contact_process_list": [{
            "python_module": "alm_contact_process", "kratos_module": "ContactStructuralMechanicsApplication",
            "Parameters": {"model_part_name": "Structure", "contact_type": "Frictional",
                           "contact_model_part": {"0": ["interface"]}, "assume_master_slave": {"0": ["lower"]},
                           "friction_coefficients": {"0": FRICTION}}}],
    },
}


class Kratos(Solver):
    name, version = "Kratos ALM", version("KratosMultiphysics")
    slave_numbers, friction, settings = SLAVES, FRICTION, SETTINGS
    components = "XY"

    def __init__(self) -> None:
        # Kratos prints while it is imported.
        import KratosMultiphysics as core
        import KratosMultiphysics.ContactStructuralMechanicsApplication as contact
        import KratosMultiphysics.StructuralMechanicsApplication as structural
        from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis

        core.ParallelUtilities.SetNumThreads(1)  # Sums in one order: the same bits in every run.
        core.Logger.GetDefaultOutput().SetSeverity(core.Logger.Severity.WARNING)
        self.core, self.law = core, contact
        self.analysis = StructuralMechanicsAnalysis(core.Model(), core.Parameters(json.dumps(self.settings)))
        self.solver = self.analysis._GetSolver()
        self.part = self.solver.main_model_part
        self.build(structural)
        self.analysis.Initialize()
        self.analysis.time = self.solver.AdvanceInTime(self.analysis.time)
        self.analysis.InitializeSolutionStep()
        self.solver.Predict()
        self.slaves = [self.part.Nodes[number] for number in self.slave_numbers]
        self.iteration = 0
        self.first: dict[str, float] = {}  # Residuals of the first iteration.
        self.last: dict[str, float] = {}

    def build(self, structural: Any) -> None:
        """Nodes, elements and parts of the model."""
        core = self.core
        for number, (x, y) in PLACES.items():
            self.part.CreateNewNode(number, x, y, 0.0)
        for number, (nodes, ratio) in ELEMENTS.items():
            material = self.part.CreateNewProperties(number)
            material[core.YOUNG_MODULUS], material[core.POISSON_RATIO] = 2.069e11, ratio
            material[core.THICKNESS], material[core.DENSITY] = 1.0, 1e3
            material[core.CONSTITUTIVE_LAW] = structural.LinearElasticPlaneStrain2DLaw()
            self.part.CreateNewElement("SmallDisplacementElement2D4N", number, nodes, material)
        for name, (nodes, elements) in PARTS.items():
            part = self.part.CreateSubModelPart(name)
            part.AddNodes(nodes)
            part.AddElements(elements)

    def scene(self) -> Message:
        at = list(PLACES)
        return {
            "title": "Two elements of Kratos",
            "about": "Augmented Lagrangian with friction, mortar; one iteration a step. Metres and newtons.",
            "nodes": [{"name": str(number), "at": place} for number, place in PLACES.items()],
            "lines": [[at.index(nodes[k - 1]), at.index(nodes[k])] for nodes, _ in ELEMENTS.values() for k in range(4)],
            "surfaces": [{"name": "upper", "nodes": [at.index(5), at.index(6)]}],
            "contacts": [{"id": number, "node": at.index(number), "surface": "upper", "mode": self.mode(node),
                          "friction": {"mu": FRICTION}, "area": node.GetValue(self.core.NODAL_AREA)}
                         for number, node in zip(SLAVES, self.slaves)],
        }

    def mode(self, node: Any) -> str:
        if not node.Is(self.core.ACTIVE):
            return "free"
        return "sliding" if node.Is(self.core.SLIP) else "fixed"

    def force(self, contact: Any, mode: str) -> None:
        node = self.part.Nodes[contact]
        node.Set(self.core.ACTIVE, mode != "free")
        node.Set(self.core.SLIP, mode == "sliding")

    def step(self) -> Message:
        modes = [self.mode(node) for node in self.slaves]
        self.iteration += 1
        self.solver.SolveSolutionStep()
        before, self.last = self.last, self.residuals()
        self.first = self.first or self.last
        contacts = [self.found(number, mode) for number, mode in zip(self.slave_numbers, modes)]
        state = {"at": {"increment": 1, "major": self.iteration}, "load": 1.0, "contacts": contacts, "ended": "equilibrium",
                 "residual": self.norms(before) if before else {}, "after": self.norms(self.last),
                 "displacements": [self.vector(node, self.core.DISPLACEMENT) for node in self.part.Nodes]}
        settled = modes == [self.held.get(row["id"], row["next"]) for row in contacts]
        if not all(map(math.isfinite, self.last.values())):
            return {"at": state["at"], "ended": "failure", "reason": "the displacements are no numbers any more"}
        if settled and self.norms(self.last)["relative"] <= TOLERANCE:
            return {**state, "ended": "done"}
        if self.iteration % MOST == 0:
            return {**state, "ended": "failure", "reason": f"no convergence in {self.iteration} iterations"}
        return state

    def found(self, number: int, mode: str) -> Message:
        """What the iteration found at a slave node. Its normal looks out of the slave, and n out of the master."""
        node, law = self.part.Nodes[number], self.law
        x, y = self.vector(node, self.core.NORMAL)
        normal, tangent = (-x, -y), (y, -x)
        area = node.GetValue(self.core.NODAL_AREA)
        # Multipliers are tractions on the slave by the scale factor.
        scale = area * self.part.ProcessInfo[self.core.SCALE_FACTOR]
        multiplier = self.vector(node, self.core.VECTOR_LAGRANGE_MULTIPLIER)
        f_n, f_t = (scale * (multiplier[0] * a + multiplier[1] * b) for a, b in (normal, tangent))
        slip = self.vector(node, law.WEIGHTED_SLIP)
        reasons = {"free": "augmented pressure not compressive", "fixed": "augmented friction within its limit",
                   "sliding": "augmented friction at its limit"}
        after = self.mode(node)
        return {"id": number, "mode": mode, "next": after, "rule": reasons[after], "normal": normal,
                "gap": node.GetSolutionStepValue(law.WEIGHTED_GAP) / area, "f_n": f_n, "f_t": f_t,
                "limit": math.copysign(FRICTION * f_n, f_t), "slip": (slip[0] * tangent[0] + slip[1] * tangent[1]) / area}

    def vector(self, node: Any, variable: Any) -> list[float]:
        return list(node.GetSolutionStepValue(variable))[:len(self.components)]

    def residuals(self) -> dict[str, float]:
        """Norms of what is out of balance: forces at unknown displacements, and conditions of the slaves' multipliers."""
        core, system = self.core, self.solver._GetSolutionStrategy().GetSystemVector()
        unknowns = {"force": ("DISPLACEMENT", self.part.Nodes), "interface": ("VECTOR_LAGRANGE_MULTIPLIER", self.slaves)}
        return {name: math.hypot(*(system[node.GetDof(component).EquationId] for node in nodes
                                   for component in (getattr(core, f"{variable}_{axis}") for axis in self.components)
                                   if not node.IsFixed(component)))
                for name, (variable, nodes) in unknowns.items()}

    def norms(self, residuals: dict[str, float]) -> dict[str, float]:
        relative = {name: value / self.first[name] for name, value in residuals.items()}
        return {"relative": max(relative.values()), "interface": relative["interface"], "force": residuals["force"],
                "limit": TOLERANCE}


if __name__ == "__main__":
    attach(Kratos)
