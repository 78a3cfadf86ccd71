"""A headless Chromium through chromedriver's W3C WebDriver protocol: only Python's own library is needed."""
import base64
import functools
import json
import os
import shutil
import socket
import subprocess
import tarfile
import tempfile
import time
import urllib.error
import urllib.request

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


def missing():
    """What is not installed, or None."""
    for program in ("chromium", "chromedriver"):
        if not shutil.which(program):
            return program
    return None


@functools.cache
def axe():
    """The rules of accessibility by axe-core, from npm; None where that cannot be had."""
    with tempfile.TemporaryDirectory() as folder:
        if not shutil.which("npm") or subprocess.run(["npm", "pack", "--silent", "axe-core@4.14.1"], cwd=folder, stdout=subprocess.DEVNULL,
                                                     stderr=subprocess.DEVNULL).returncode:
            print("skipped: axe-core cannot be had from npm: contrast and the keyboard's reach are not tried")
            return None
        with tarfile.open(os.path.join(folder, "axe-core-4.14.1.tgz")) as packed:
            return packed.extractfile("package/axe.min.js").read().decode()


class Browser:
    def __init__(self, webgl=True, script=True):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        self.base = f"http://127.0.0.1:{port}"
        arguments = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--disable-background-networking", "--no-first-run", "--window-size=1200,900"]
        if webgl:
            arguments += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
        else:
            arguments += ["--disable-gpu", "--disable-3d-apis"]
        preferences = {} if script else {"profile.managed_default_content_settings.javascript": 2}
        try:
            self.wait_for_driver()
            answer = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
                "goog:chromeOptions": {"args": arguments, "prefs": preferences},
                "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}}})
        except BaseException:
            self.driver.kill()
            raise
        self.session = f"/session/{answer['sessionId']}"

    def wait_for_driver(self):
        for _ in range(200):
            try:
                self.call("GET", "/status")
                return
            except (urllib.error.URLError, ConnectionError):
                time.sleep(0.1)
        raise RuntimeError("chromedriver does not answer")

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=300) as reply:
                return json.load(reply)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].splitlines()[0]) from None

    def ask(self, method, path, body=None):
        return self.call(method, self.session + path, body)

    def open(self, file, query=""):
        """The page once it is loaded: on a busy machine the driver may answer while its scripts still run, or before it is there."""
        self.run("window.left = true")
        self.ask("POST", "/url", {"url": f"file://{os.path.abspath(file)}{query}"})
        self.wait("!window.left && document.readyState === 'complete'")

    def run(self, script, *arguments):
        return self.ask("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, condition, seconds=120):
        """Until the JavaScript expression is true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.run(f"return Boolean({condition})"):
                return
            time.sleep(0.05)
        raise AssertionError(f"never became true: {condition}")

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0])?.innerText ?? null", selector)

    def keys(self, selector, text):
        found = self.ask("POST", "/element", {"using": "css selector", "value": selector})
        self.ask("POST", f"/element/{found[ELEMENT]}/value", {"text": text})

    def log(self, kind):
        return self.ask("POST", "/se/log", {"type": kind})

    def devtools(self, command, **parameters):
        return self.ask("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def look(self, width=1200, height=900, dark=False):
        """From a window of this size, with this preference."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.devtools("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def barriers(self):
        """What keeps people from reading or reaching the page, by axe-core, as text."""
        if not axe():
            return []
        self.run(axe())
        return self.ask("POST", "/execute/async", {"args": [], "script": """
            const done = arguments[arguments.length - 1];
            axe.run({resultTypes: ['violations']}).then(({violations}) => done(violations.flatMap(({id, nodes}) => nodes.map(({target, any}) => `${id}: ${target.join(' ')}: ${any[0]?.message ?? ''}`))))"""})

    def resting_box(self, selector):
        """Where the element is once it has been scrolled to and nothing moves it any more."""
        boxes = []
        while len(boxes) < 4 or any(box != boxes[-1] for box in boxes[-4:]):
            boxes.append(self.run("const e = document.querySelector(arguments[0]);"
                                  "e.scrollIntoView({block: 'center', behavior: 'instant'}); const b = e.getBoundingClientRect();"
                                  "return {x: b.x, y: b.y, width: b.width, height: b.height}", selector))
            time.sleep(0.1)
        return boxes[-1]

    def drag_finger(self, selector, start, end, steps=8):
        """One finger on the screen, from one place to another, as shares of the element's width and height."""
        box = self.resting_box(selector)
        place = [[box["x"] + box["width"] * x, box["y"] + box["height"] * y] for x, y in (start, end)]
        for step in range(steps + 1):
            x, y = (a + (b - a) * step / steps for a, b in zip(*place))
            self.devtools("Input.dispatchTouchEvent", type="touchMove" if step else "touchStart",
                          touchPoints=[{"x": x, "y": y, "id": 1}])
            time.sleep(0.03)
        self.devtools("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def fingers(self, on):
        self.devtools("Emulation.setTouchEmulationEnabled", enabled=on, maxTouchPoints=5)

    def screenshot(self, path, whole=True):
        picture = self.devtools("Page.captureScreenshot", captureBeyondViewport=whole, **(
            {"clip": {**self.size(), "x": 0, "y": 0, "scale": 1}} if whole else {}))
        with open(path, "wb") as out:
            out.write(base64.b64decode(picture["data"]))

    def size(self):
        return self.run("return {width: innerWidth, height: document.documentElement.scrollHeight}")

    def print_pdf(self, path):
        page = self.devtools("Page.printToPDF", printBackground=True, paperWidth=8.27, paperHeight=11.69)
        with open(path, "wb") as out:
            out.write(base64.b64decode(page["data"]))

    def close(self):
        try:
            self.ask("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
