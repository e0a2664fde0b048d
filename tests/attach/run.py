#!/usr/bin/env python3
"""Solvers of others, attached to stickslip: each adapter of this folder is driven, and its figures are checked.

    tests/attach/run.py [--folder target/attach] [--stickslip target/release/stickslip] [--only NAME]...

What pip has is installed in a virtual environment in the folder; GetFEM comes with `apt-get install -y python3-getfem++`, or
with an interpreter that $GETFEM_PYTHON names. What is missing is said and skipped. An adapter is driven three times:

1. by `driver.py`, the other side of the protocol in a page of Python, whose figures are compared with those from elsewhere;
2. by `stickslip attach --check -- COMMAND`, which tries all that it offers;
3. by `stickslip run --trace - -- COMMAND`, whose modes, gaps and forces must be those of 1, bit for bit; GetFEM's within 1e-9, since
   its last digits depend on where its memory lies.

2 and 3 are left out, and said to be, where the program has not been built. It ends with code 1 if anything failed.
"""

import argparse
import csv
import io
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import venv
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional

from driver import Attached, Message, Refusal, letters

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SECONDS = 300  # Most that a command may take.


@dataclass
class Driven:
    """What came of driving an adapter by hand."""

    states: list[Message]
    said: str
    contacts: int = 0
    version: str = ""
    times: list[float] = field(default_factory=list)


@dataclass
class Adapter:
    """An adapter, what it needs, and what must come out of it."""

    name: str
    file: str
    packages: tuple[str, ...]  # Of pip; none where the system has it.
    module: str  # That must be there.
    drive: Callable[[Attached], Driven]
    close: float = 0.0  # By how much of its largest number two runs may differ.
    run_ends: Optional[int] = 0  # Code with which `stickslip run` ends; none where it is not asked.
    check_ends: int = 0  # Code with which `--check` ends: 1 for a solver that breaks a law.


class Failed(Exception):
    """A figure is not what it must be."""


def must(what: str, found: object, wanted: object) -> None:
    if found != wanted:
        raise Failed(f"{what}: {found}, and not {wanted}")


def near(what: str, found: float, wanted: float, relative: float) -> float:
    error = abs(found - wanted) / abs(wanted)
    if not error <= relative:
        raise Failed(f"{what}: {found:.6g}, and not {wanted:.6g} within {relative:.1g}")
    return error


def times_of(solver: Attached, most: int) -> tuple[list[Message], list[float]]:
    states: list[Message] = []
    times: list[float] = []
    while len(states) < most and not (states and states[-1]["ended"] in ("done", "failure")):
        states.append(solver.step())
        times.append(solver.seconds)
    return states, times


