"""Drives chromium without a window through its DevTools protocol, over two pipes."""

import base64
import json
import os
import subprocess
import tempfile

KEYS = {"Enter": (13, "\r"), "Tab": (9, ""), "Esc": (27, ""), "Space": (32, " "), "Backspace": (8, ""),
        "Up": (38, ""), "Down": (40, ""), "Left": (37, ""), "Right": (39, ""), "F9": (120, "")}
NAMES = {"Esc": "Escape", "Space": " ", "Up": "ArrowUp", "Down": "ArrowDown", "Left": "ArrowLeft",
         "Right": "ArrowRight"}


class Browser:
    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self.to = os.pipe()
        self.source, to_write = os.pipe()

        def connect():
            # The numbers that --remote-debugging-pipe expects; copied first, since one may be in use.
            read, write = os.dup(to_read), os.dup(to_write)
            os.dup2(read, 3)
            os.dup2(write, 4)

        self.process = subprocess.Popen(
            ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             f"--user-data-dir={self.profile.name}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=connect, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.rest = b""
        self.number = 0

    def call(self, method, session=None, **params):
        self.number += 1
        request = {"id": self.number, "method": method, "params": params}
        if session:
            request["sessionId"] = session
        os.write(self.to, json.dumps(request).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def receive(self):
        while b"\0" not in self.rest:
            part = os.read(self.source, 1 << 20)
            if not part:
                raise RuntimeError("chromium has ended")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def close(self):
        self.call("Browser.close")
        self.process.wait()
        self.profile.cleanup()


class Tab:
    """A tab with the page."""

    def __init__(self, browser, address, size=(1200, 800)):
        self.browser = browser
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        self.call("Page.enable")
        self.resize(size)
        self.call("Page.navigate", url=address)
        self.value("new Promise(done => { const look = () => window.stickslip?.loaded || window.stickslip?.failed"
                   " ? done() : setTimeout(look, 5); look(); })")
        self.settle()

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def value(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def settle(self):
        """Waits until all input is handled and the solver is idle."""
        self.value("new Promise(done => { const look = () => stickslip.failed"
                   " || (stickslip.pending === 0 && !stickslip.busy) ? done() : setTimeout(look, 5); look(); })")
        failed = self.value("stickslip.failed")
        if failed:
            raise RuntimeError(f"the program failed: {failed}")

    def resize(self, size, mobile=False):
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1],
                  deviceScaleFactor=2 if mobile else 1, mobile=mobile)

    def press(self, name):
        code, text = KEYS.get(name, (0, name))
        params = {"key": NAMES.get(name, name), "windowsVirtualKeyCode": code}
        self.call("Input.dispatchKeyEvent", type="keyDown", **params, **({"text": text} if text else {}))
        self.call("Input.dispatchKeyEvent", type="keyUp", **params)

    def type(self, text):
        for letter in text:
            self.press("Space" if letter == " " else letter)

    def line(self, text):
        self.press(":")
        self.type(text)
        self.press("Enter")
        self.settle()

    def screen(self):
        return self.value("[...document.getElementById('screen').children].map(row => row.textContent).join('\\n')")

    def screenshot(self, file):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        with open(file, "wb") as out:
            out.write(base64.b64decode(data))

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)
