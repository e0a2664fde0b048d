"""Attach a solver to stickslip, the debugger for contact iterations.

A solver is a class with two to five methods: `scene` and `step`, and optionally `force`, `restore` and `problem`.
Only implemented methods are offered to the debugger::

    from stickslip_attach import Solver, attach

    class Mine(Solver):
        name, version = "Mine", "1.0"

        def scene(self):                  # nodes, surfaces, contacts
            ...

        def step(self):                   # one iteration: the values at each contact
            ...

    attach(Mine)

`stickslip attach -- python mine.py` then steps it. Messages are dictionaries with the keys that the manual's page
`protocol` describes (`stickslip help protocol`); numpy arrays can be used instead of lists. Infinity is sent as null; a
message with NaN is refused, and the refusal names its position. Standard output carries only messages: everything that the
solver prints, from Python, C or Fortran, goes to standard error.

A solver that keeps its own loops uses `Loops` instead: one call of `pause` in the innermost loop.

Requires Python 3.9 or newer and only its standard library. Part of stickslip, MIT or Apache-2.0.
"""

import copy
import json
import mmap
import os
import queue
import select
import signal
import socket
import sys
import threading
import traceback
from dataclasses import asdict, dataclass, field
from typing import Any, Callable, ClassVar, Optional, Union

__all__ = ["Loops", "Parameter", "Refused", "Solver", "attach"]

Message = dict[str, Any]
Id = Union[int, str]

PROTOCOLS = (1, 2)  # Version 2 has scenes in space.
MOST_BYTES = 64 << 20
MODES = ("free", "sliding", "fixed")
ENDS = ("iteration", "equilibrium", "increment", "cut", "failure", "done")
# The ability that a request needs, by the name of the method that provides it.
NEEDS = {"force": "force", "release": "force", "save": "restore", "restore": "restore", "problem": "problem"}


class Refused(Exception):
    """Raise this to refuse a request: the debugger shows the text and continues."""


@dataclass(frozen=True)
class Parameter:
    """An attribute of the solver that the user may change during a run.

    A value is checked, then assigned; use a property with a setter to react to it. Three names have a predefined meaning:
    `increment` (its size; the current increment restarts), `friction` (mu of all contacts), `cohesion`.
    """

    name: str
    about: str = ""
    kind: str = "number"  # or "integer", "flag", "choice", "text"
    least: Optional[float] = None
    most: Optional[float] = None
    choices: tuple[str, ...] = ()
    tunes: bool = False  # Changes how the solver iterates, not the answer: remedies try a tenth and a hundredth.

    def checked(self, value: Any) -> Any:
        """The value converted to its kind; refused if it has another kind or is out of range."""
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        wanted, fits = {
            "number": ("a number", number),
            "integer": ("a whole number", number and float(value).is_integer()),
            "flag": ("true or false", isinstance(value, bool)),
            "choice": ("one of " + ", ".join(self.choices), value in self.choices),
            "text": ("a text", isinstance(value, str)),
        }[self.kind]
        if not fits:
            raise Refused(f"{self.name} must be {wanted}, not {value!r}")
        if number and self.least is not None and value < self.least:
            raise Refused(f"{self.name} must be at least {self.least}, not {value}")
        if number and self.most is not None and value > self.most:
            raise Refused(f"{self.name} must be at most {self.most}, not {value}")
        return {"number": float, "integer": int}.get(self.kind, lambda as_it_is: as_it_is)(value)