def faults(solver: Attached) -> Driven:
    """The helper: what a solver may do wrong is refused with its reason, and does not reach the line."""
    state = solver.step()
    must("infinity, -0 and the least number", repr([state["contacts"][0][name] for name in ("gap", "f_n", "f_t")]),
         "[None, -0.0, 5e-324]")
    said = 0
    for fault, reason in (
        ("nan", "contacts[0].gap is not a number (NaN)"), ("raises", "ZeroDivisionError: division by zero"),
        ("object", "<class 'object'> is not a number, text, list or dictionary"), ("short", "the state has 0 contacts instead of 1"),
        ("ragged", "the columns of contacts have different lengths: mode 1, next 2"),
        ("long", "the state has 734005"),
        ("end", "`ended` must be one of iteration, equilibrium, increment, cut, failure, done, not 'finished'"),
    ):
        solver.ask("set", name="fault", value=fault)
        must(fault, solver.refusal("step")[: len(reason)], reason)
        said += 1
    solver.ask("set", name="fault", value="prints")
    must("ended after prints", solver.step()["ended"], "iteration")
    must("messages", [message["text"] for message in solver.messages], ["so it is said"])
    for fault, reason, end in (("waits", "given up", lambda: solver.send({"type": "interrupt"})),
                               ("sleeps", "interrupted", lambda: solver.process.send_signal(signal.SIGINT))):
        solver.ask("set", name="fault", value=fault)
        threading.Timer(0.3, end).start()
        must(fault, solver.refusal("step"), reason)
        if not solver.seconds < 5:
            raise Failed(f"{fault}: it went on for {solver.seconds:.1f} s")
    for name, value, reason in (
        ("count", 5, "count must be at most 4, not 5"), ("count", 2.5, "count must be a whole number, not 2.5"),
        ("count", None, "count must be a whole number, not None"), ("flag", 1, "flag must be true or false, not 1"),
        ("size", 1, "no parameter 'size', only count, flag, fault"),
    ):
        must(f"{name} = {value}", solver.refusal("set", name=name, value=value), reason)
    for kind, reason in (("force", "faults does not offer force"), ("save", "faults does not offer restore"),
                         ("problem", "faults does not offer problem"), ("dance", "no request dance")):
        must(kind, solver.refusal(kind, contact="a.1", mode="free"), reason)
    must("another version", solver.refusal("hello", protocol=2), "this solver needs protocol version 1; the debugger supports [2]")
    solver.ask("set", name="fault", value="none")
    for _ in range(200):  # A signal that comes late, at any time, takes no answer away and adds none.
        solver.send({"type": "step"})
        solver.process.send_signal(signal.SIGINT)
        answer = solver.line()
        if answer["type"] != "state":
            must("a step with a signal", answer, {"type": "refused", "reason": "interrupted"})
    solver.step()
    return Driven([state], f"{said} faults refused, prints kept off the line, interrupts", times=[solver.seconds])


def size(value: Any) -> Any:
    """The length of a vector; numbers stay."""
    return math.hypot(*value) if isinstance(value, list) else value


def springs(solver: Attached) -> Driven:
    """A cycle of five, from which forcing one mode leads out; every ability."""
    start = solver.ask("save")["token"]
    states, times = times_of(solver, 15)
    must("modes", " ".join(map(letters, states)), "FF FX XS SX SS " * 2 + "FF FX XS SX SS")
    solver.ask("restore", token=start)
    must("states after a restore", solver.run(15), states)

    problem = solver.ask("problem")
    for state in states:  # gap and u are W f + q.
        force = [row[name] for row in state["contacts"] for name in ("f_n", "f_t")]
        motion = [each for row in state["contacts"] for each in (row["gap"], -row["slip"])]
        for row, q, found in zip(problem["matrix"], problem["q"], motion):
            if abs(sum(w * f for w, f in zip(row, force)) + q - found) > 1e-12:
                raise Failed("the problem is not that of the states")

    solver.ask("restore", token=start)
    solver.ask("force", contact=1, mode="sliding", hold=False)
    out = solver.run(15)
    must("modes with b forced", " ".join(map(letters, out)), "FS")
    must("its end", out[-1]["ended"], "done")
    near("F_t by F_n", out[-1]["contacts"][1]["f_t"] / out[-1]["contacts"][1]["f_n"], 0.5, 1e-12)
    must("a step after the end", solver.refusal("step"), "the history is complete")

    solver.ask("restore", token=start)
    solver.ask("force", contact=0, mode="free", hold=True)
    held = solver.run(15)
    must("modes with a held", {letters(state)[0] for state in held}, {"F"})
    must("what is said of it", held[0]["contacts"][0]["forced"], "held")
    solver.ask("restore", token=start)
    must("modes after a hold was left by a restore", solver.run(15), states)

    solver.ask("set", name="friction", value=0.25)
    solver.refusal("set", name="friction", value=-1)
    solver.refusal("set", name="frction", value=0.5)
    solver.refusal("force", contact=2, mode="free")
    solver.refusal("restore", token=99)
    return Driven(states, "cycle FF FX XS SX SS; left by forcing b", times=times)


