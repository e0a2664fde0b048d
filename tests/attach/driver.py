"""The debugger's side of the protocol, small and strict: `run.py` drives adapters with it, without stickslip."""

import json
import subprocess
import time
from typing import Any

Message = dict[str, Any]


class Refusal(Exception):
    """The solver refused a request."""


class Attached:
    """A solver on the other side; use it in a `with`."""

    def __init__(self, command: list[str], environment: dict[str, str], log: Any) -> None:
        self.environment = environment
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, env=environment)
        self.messages: list[Message] = []
        self.seconds = 0.0
        self.hello = self.ask("hello", protocol=1, protocols=[1, 2], name="run.py", version="0")
        self.scene = self.ask("scene")
        self.ids = [contact["id"] for contact in self.scene["contacts"]]

    def __enter__(self) -> "Attached":
        return self

    def __exit__(self, *_: Any) -> None:
        if self.process.poll() is None:
            try:
                self.send({"type": "bye"})
                self.process.wait(timeout=20)
            except (BrokenPipeError, subprocess.TimeoutExpired):
                self.process.kill()
                self.process.wait()

    def send(self, message: Message) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(message).encode() + b"\n")
        self.process.stdin.flush()

    def line(self) -> Message:
        assert self.process.stdout is not None
        text = self.process.stdout.readline()
        if not text.endswith(b"\n"):
            raise EOFError(f"the solver ended in the middle of {text[:80]!r}")
        message: Message = json.loads(text, parse_constant=_no_constant)
        return message

    def ask(self, kind: str, **rest: Any) -> Message:
        """One request and its answer; `Refusal` where it is refused."""
        began = time.perf_counter()
        self.send({"type": kind, **rest})
        answer = self.line()
        while answer["type"] == "message":
            self.messages.append(answer)
            answer = self.line()
        self.seconds = time.perf_counter() - began
        if answer["type"] in ("refused", "bye"):
            raise Refusal(answer["reason"])
        wanted = {"step": "state", "save": "saved", "hello": "hello", "scene": "scene", "problem": "problem"}.get(kind, "ok")
        assert answer["type"] == wanted, f"{kind} is answered by {answer['type']}"
        return answer

    def step(self) -> Message:
        state = self.ask("step")
        assert [row["id"] for row in state["contacts"]] == self.ids, "the contacts of the state are not those of the scene"
        return state

    def refusal(self, kind: str, **rest: Any) -> str:
        """Why a request is refused that must be."""
        try:
            answer = self.ask(kind, **rest)
        except Refusal as refusal:
            return str(refusal)
        raise AssertionError(f"{kind} {rest} is not refused but answered by {answer['type']}")

    def run(self, most: int) -> list[Message]:
        """Steps until the history is over or it failed, or so many."""
        states: list[Message] = []
        while len(states) < most and not (states and states[-1]["ended"] in ("done", "failure")):
            states.append(self.step())
        return states


def letters(state: Message, which: str = "mode") -> str:
    """Modes as F, S and X."""
    letter = {"free": "F", "sliding": "S", "fixed": "X"}
    return "".join(letter[row[which]] for row in state["contacts"])


def _no_constant(name: str) -> None:
    raise AssertionError(f"{name} is no JSON")