class Solver:
    """Base class of attached solvers. Implement `scene` and `step`, and the other methods that your solver supports."""

    name: ClassVar[str] = "solver"
    version: ClassVar[str] = ""
    #: "table2" or "newton" if the solver chooses its modes by these rules and the debugger should check each choice.
    decides: ClassVar[Optional[str]] = None
    #: Parameters that the user may change.
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    #: The states that can be restored: "any", or the start and those at the end of an "increment".
    restores: ClassVar[str] = "any"
    #: Whether `step` checks `interrupted`.
    interrupts: ClassVar[bool] = False
    #: Whether `step` may leave out contacts whose numbers and mode are those before it; the others then need an `id`.
    partial: ClassVar[bool] = False
    #: The modes that the user holds, by contact. `force` is called for each of them before every step; a solver needs
    #: this only to determine whether its modes have settled.
    held: dict[Id, str]

    def __new__(cls, *_: Any, **__: Any) -> "Solver":
        solver = super().__new__(cls)
        solver.held = {}
        return solver

    def scene(self) -> Message:
        """Return the scene: `title`, `nodes`, `lines`, `surfaces`, `contacts`. Called once.

        In space: `dimension` 3, three coordinates per node, `faces` to draw, and `faces` instead of `nodes` in surfaces.
        """
        raise NotImplementedError("a solver needs a method `scene`")

    def step(self) -> Message:
        """Make one iteration, and return its result: `ended`, `contacts`, `residual`, `load`, `displacements`.

        `contacts` is a list of dictionaries in the order of the scene, or a dictionary of columns: `mode` (of this
        solve), `next`, `gap`, `f_n`, `f_t`, `limit`, `slip`; in space, `f_t` and `slip` are pairs. `id` and `at` are optional; without `at`, the position is
        counted from `ended`. After "done", `step` is called again only after a mode was forced or a parameter set.
        """
        raise NotImplementedError("a solver needs a method `step`")

    def force(self, contact: Id, mode: str) -> None:
        """Use this mode at this contact in the next iteration; all others follow the solver's own rules."""

    def restore(self, saved: Any) -> None:
        """Restore the state that `save` returned; the next iterations must be bit-identical. `vars(self).update(saved)` may do."""

    def problem(self) -> Message:
        """Return the interface problem of the next iteration: `matrix`, `q`, `mu`; `kind`, if it is not a compliance; `tangents` 2 in
        space."""
        raise NotImplementedError

    def save(self) -> Any:
        """Return what `restore` needs; a deep copy is stored. The default is all attributes; leave out what never changes."""
        return vars(self)

    def interrupted(self) -> bool:
        """Whether the user asks this step to end; a long step may check this regularly, and raise `Refused`."""
        return _line is not None and _line.interrupted.is_set()

    def message(self, text: str, level: str = "info") -> None:
        """Show the user a message; `level` is "info", "warning" or "error"."""
        if _line is not None:
            _line.say(_text({"type": "message", "level": level, "text": text}))

    def progress(self, text: str, done: Optional[float] = None, of: Optional[float] = None) -> None:
        """Show the user how far a long step is."""
        if _line is not None:
            _line.say(_text({"type": "progress", "text": text, "done": done, "of": of}))


def attach(make: Callable[[], Solver]) -> None:
    """Create the solver, and answer the debugger until it disconnects.

    `make` is the class, or a function without arguments. It is called after standard output is redirected: import packages
    that print during their import inside it.
    """
    global _line
    if os.isatty(0):
        print("This program is started by the debugger: stickslip attach -- COMMAND", file=sys.stderr)
    _line = _Line()
    try:
        session = _Session(make())
    except Exception as error:
        traceback.print_exc()
        _line.say(_text({"type": "bye", "reason": _told(error)}))
        sys.exit(1)
    signal.signal(signal.SIGINT, _line.stop)
    threading.Thread(target=_line.listen, daemon=True).start()
    try:
        while (ask := _line.requests.get()) is not None:
            _line.say(session.answer(ask))
    except BrokenPipeError:
        pass  # The debugger is gone.