def scikit_fem(solver: Attached) -> Driven:
    """SSNV128: motions along the plane are the mean of other codes', which differ by some per cent."""
    start = solver.ask("save")["token"]
    states, times = times_of(solver, 60)
    must("its end", states[-1]["ended"], "done")
    wanted = (2.86e-5, 2.72e-5, 2.28e-5, 1.98e-5, 1.50e-5)
    pairs = zip(solver.scene["monitors"], states[-1]["monitors"], wanted)
    worst = max(near(name, found, right, 0.05) for name, found, right in pairs)
    # The corner is held along the plane, and counts as fixed.
    must("modes", letters(states[-1]), "F" * 3 + "S" * 21 + "X" * 9)
    if not len(states) > 4:
        raise Failed("it took no iterations")
    solver.ask("restore", token=start)
    for _ in range(3):
        solver.step()
    middle = solver.ask("save")["token"]
    must("the rest of the run", solver.run(60), states[3:])
    solver.ask("restore", token=middle)
    must("the rest of the run after a restore", solver.run(60), states[3:])
    solver.ask("restore", token=middle)
    solver.ask("force", contact=solver.ids[-2], mode="sliding", hold=False)
    solver.ask("set", name="increment", value=0.25)
    state = solver.step()
    must("place and load of an increment that is begun again", (state["at"], state["load"]),
         ({"increment": 1, "attempt": 2, "major": 1, "minor": 1}, 0.25))
    solver.ask("force", contact=solver.ids[-2], mode="sliding", hold=False)
    must("mode that is forced", letters(solver.step())[-2], "S")
    must("modes in four increments", letters(solver.run(100)[-1]), letters(states[-1]))
    solver.ask("restore", token=start)
    problem = solver.ask("problem")
    must("size of the problem", (problem["kind"], len(problem["q"])), ("stiffness", 2 * len(solver.ids)))
    solver.ask("set", name="increment", value=1.0)
    whole = solver.run(60)
    must("modes in one increment", letters(whole[-1]), letters(states[-1]))
    return Driven(states, f"u_x within {100 * worst:.1f} %; 3 F 21 S 9 X", times=times)


def kratos(solver: Attached) -> Driven:
    """Six iterations; after both nodes are forced to stick, the states that Kratos was seen to go through before."""
    states, times = times_of(solver, 30)
    along = [[state["displacements"][node][0] for node in (2, 3)] for state in states]
    must("modes", " ".join(map(letters, states)), "XX XS SS SS SS SS")
    must("its end", states[-1]["ended"], "done")
    for found, right in zip(along[-1], (0.007575, 0.005162)):
        near("u_x of a slave node", found, right, 1e-4)
    for row in states[-1]["contacts"]:
        near("F_t by F_n", row["f_t"] / row["f_n"], 0.3, 1e-4)
    for contact in solver.ids:
        solver.ask("force", contact=contact, mode="fixed", hold=False)
    chaos = solver.run(30)
    after = " ".join(letters(state, "next") for state in chaos[:6])
    must("modes that follow", after, "FS FS FX XX XF FF")
    moved = [state["displacements"][node][0] for state in chaos for node in (2, 3)]
    near("least u_x", min(moved), -1.005, 1e-3)
    near("greatest u_x", max(moved), 0.7841, 1e-3)
    must("where it goes back to", (letters(chaos[-1]), chaos[-1]["ended"]), ("SS", "done"))
    # It is not the answer: friction drives node 3 on.
    against = [row["limit"] * row["slip"] < 0 for row in chaos[-1]["contacts"]]
    must("contacts whose friction goes along with the slip", against, [True, False])
    return Driven(states, "6 iterations, u_x 0.007575 0.005162; forced: FS FS FX XX XF FF", times=times)


