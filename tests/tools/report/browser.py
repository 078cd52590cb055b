"""A page in headless Chromium, driven over its debugging pipe. Standard library only.

What the page does wrong is kept: messages of the console, exceptions, and every request but that
for the page itself.
"""

import json
import os
import select
import shutil
import subprocess
import tempfile
import time

ANSWER_SECONDS = 120
OPTIONS = ("--headless=new --no-sandbox --remote-debugging-pipe --use-gl=angle --use-angle=swiftshader "
           "--enable-unsafe-swiftshader --no-first-run --disable-background-networking --disable-component-update "
           "--disable-extensions --hide-scrollbars --disable-gpu-rasterization --disable-accelerated-2d-canvas")


def find_chromium():
    names = ("chromium", "chromium-browser", "google-chrome")
    return next(filter(None, map(shutil.which, names)), None)


class Browser:
    def __init__(self, program):
        self._folder = tempfile.TemporaryDirectory(prefix="clearway-browser-")
        to_browser, self._to = os.pipe()
        self._from, from_browser = os.pipe()

        def connect():  # its descriptors 3 and 4
            ends = (os.dup(to_browser), os.dup(from_browser))
            for end, number in zip(ends, (3, 4)):
                os.dup2(end, number, inheritable=True)

        self._process = subprocess.Popen(
            [program, *OPTIONS.split(), f"--user-data-dir={self._folder.name}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=connect, close_fds=False)
        os.close(to_browser)
        os.close(from_browser)
        self._buffer, self._next, self._answers, self.events = b"", 0, {}, []

    def close(self):
        try:
            self.call("Browser.close")
        except (RuntimeError, OSError):
            pass
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._to)
        os.close(self._from)
        self._folder.cleanup()

    def call(self, method, session=None, **parameters):
        self._next += 1
        message = {"id": self._next, "method": method, "params": parameters,
                   **({"sessionId": session} if session else {})}
        data, end = json.dumps(message).encode() + b"\0", time.monotonic() + ANSWER_SECONDS
        while data:
            data = data[os.write(self._to, data):]
        while self._next not in self._answers:
            self._read(end)
        answer = self._answers.pop(self._next)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer.get("result", {})

    def _read(self, end):
        ready, _, _ = select.select([self._from], [], [], max(0, end - time.monotonic()))
        data = os.read(self._from, 1 << 20) if ready else b""
        if not data:
            raise RuntimeError("the browser does not answer" if not ready else "the browser is gone")
        *messages, self._buffer = (self._buffer + data).split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self._answers[message["id"]] = message
            else:
                self.events.append(message)


class Page:
    """An open page that has said it is ready."""

    def __init__(self, browser, path, width=1366, height=768):
        self._browser = browser
        self._target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = browser.call("Target.attachToTarget", targetId=self._target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[  # no flights of the camera to wait for
            {"name": "prefers-reduced-motion", "value": "reduce"}])
        self.url = "file://" + os.path.abspath(path)
        self.call("Page.navigate", url=self.url)
        end = time.monotonic() + ANSWER_SECONDS
        while not self.run("document.body && document.body.dataset.ready"):
            if time.monotonic() > end:
                raise RuntimeError("the page is never ready")
            time.sleep(0.05)

    def close(self):
        """Ends the page; otherwise it goes on until the browser ends."""
        self._browser.call("Target.closeTarget", targetId=self._target)
        self._browser.events = [event for event in self._browser.events if event.get("sessionId") != self._session]

    def call(self, method, **parameters):
        return self._browser.call(method, session=self._session, **parameters)

    def run(self, expression):
        """The value of a JavaScript expression; a promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def frames(self, count=3):
        """Lets the page draw."""
        self.run(f"""new Promise((done) => {{ let left = {count};
            const next = () => left-- > 0 ? requestAnimationFrame(next) : done(true); next(); }})""")

    def key(self, key):
        enter = {"text": "\r", "windowsVirtualKeyCode": 13} if key == "Enter" else {}
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, **enter)

    def complaints(self):
        """What went wrong so far: errors, and requests for anything but the page."""
        out = []
        for event in self._browser.events:
            method, given = event["method"], event["params"]
            if event.get("sessionId") != self._session:
                continue
            if method == "Runtime.exceptionThrown":
                out.append(str(given["exceptionDetails"]))
            if method == "Runtime.consoleAPICalled" and given["type"] in ("error", "warning", "assert"):
                out.append("console: " + str(given["args"]))
            if method == "Log.entryAdded" and given["entry"]["level"] in ("error", "warning"):
                out.append("log: " + given["entry"]["text"])
            if method == "Network.requestWillBeSent":
                url = given["request"]["url"]
                if url != self.url and not url.startswith(("data:", "blob:")):
                    out.append("request: " + url)
        return out