class Loops:
    """A solver that keeps its own loops::

        loops = Loops(scene, name="Mine")             # the scene, as `Solver.scene` returns it
        for load in loads:
            while not settled:
                modes = loops.modes(modes)            # the user may force others
                ...
                loops.pause(ended="iteration", load=load, contacts={"mode": modes, "next": chosen, "gap": gaps})
        loops.end()

    The debugger goes back to any state without code of the solver: each saved state is a copy of the process (`os.fork`). This
    requires a system with fork, and one process without threads or files that it writes during the run; otherwise pass
    `forks=False`, and the debugger replays from the start.
    """

    def __init__(self, scene: Message, name: str = "solver", version: str = "", forks: bool = True) -> None:
        global _line
        _line = _Line()
        self.solver = _Looped(scene, name, version)
        self.session = (_Forks if forks and hasattr(os, "fork") else _Session)(self.solver)
        self.answer()

    def modes(self, chosen: list[str]) -> list[str]:
        """The modes of the next solve: the chosen ones, or what the user forces."""
        forced, self.solver.forced = self.solver.forced, {}
        return [forced.get(contact, mode) for contact, mode in zip(self.session.ids, chosen)]

    def pause(self, **state: Any) -> None:
        """Report an iteration (the keys that `Solver.step` returns), and wait until the debugger asks for the next one."""
        assert _line is not None
        self.solver.state = state
        _line.say(self.session.answer({"type": "step"}))
        self.answer()

    def end(self) -> None:
        """Answer until the debugger leaves."""
        assert _line is not None
        while True:
            self.session.course.over = True
            # The step that ended the last pause.
            _line.say(_text({"type": "refused", "reason": "the loops of the solver have ended"}))
            self.answer()

    def answer(self) -> None:
        """Answer requests until the next step."""
        assert _line is not None
        while (ask := _line.read()) is not None and ask.get("type") != "bye":
            if ask.get("type") == "step" and not self.session.course.over:
                return
            if ask.get("type") != "interrupt":
                _line.say(self.session.answer(ask))
        self.session.leave()
        os._exit(0)


class _Line:
    """The connection to the debugger, on private copies of standard input and output."""

    def __init__(self) -> None:
        self.interrupted = threading.Event()
        self.requests: queue.SimpleQueue[Optional[Message]] = queue.SimpleQueue()
        self.lock = threading.Lock()
        self.busy = False
        self.source, self.sink = _connected()
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.close(nothing)
        os.dup2(2, 1)
        sys.stdout.flush()
        sys.stdout = sys.stderr

    def listen(self) -> None:
        """Read lines in the background, so that an interrupt arrives during a step; until the end of the input, or a bye."""
        rest, bye = b"", False
        while not bye and (part := os.read(self.source, 1 << 16)):
            *lines, rest = (rest + part).split(b"\n")
            for line in lines:
                ask = _request(line)
                bye = bye or ask.get("type") == "bye"
                if ask.get("type") == "interrupt":
                    self.interrupted.set()
                elif not bye:
                    self.interrupted.clear()  # Earlier interrupts do not apply to this request.
                    self.requests.put(ask)
        self.interrupted.set()
        self.requests.put(None)

    def read(self) -> Optional[Message]:
        """The next request, without a thread, and letter by letter: the rest belongs to whichever copy of the process continues."""
        line = b""
        while (part := os.read(self.source, 1)) not in (b"", b"\n"):
            line += part
        return _request(line) if part else None

    def stop(self, *_: Any) -> None:
        """A signal ends the current request. A signal between requests is ignored."""
        if self.busy:
            self.busy = False
            raise KeyboardInterrupt

    def say(self, text: bytes) -> None:
        with self.lock:
            while text:
                text = text[os.write(self.sink, text):]


def _connected() -> tuple[int, int]:
    """Copies of the streams to the debugger, or a socket: `STICKSLIP_CONNECT` is `fd:0`, `unix:PATH` or `tcp:HOST:PORT`."""
    kind, _, where = os.environ.get("STICKSLIP_CONNECT", "").partition(":")
    if kind == "fd":
        return os.dup(0), os.dup(0)
    if kind == "unix":
        line = socket.socket(socket.AF_UNIX)
        line.connect(where)
    elif kind == "tcp":
        host, _, port = where.rpartition(":")
        line = socket.create_connection((host.strip("[]"), int(port)))
        line.sendall(os.environ["STICKSLIP_TOKEN"].encode() + b"\n")
    else:
        return os.dup(0), os.dup(1)
    descriptor = line.detach()
    return descriptor, os.dup(descriptor)


# A process has one standard input and output.
_line: Optional[_Line] = None