def kratos_blocks(solver: Attached) -> Driven:
    """All nodes slide; the states after a restore are the same. Friction is not along the slip, in Kratos' own loop neither."""
    start = solver.ask("save")["token"]
    states, times = times_of(solver, 60)
    must("modes", " ".join(map(letters, states)), " ".join(["X" * 9, "S" * 9, "S" * 9]))
    must("its end", states[-1]["ended"], "done")
    solver.ask("restore", token=start)
    must("the run after a restore", solver.run(60), states)
    off = 0.0
    for row in states[-1]["contacts"]:
        near("|F_t| by F_n", size(row["f_t"]) / row["f_n"], 0.3, 1e-4)
        (a, b), (u, v) = row["f_t"], row["slip"]
        off = max(off, abs(math.degrees(math.atan2(a * v - b * u, a * u + b * v))))
    near("angle between friction and slip", off, 45.4, 1e-2)
    return Driven(states, f"all slide; friction up to {off:.1f} degrees off the slip", times=times)


def getfem(solver: Attached) -> Driven:
    """As many iterations and the same forces as calls that make all iterations of an increment; Coulomb's law overall."""
    states, times = times_of(solver, 100)
    must("its end", states[-1]["ended"], "done")
    ends = [state for state in states if state["ended"] in ("increment", "done")]
    assert isinstance(solver.process.args, list)
    done = subprocess.run([*solver.process.args, "--whole"], capture_output=True, text=True, env=solver.environment,
                          timeout=SECONDS, check=True)
    whole = json.loads(done.stdout)
    must("iterations of each increment", [state["at"]["major"] for state in ends], [each["iterations"] for each in whole])
    for state, each in zip(ends, whole):
        for axis, found, right in zip("xy", state["monitors"], each["force"]):
            if not abs(found - right) <= 1e-9 * abs(each["force"][1]):
                raise Failed(f"force along {axis}: {found}, and not {right}")
    must("modes pressed", letters(ends[1], "next"), "XXXXXXX")
    must("modes at the end", letters(ends[-1], "next"), "SSSSSSS")
    ratio = -ends[-1]["monitors"][0] / ends[-1]["monitors"][1]
    near("force along x by that along y", ratio, 0.3, 0.02)
    solver.refusal("force", contact=solver.ids[0], mode="free")
    iterations = " ".join(str(each["iterations"]) for each in whole)
    return Driven(states, f"{iterations} iterations, as in whole calls; F_x / F_y {ratio:.3f}", times=times)


def slides(state: Message, mu: float) -> None:
    """Friction on every sliding contact has its limit and the direction of the slip."""
    for row in state["contacts"]:
        if row["mode"] == "sliding":
            near("|F_t| by F_n", size(row["f_t"]) / row["f_n"], mu, 1e-9)
            for f, slip in zip(row["f_t"], row["slip"]):
                if abs(f / size(row["f_t"]) - slip / size(row["slip"])) > 1e-6:
                    raise Failed("friction is not along the slip")


def hexahedra(solver: Attached) -> Driven:
    """The outer nodes slide, each in its direction, and the states after a restore are the same."""
    start = solver.ask("save")["token"]
    states, times = times_of(solver, 400)
    must("its end", states[-1]["ended"], "done")
    accepted = [state for state in states if state["ended"] in ("increment", "done")]
    must("increments", len(accepted), 4)
    for state in accepted:
        slides(state, 0.4)
        pressing = sum(row["f_n"] for row in state["contacts"])
        near("the force on the plane", state["monitors"][0], pressing, 1e-12)
    modes = letters(states[-1])
    if not ("S" in modes and "X" in modes):
        raise Failed(f"its modes are {modes}")
    solver.ask("restore", token=start)
    must("the run after a restore", solver.run(400), states)
    solver.ask("restore", token=start)
    solver.ask("set", name="friction", value=50.0)
    must("modes under strong friction", set(letters(solver.run(400)[-1])), {"X"})
    return Driven(states, f"{modes.count('S')} slide, {modes.count('X')} stick; friction along the slip", times=times)


