"""A page in headless Chromium, driven over its debugging pipe. Standard library only.

What the page does wrong is kept: messages of the console, exceptions, and every request but that
for the page itself.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

ANSWER_SECONDS = 120


def find_chromium():
    for name in ("chromium", "chromium-browser", "google-chrome"):
        path = shutil.which(name)
        if path:
            return path
    return None


class Browser:
    """Used in a with statement; page() opens a file."""

    def __init__(self, program):
        self._folder = tempfile.TemporaryDirectory(prefix="clearway-browser-")
        to_browser, from_test = os.pipe()
        to_test, from_browser = os.pipe()

        def connect():  # its descriptors 3 and 4
            ends = (os.dup(to_browser), os.dup(from_browser))
            for end, number in zip(ends, (3, 4)):
                os.dup2(end, number, inheritable=True)

        self._process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--remote-debugging-pipe",
             f"--user-data-dir={self._folder.name}", "--use-gl=angle",
             "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
             "--disable-background-networking", "--disable-component-update",
             "--disable-extensions", "--hide-scrollbars",
             "--disable-gpu-rasterization", "--disable-accelerated-2d-canvas", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=connect,
            close_fds=False)
        os.close(to_browser)
        os.close(from_browser)
        self._to, self._from = from_test, to_test
        self._buffer, self._next, self._answers = b"", 0, {}
        self.events = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
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

    def call(self, method, session=None, seconds=ANSWER_SECONDS, **parameters):
        self._next += 1
        message = {"id": self._next, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._to, data):]
        answer = self._wait_for(self._next, time.monotonic() + seconds)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer.get("result", {})

    def _wait_for(self, number, end):
        while number not in self._answers:
            self._read(end)
        return self._answers.pop(number)

    def _read(self, end):
        ready, _, _ = select.select([self._from], [], [], max(0, end - time.monotonic()))
        if not ready:
            raise RuntimeError("the browser does not answer")
        data = os.read(self._from, 1 << 20)
        if not data:
            raise RuntimeError("the browser is gone")
        self._buffer += data
        *messages, self._buffer = self._buffer.split(b"\0")
        for text in messages:
            message = json.loads(text)
            if "id" in message:
                self._answers[message["id"]] = message
            else:
                self.events.append(message)

    def page(self, path, width=1366, height=768):
        return Page(self, path, width, height)


class Page:
    """An open page that has said it is ready."""

    def __init__(self, browser, path, width, height):
        self._browser = browser
        self._target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = browser.call("Target.attachToTarget", targetId=self._target,
                                     flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.resize(width, height)
        self.call("Emulation.setEmulatedMedia", features=[  # no flights of the camera to wait for
            {"name": "prefers-reduced-motion", "value": "reduce"}])
        self.url = "file://" + os.path.abspath(path)
        self.call("Page.navigate", url=self.url)
        self.wait("document.body && document.body.dataset.ready")

    def close(self):
        """Ends the page; otherwise it goes on until the browser ends."""
        self._browser.call("Target.closeTarget", targetId=self._target)
        self._browser.events = [event for event in self._browser.events
                                if event.get("sessionId") != self._session]

    def call(self, method, **parameters):
        return self._browser.call(method, session=self._session, **parameters)

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)

    def run(self, expression):
        """The value of a JavaScript expression; a promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def wait(self, condition, seconds=ANSWER_SECONDS):
        end = time.monotonic() + seconds
        while not self.run(condition):
            if time.monotonic() > end:
                raise RuntimeError(f"never came true: {condition}")
            time.sleep(0.05)

    def frames(self, count=3):
        """Lets the page draw."""
        self.run(f"""new Promise((done) => {{ let left = {count};
            const next = () => left-- > 0 ? requestAnimationFrame(next) : done(true); next(); }})""")

    def key(self, key, text=None):
        for kind in ("keyDown", "keyUp"):
            parameters = {"type": kind, "key": key, "code": key}
            if text and kind == "keyDown":
                parameters["text"] = text
            if key == "Enter":
                parameters["windowsVirtualKeyCode"] = 13
            if key == "Tab":
                parameters["windowsVirtualKeyCode"] = 9
            self.call("Input.dispatchKeyEvent", **parameters)

    def screenshot(self, path, whole=False):
        answer = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole,
                           **({"clip": self._whole()} if whole else {}))
        with open(path, "wb") as file:
            file.write(base64.b64decode(answer["data"]))

    def _whole(self):
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        return {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}

    def pdf(self, path):
        answer = self.call("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
        with open(path, "wb") as file:
            file.write(base64.b64decode(answer["data"]))

    def complaints(self):
        """What went wrong so far: errors, and requests for anything but the page."""
        out = []
        for event in self._browser.events:
            if event.get("sessionId") != self._session:
                continue
            parameters = event["params"]
            if event["method"] == "Runtime.exceptionThrown":
                out.append(str(parameters["exceptionDetails"]))
            if event["method"] == "Runtime.consoleAPICalled" and parameters["type"] in (
                    "error", "warning", "assert"):
                out.append("console: " + str(parameters["args"]))
            if event["method"] == "Log.entryAdded" and parameters["entry"]["level"] in (
                    "error", "warning"):
                out.append("log: " + parameters["entry"]["text"])
            if event["method"] == "Network.requestWillBeSent":
                url = parameters["request"]["url"]
                if url != self.url and not url.startswith(("data:", "blob:")):
                    out.append("request: " + url)
        return out