@dataclass
class _Course:
    """The state of a run outside the solver."""

    chosen: dict[Id, str]  # By the solver, for the next iteration.
    held: dict[Id, str]
    at: dict[str, int] = field(default_factory=lambda: {"increment": 1, "attempt": 1, "major": 1, "minor": 0})
    ended: Optional[str] = None  # With the last iteration.
    over: bool = False  # Done, without interventions since.
    once: dict[Id, str] = field(default_factory=dict)  # Forced for the next iteration.

    def next_place(self) -> dict[str, int]:
        at = dict(self.at)
        if self.ended == "increment":
            return {"increment": at["increment"] + 1, "attempt": 1, "major": 1, "minor": 1}
        if self.ended == "cut":
            return {**at, "attempt": at["attempt"] + 1, "major": 1, "minor": 1}
        if self.ended == "equilibrium":
            return {**at, "major": at["major"] + 1, "minor": 1}
        return {**at, "minor": at["minor"] + 1}


class _Session:
    """Answers requests, and stores forced modes, saved states and the position."""

    def __init__(self, solver: Solver) -> None:
        self.solver = solver
        self.scene = {"type": "scene", **solver.scene()}
        self.scene["contacts"] = _rows(self.scene["contacts"])
        self.ids: list[Id] = [each.setdefault("id", place) for place, each in enumerate(self.scene["contacts"])]
        modes = {each["id"]: each.get("mode", "free") for each in self.scene["contacts"]}
        self.course = _Course(chosen=modes, held=solver.held)
        self.kept: list[tuple[Any, Any, _Course]] = []
        self.requests: dict[str, Callable[[Message], Message]] = {
            "hello": self.hello, "scene": lambda ask: self.scene, "step": self.step, "force": self.force, "save": self.save,
            "release": self.release, "set": self.set, "restore": self.restore, "problem": self.problem}

    def answer(self, ask: Message) -> bytes:
        """The answer to a request; exceptions of the solver become refusals."""
        try:
            kind = str(ask.get("type"))
            if kind not in self.requests:
                raise Refused(f"no request {kind}")
            if kind in NEEDS and not self.offers(NEEDS[kind]):
                raise Refused(f"{self.solver.name} does not offer {NEEDS[kind]}")
            return _text(self.carried_out(self.requests[kind], ask))
        except Refused as refused:
            return _text({"type": "refused", "reason": str(refused)})
        except KeyboardInterrupt:
            return _text({"type": "refused", "reason": "interrupted"})
        except Exception as error:
            traceback.print_exc()
            return _text({"type": "refused", "reason": _told(error)})

    def carried_out(self, request: Callable[[Message], Message], ask: Message) -> Message:
        """The result of a request, which a signal may interrupt."""
        assert _line is not None
        _line.busy = True
        try:
            return request(ask)
        finally:
            _line.busy = False

    def offers(self, method: str) -> bool:
        return getattr(type(self.solver), method) is not getattr(Solver, method)

    def hello(self, ask: Message) -> Message:
        protocol = 2 if self.scene.get("dimension") == 3 else 1
        known = ask.get("protocols", [ask.get("protocol")])
        if protocol not in known:
            raise Refused(f"this solver needs protocol version {protocol}; the debugger supports {known}")
        solver, forces = self.solver, self.offers("force")
        abilities = {"force": forces, "hold": forces, "problem": self.offers("problem"), "interrupt": solver.interrupts, "partial": solver.partial,
                     "restore": solver.restores if self.offers("restore") else "none"}
        parameters = [{**asdict(each), "value": getattr(solver, each.name)} for each in solver.parameters]
        return {"type": "hello", "protocol": protocol, "protocols": PROTOCOLS, "name": solver.name, "version": solver.version,
                "abilities": abilities, "decides": solver.decides, "parameters": parameters}

    def step(self, ask: Message) -> Message:
        ids, course = self.ids, self.course
        if course.over:
            raise Refused("the history is complete")
        for contact, mode in course.held.items():
            self.solver.force(contact, mode)
        state = {"type": "state", "at": course.next_place(), **self.solver.step()}
        state["at"] = {"attempt": 1, "major": 1, "minor": 1, **state["at"]}
        rows = state["contacts"] = _rows(state.get("contacts", []))
        if state.get("ended") not in ENDS:
            raise Refused(f"`ended` must be one of {', '.join(ENDS)}, not {state.get('ended')!r}")
        if len(rows) != len(ids) and not self.solver.partial and (rows or state["ended"] != "failure"):
            raise Refused(f"the state has {len(rows)} contacts instead of {len(ids)}")
        for contact, row in zip(ids, rows):
            contact = row.setdefault("id", contact)
            course.chosen[contact] = row["next"]
            if contact in course.held:
                row.update(forced="held", wanted=row["next"], next=course.held[contact])
            elif contact in course.once:
                row.update(forced="once")
        course.at, course.ended, course.over = dict(state["at"]), state["ended"], state["ended"] == "done"
        course.once.clear()
        return state

    def force(self, ask: Message) -> Message:
        contact, mode = self.contact(ask), ask.get("mode")
        if mode not in MODES:
            raise Refused(f"the mode must be one of {', '.join(MODES)}, not {mode!r}")
        self.solver.force(contact, mode)
        self.forget(contact)
        (self.course.held if ask.get("hold") else self.course.once)[contact] = mode
        self.course.over = False
        return {"type": "ok"}

    def release(self, ask: Message) -> Message:
        contact = self.contact(ask)
        self.solver.force(contact, self.course.chosen[contact])
        self.forget(contact)
        self.course.over = False
        return {"type": "ok"}

    def forget(self, contact: Id) -> None:
        self.course.held.pop(contact, None)
        self.course.once.pop(contact, None)

    def contact(self, ask: Message) -> Id:
        contact: Id = ask.get("contact", "")
        if contact not in self.ids:
            raise Refused(f"no contact {contact!r}")
        return contact

    def set(self, ask: Message) -> Message:
        name = ask.get("name")
        known = {each.name: each for each in self.solver.parameters}
        if name not in known:
            raise Refused(f"no parameter {name!r}" + (f", only {', '.join(known)}" if known else ""))
        setattr(self.solver, name, known[name].checked(ask.get("value")))
        if name == "increment" and self.course.ended not in (None, "increment", "done"):
            self.course.ended = "cut"
        self.course.over = False
        return {"type": "ok"}

    def save(self, ask: Message) -> Message:
        if self.solver.restores == "increment" and self.course.ended not in (None, "increment", "done"):
            raise Refused("only states at the end of an increment can be saved")
        values = {each.name: getattr(self.solver, each.name) for each in self.solver.parameters}
        self.kept.append(copy.deepcopy((self.solver.save(), values, self.course)))
        return {"type": "saved", "token": len(self.kept) - 1}

    def restore(self, ask: Message) -> Message:
        token: Any = ask.get("token")
        if token not in range(len(self.kept)):
            raise Refused(f"no saved state {token!r}")
        saved, values, self.course = copy.deepcopy(self.kept[token])
        for name, value in values.items():
            setattr(self.solver, name, value)
        self.solver.restore(saved)  # After the parameters: their setters may change the state.
        self.solver.held = self.course.held
        return {"type": "ok"}

    def leave(self) -> None:
        """Called before the process ends."""

    def problem(self, ask: Message) -> Message:
        return {"type": "problem", "contacts": self.ids, "kind": "compliance", **self.solver.problem()}