def block3d(solver: Attached) -> Driven:
    """Friction on every sliding contact has its limit and the direction of the slip, and the problem is that of the states."""
    problem = solver.ask("problem")
    states, times = times_of(solver, 40)
    must("its end", states[-1]["ended"], "done")
    slides(states[-1], 0.4)
    force = [each for row in states[0]["contacts"] for each in (row["f_n"], *row["f_t"])]
    for row, q, contact in zip(problem["matrix"][::3], problem["q"][::3], states[0]["contacts"]):
        if abs(sum(w * f for w, f in zip(row, force)) + q - contact["gap"]) > 1e-12:
            raise Failed("the problem is not that of the first state")
    return Driven(states, f"{len(states)} iterations; friction along the slip", times=times)


ADAPTERS = (
    Adapter("helper", "faults.py", (), "ctypes", faults, run_ends=None),
    Adapter("springs", "springs.py", ("numpy",), "numpy", springs, run_ends=3),
    Adapter("scikit-fem", "scikit_fem.py", ("scikit-fem==12.0.2", "scipy"), "skfem", scikit_fem),
    Adapter("hexahedra", "scikit_fem_block.py", ("scikit-fem==12.0.2", "scipy"), "skfem", hexahedra, close=1e-12),
    Adapter("Kratos", "kratos.py", ("KratosContactStructuralMechanicsApplication==10.4.4",
                                    "KratosStructuralMechanicsApplication==10.4.4"), "KratosMultiphysics", kratos),
    # Lengths of vectors may differ in the last digit between Python and Rust.
    Adapter("Kratos 3-D", "kratos_block.py", ("KratosContactStructuralMechanicsApplication==10.4.4",
                                              "KratosStructuralMechanicsApplication==10.4.4"), "KratosMultiphysics", kratos_blocks,
            close=1e-12, check_ends=1, run_ends=3),
    Adapter("block3d", "block3d.py", (), "json", block3d, close=1e-12),
    # Its last digits depend on where its memory lies. Its law holds in integrals, so nodes penetrate.
    Adapter("GetFEM", "getfem_blocks.py", (), "getfem", getfem, close=1e-9, run_ends=3),
)


def interpreter(adapter: Adapter, folder: Path) -> tuple[Optional[str], str]:
    """A Python that has what the adapter needs; else none, and why."""
    if not adapter.packages:
        for python in (os.environ.get("GETFEM_PYTHON"), sys.executable, "/usr/bin/python3"):
            if python and has(python, adapter.module):
                return python, ""
        return None, f"no Python here has {adapter.module} (apt-get install -y python3-{adapter.module}++)"
    inside = folder / "venv" / "bin" / "python"
    if not inside.exists():
        venv.create(folder / "venv", with_pip=True)
    command = [str(inside), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *adapter.packages]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=False)
    if done.returncode or not has(str(inside), adapter.module):
        reason = (done.stderr.strip().splitlines() or ["it cannot be imported"])[-1]
        return None, f"pip install {' '.join(adapter.packages)}: {reason}"
    return str(inside), ""


def has(python: str, module: str) -> bool:
    try:
        done = subprocess.run([python, "-c", f"import {module}"], capture_output=True, timeout=SECONDS, check=False)
    except OSError:
        return False
    return done.returncode == 0


def driven(adapter: Adapter, command: list[str], environment: dict[str, str]) -> Driven:
    with tempfile.TemporaryFile() as log:
        try:
            with Attached(command, environment, log) as solver:
                found = adapter.drive(solver)
                found.contacts, found.version = len(solver.ids), solver.hello["version"]
        except (Failed, Refusal, EOFError, AssertionError, OSError, ValueError) as error:
            log.seek(0)
            tail = log.read().decode(errors="replace").splitlines()[-5:]
            raise Failed("\n    ".join([str(error) or type(error).__name__, *tail])) from error
        if solver.process.returncode:
            raise Failed(f"it ended with code {solver.process.returncode}")
    return found


