"""A solver in which each iteration goes wrong in another way: what `stickslip_attach` makes of it. It needs nothing."""

import ctypes
import math
import os
import time

from stickslip_attach import Message, Parameter, Refused, Solver, attach


class Faults(Solver):
    name, interrupts = "faults", True
    parameters = (
        Parameter("count", kind="integer", least=1, most=4),
        Parameter("flag", kind="flag"),
        Parameter("fault", kind="choice", choices=(
            "none", "prints", "nan", "raises", "waits", "sleeps", "object", "short", "ragged", "long", "end")),
    )

    def __init__(self) -> None:
        self.count, self.flag, self.fault = 1, False, "none"
        self.row = {"mode": "free", "next": "free", "gap": math.inf, "f_n": -0.0, "f_t": 5e-324}

    def scene(self) -> Message:
        return {"title": "Faults", "nodes": [{"at": (0.1, 0.2)}], "contacts": [{"id": "a.1", "node": 0}]}

    def step(self) -> Message:
        return {"ended": "iteration", "contacts": [self.row], **getattr(self, self.fault)()}

    def found(self, **rest: object) -> Message:
        return {"contacts": [{**self.row, **rest}]}

    def none(self) -> Message:
        return {}

    def prints(self) -> Message:
        print("Python prints")
        os.system("echo a child prints")
        library = ctypes.CDLL(None)
        library.puts(b"C prints")
        library.fflush(None)
        self.message("so it is said", "warning")
        return {}

    def nan(self) -> Message:
        return self.found(gap=math.nan)

    def raises(self) -> Message:
        return {"load": 1 / 0}

    def waits(self) -> Message:
        for _ in range(1000):
            if self.interrupted():
                raise Refused("given up")
            time.sleep(0.01)
        return {}

    def sleeps(self) -> Message:
        time.sleep(10)
        return {}

    def object(self) -> Message:
        return self.found(rule=object)

    def short(self) -> Message:
        return {"contacts": []}

    def ragged(self) -> Message:
        return {"contacts": {"mode": ["free"], "next": ["free", "free"]}}

    def long(self) -> Message:
        return self.found(rule="x" * (70 << 20))

    def end(self) -> Message:
        return {"ended": "finished"}


if __name__ == "__main__":
    attach(Faults)