class _Looped(Solver):
    """The solver of `Loops`, as its session sees it."""

    def __init__(self, scene: Message, name: str, version: str) -> None:
        self.described, self.state = scene, {}
        self.name, self.version = name, version  # type: ignore[misc]
        self.forced: dict[Id, str] = {}

    def scene(self) -> Message:
        return self.described

    def step(self) -> Message:
        return self.state

    def force(self, contact: Id, mode: str) -> None:
        self.forced[contact] = mode


class _Forks(_Session):
    """A session whose saved states are copies of the process, which wait at a pipe."""

    MOST = 200
    LOOK = 100  # Milliseconds between two looks of a saved state at the others.
    LEFT = 90  # Exit status of a copy that left the run to another one.

    def __init__(self, solver: Solver) -> None:
        super().__init__(solver)
        self.count = mmap.mmap(-1, 1)  # Shared by all copies.
        # Opened before the first copy, so that all copies know all of them.
        self.wake = [os.pipe() for _ in range(self.MOST)]

    def offers(self, method: str) -> bool:
        return method == "restore" or super().offers(method)

    def save(self, ask: Message) -> Message:
        token = self.count[0]
        if token == self.MOST:
            raise Refused(f"at most {self.MOST} states are saved")
        if os.fork() == 0:
            self.count[0] = token + 1
            return {"type": "saved", "token": token}
        self.wait(token)
        return {"type": "ok"}

    def wait(self, token: int) -> None:
        """Wait as a saved state, and return in the copy that continues from it. Ends with the debugger, and reports copies that died."""
        assert _line is not None
        ends, wake = select.poll(), self.wake[token][0]
        ends.register(wake, select.POLLIN)
        ends.register(_line.source, getattr(select, "POLLRDHUP", 0))
        word = b""
        while word != b"q":
            ready = dict(ends.poll(self.LOOK))
            while ended := self.ended():
                _line.say(_text({"type": "bye", "reason": f"its process ended: {ended}"}))
                self.leave()
            if wake in ready:
                word = os.read(wake, 1)
                if word == b"r" and os.fork() == 0:
                    return
            elif ready:
                break
        os._exit(self.LEFT if token else 0)

    def ended(self) -> str:
        """How a copy ended that did not leave the run to another one; empty without one."""
        try:
            while (found := os.waitpid(-1, os.WNOHANG))[0]:
                code = os.waitstatus_to_exitcode(found[1])
                if code != self.LEFT:
                    return f"signal {-code}" if code < 0 else f"exit status {code}"
        except ChildProcessError:
            pass
        return ""

    def restore(self, ask: Message) -> Message:
        token: Any = ask.get("token")
        if token not in range(self.count[0]):
            raise Refused(f"no saved state {token!r}")
        os.write(self.wake[token][1], b"r")
        os._exit(self.LEFT)

    def leave(self) -> None:
        for token in range(self.count[0]):
            os.write(self.wake[token][1], b"q")
        os._exit(self.LEFT if self.count[0] else 0)