def stickslip(program: str, arguments: list[str], environment: dict[str, str], ends: int) -> str:
    done = subprocess.run([program, *arguments], capture_output=True, text=True, env=environment, timeout=SECONDS, check=False)
    if done.returncode != ends:
        told = "\n    ".join((done.stdout + done.stderr).strip().splitlines()[-12:])
        raise Failed(f"stickslip {' '.join(arguments)}: code {done.returncode}, and not {ends}\n    {told}")
    return done.stdout


def same_trace(text: str, states: list[Message], close: float) -> int:
    """How many iterations were compared: those of the trace of `stickslip run` must be those that were driven here."""
    numbers = ("gap", "f_n", "f_t", "slip")
    scale = {name: max(abs(size(row[name]) or 0.0) for state in states for row in state["contacts"]) for name in numbers}
    rows = list(csv.DictReader(io.StringIO(text)))
    contacts = len(states[0]["contacts"])
    iterations = [rows[start : start + contacts] for start in range(0, len(rows), contacts)]
    if not iterations:
        raise Failed("the trace is empty")
    for traced, state in zip(iterations, states):
        for row, contact in zip(traced, state["contacts"]):
            for name in ("mode", "next"):
                must(f"{name} in the trace", row[name], contact[name])
            for name in numbers:
                found, right = float(row[name]), size(contact[name])
                if right is not None and not abs(found - right) <= close * scale[name]:
                    raise Failed(f"{name} in the trace: {found}, and not {right}")
    if states[-1]["ended"] == "done":
        must("iterations in the trace", len(iterations), len(states))
    return min(len(iterations), len(states))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=ROOT / "target" / "attach", help="for the virtual environment")
    parser.add_argument("--stickslip", help="the program; default target/release/stickslip, if it is there")
    parser.add_argument("--only", action="append", choices=[adapter.name for adapter in ADAPTERS], help="these adapters only")
    options = parser.parse_args()
    program = options.stickslip or str(ROOT / "target" / "release" / "stickslip")
    built = os.access(program, os.X_OK)
    if options.stickslip and not built:
        parser.error(f"{program} is no program")
    options.folder.mkdir(parents=True, exist_ok=True)

    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src" / "attach" / "clients")}
    names = ("adapter", "version", "contacts", "steps", "ms a step", "--check", "run", "figures", "result")
    table: list[tuple[str, ...]] = [names]
    failed = False
    for adapter in ADAPTERS:
        if options.only and adapter.name not in options.only:
            continue
        row = {name: "-" for name in names} | {"adapter": adapter.name}
        python, missing = interpreter(adapter, options.folder)
        if python is None:
            table.append(tuple((row | {"result": "skipped: " + missing}).values()))
            continue
        command = [python, str(HERE / adapter.file)]
        print(f"{adapter.name}: {' '.join(command)}", file=sys.stderr)
        try:
            found = driven(adapter, command, environment)
            milliseconds = 1e3 * sorted(found.times)[len(found.times) // 2]
            row |= {"version": found.version, "contacts": str(found.contacts), "steps": str(len(found.states)),
                    "ms a step": f"{milliseconds:.1f}", "figures": found.said, "result": "right"}
            if built and adapter.run_ends is not None:
                began = time.perf_counter()
                stickslip(program, ["attach", "--check", "--", *command], environment, adapter.check_ends)
                row["--check"] = f"{time.perf_counter() - began:.1f} s"
                trace = stickslip(program, ["run", "--trace", "-", "--", *command], environment, adapter.run_ends)
                row["run"] = f"{same_trace(trace, found.states, adapter.close)} same"
            elif adapter.run_ends is not None:
                row["--check"] = row["run"] = "not built"
        except (Failed, subprocess.TimeoutExpired) as error:
            failed = True
            row["result"] = "FAILED"
            print(f"{adapter.name}: {error}", file=sys.stderr)
        table.append(tuple(row.values()))
    widths = [max(map(len, column)) for column in zip(*table)]
    for line in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())
    if not built:
        print(f"{program} is not built: stickslip itself was not tried (cargo build --release)")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