def _request(line: bytes) -> Message:
    """The request in a line; an invalid one is refused in its turn."""
    try:
        ask = json.loads(line)
    except ValueError:
        ask = None
    return ask if isinstance(ask, dict) else {"type": None}


def _told(error: Exception) -> str:
    return f"{type(error).__name__}: {error}".rstrip(": ")


def _rows(contacts: Any) -> list[Message]:
    """Contacts as dictionaries; they may be given as columns."""
    if not isinstance(contacts, dict):
        return [dict(row) for row in contacts]
    columns = {name: column if isinstance(column, list) else _plain(column) for name, column in contacts.items()}
    if len(set(map(len, columns.values()))) > 1:
        raise Refused("the columns of contacts have different lengths: " + ", ".join(f"{n} {len(c)}" for n, c in columns.items()))
    return [dict(zip(columns, values)) for values in zip(*columns.values())]


def _text(message: Message) -> bytes:
    """The line of a message; floats read back to the same bits."""
    try:
        text = json.dumps(message, allow_nan=False, default=_plain)
    except ValueError:
        text = json.dumps(_finite(message), allow_nan=False)
    if len(text) >= MOST_BYTES:
        raise Refused(f"the {message['type']} has {len(text)} bytes; the limit is {MOST_BYTES}")
    return text.encode() + b"\n"


def _plain(value: Any) -> Any:
    """Converts numpy arrays and similar types to Python lists and numbers."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "item"):
        return value.item()
    if hasattr(value, "__iter__"):
        return list(value)
    raise Refused(f"{value!r} is not a number, text, list or dictionary")


def _finite(value: Any, *place: Any) -> Any:
    """The value with null for infinities; NaN is refused with its position."""
    if isinstance(value, float):
        if value != value:
            where = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in place)
            raise Refused(f"{where.lstrip('.')} is not a number (NaN)")
        return float(value) if value - value == 0.0 else None
    # Most values are finite numbers, which are handled inline for speed.
    if isinstance(value, dict):
        return {key: each if each.__class__ is float and each - each == 0.0 else _finite(each, *place, key)
                for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [each if each.__class__ is float and each - each == 0.0 else _finite(each, *place, at)
                for at, each in enumerate(value)]
    return value if value is None or isinstance(value, (str, int)) else _finite(_plain(value), *place)
