#!/usr/bin/python3
"""Drives scree.html in a headless Chromium: from a dropped scan to the program's own answer.
usage: check.py PROGRAM PAGE [KEEP]
SCREE_SCAN: a scan of one's own that must give the program's bytes too. Screenshots go to the folder KEEP, where given.
Exits 77 where no Chromium is installed, or the page is not there or older than what it is made of."""
import base64
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "report"))
sys.path.insert(0, HERE)
from browser import Browser, missing  # noqa: E402
from tasks import Tasks  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(HERE))
SIZE = 1.5e6  # bytes of the page, at most
MEMORY = 250e6  # bytes of WebAssembly for 762,008 triangles, at most
BLOCKED = 200  # ms of processor time that the page may take for itself at a time


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def stale(page):
    """What the page is made of and is newer, or None."""
    made = os.path.getmtime(page)
    for folder in ("src", "web", "include", "cmake"):
        for path, folders, names in os.walk(os.path.join(ROOT, folder)):
            folders[:] = [name for name in folders if name not in ("node_modules", "npm", "study")]
            for name in names:
                if os.path.getmtime(os.path.join(path, name)) > made:
                    return os.path.relpath(os.path.join(path, name), ROOT)
    return None


def scree(*words, folder, fails=False):
    done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, check=False)
    check((done.returncode != 0) == fails, f"scree {' '.join(words)}: {done.stderr.decode()}")
    return done


def ready(browser):
    browser.open(PAGE)
    browser.wait("document.body?.dataset.ready")
    check(browser.run("return document.body.dataset.ready") == "true", browser.text("#wait"))


def drop(browser, *files):
    """As a hand would: on the page, anywhere. A file comes into the page by an input of the test's own."""
    browser.run("document.querySelector('#test-files')?.remove(); const i = document.createElement('input');"
                "i.type = 'file'; i.id = 'test-files'; i.multiple = true; document.body.append(i)")
    browser.keys("#test-files", "\n".join(files))
    browser.run("const data = new DataTransfer(); for (const f of document.querySelector('#test-files').files) data.items.add(f);"
                "document.querySelector('#test-files').remove();"
                "document.body.dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, dataTransfer: data }))")


def pick(browser, selector, value):
    browser.run("const s = document.querySelector(arguments[0]); s.value = arguments[1];"
                "s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))", selector, value)


def idle(browser, seconds=240):
    browser.wait("document.querySelector('#panel-0').dataset.busy === 'false'", seconds)


def chosen(browser, act, seconds=240):
    """Acts and waits for the choice that comes of it."""
    before = browser.run("return document.body.dataset.chosen ?? '0'")
    act()
    browser.wait(f"document.body.dataset.chosen > {before} || document.querySelector('.error')", seconds)
    idle(browser)
    check(browser.text(".state.error") is None, browser.text(".state"))


def saved(browser, button):
    """What a button saves: its name and its bytes."""
    browser.run("""
      window.kept = null;
      const make = URL.createObjectURL;
      URL.createObjectURL = (blob) => { window.blob = blob; return make.call(URL, blob); };
      HTMLAnchorElement.prototype.click = function () {
        if (!this.download) return;
        URL.createObjectURL = make;
        const reader = new FileReader();
        reader.onload = () => { window.kept = [this.download, reader.result.split(',')[1] ?? '']; };
        reader.readAsDataURL(window.blob);
      };
      document.querySelector(arguments[0]).click();""", button)
    browser.wait("window.kept", 240)
    name, text = browser.run("return window.kept")
    return name, base64.b64decode(text)


def quiet(browser, what):
    """Nothing on the console, and nothing asked for but the page and what it holds."""
    said = [entry["message"] for entry in browser.log("browser") if entry["level"] == "SEVERE"]
    check(not said, f"{what}: the console says {said}")
    for line in browser.log("performance"):
        message = json.loads(line["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            check(url.startswith(("file:", "blob:", "data:")), f"{what}: asked for {url}")


def native_choice(file, folder, *words):
    return scree("choose", os.path.basename(file), "-u", "mm", *words, "--json", folder=folder).stdout


def answer_is_the_programs(browser, folder):
    scree("sample", "fp-1", "--resolution", "1mm", "-o", "fp-1.stl", folder=folder)
    scan = os.path.join(folder, "fp-1.stl")
    drop(browser, scan)
    check("Which unit" in browser.text(".state"), "the unit is not asked for")
    time.sleep(0.3)
    check(browser.run("return document.body.dataset.chosen === undefined"), "a unit is guessed")
    chosen(browser, lambda: pick(browser, "#unit", "mm"))
    check(saved(browser, "#save-choice") == ("choice.json", native_choice(scan, folder)), "choice.json is not the program's")
    answer = json.loads(native_choice(scan, folder))[0]
    check(" ".join(browser.text(".answer").split()).replace("−", "-").startswith(" ".join(answer["answer"])), f"the page answers {browser.text('.answer')}")
    log_is_the_programs(browser, folder, "mm")
    chosen(browser, lambda: pick(browser, "#unit", "inch"))
    log_is_the_programs(browser, folder, "inch")
    chosen(browser, lambda: pick(browser, "#unit", "mm"))
    return scan, answer


def log_is_the_programs(browser, folder, unit):
    told = scree("check", "fp-1.stl", "-u", unit, folder=folder).stdout.decode().splitlines()
    log = browser.run("return document.querySelector('.scans .log').textContent").splitlines()
    mended = scree("repair", "fp-1.stl", "-u", unit, "-o", "closed.ply", "-f", folder=folder).stdout.decode().splitlines()
    check(log[:len(told)] == told[1:] + ["repaired:"] and set(log[len(told):]) <= set(mended),
          f"in {unit} the log says {log}, the program {told} and {mended}")


def another_tolerance(browser, folder, scan):
    """A slider asks anew, and the command line shown asks the program for the same."""
    before = browser.run("return document.body.dataset.shownTriangles")
    chosen(browser, lambda: pick(browser, "[data-error=hausdorff]", 20))
    shown = browser.run("return document.querySelector('.command code').textContent").split()
    tolerance = shown[shown.index("-t") + 1]
    check(saved(browser, "#save-choice")[1] == native_choice(scan, folder, "-t", tolerance), f"-t {tolerance}: not the program's answer")
    check(browser.run("return document.body.dataset.shownTriangles") != before, "another tolerance, and the same level is shown")
    chosen(browser, lambda: pick(browser, "#rule", "paper"))
    check(saved(browser, "#save-choice")[1] == native_choice(scan, folder, "--rule", "paper", "-t", tolerance), "--rule paper: not the program's answer")
    chosen(browser, lambda: browser.run("[...document.querySelectorAll('button')].find((b) => b.textContent === 'Back to the defaults').click()"))


def level_is_taken(browser, folder, answer):
    """Mesh and mass of the level under the slider, in each format."""
    scree("choose", "fp-1.stl", "-u", "mm", "-o", "native", folder=folder)
    count = answer[answer["default"]]["triangle_count"]
    for ending in ("stl", "ply", "obj"):
        pick(browser, "#format", ending)
        name, mesh = saved(browser, "#save-mesh")
        check(name == f"fp-1.{ending}", f"the mesh is called {name}")
        with open(os.path.join(folder, f"page.{ending}"), "wb") as out:
            out.write(mesh)
        told = json.loads(scree("check", f"page.{ending}", "-u", "mm", "--json", folder=folder).stdout)[0]["check"]
        check(told["usable"] and told["triangle_count"] == count, f"the {ending} has {told}")
    with open(os.path.join(folder, "native", "fp-1.stl"), "rb") as file:
        native = file.read()
    with open(os.path.join(folder, "page.stl"), "rb") as file:
        check(file.read()[84:] == native[84:], "the STL has other triangles than the program's")
    pick(browser, "#format", "stl")
    mass = json.loads(saved(browser, "#save-mass")[1])
    with open(os.path.join(folder, "native", "fp-1.mass.json"), encoding="utf-8") as file:
        native = json.load(file)
    for key in ("mass", "inertia", "volume"):
        check(mass.get(key) == native.get(key), f"{key}: {mass.get(key)} here, {native.get(key)} by the program")
    name, report = saved(browser, "#save-report")
    check(name == "report.html" and b"fp-1" in report and report.rstrip().endswith(b"</html>"), "no report")


def clump_is_taken(browser, folder):
    """The clump that the program makes of the file, to the last digit."""
    scree("clump", "fp-1.stl", "-u", "mm", "-o", "clump", folder=folder)
    name, page = saved(browser, "#save-clump")
    idle(browser)
    with open(os.path.join(folder, "clump", "fp-1.csv"), "rb") as file:
        here, native = ([line for line in table.decode().splitlines() if not line.startswith("#")][1:] for table in (page, file.read()))
    check(name == "fp-1.csv" and here == native, f"{name} is not the program's: {len(here)} spheres, {len(native)} of the program, first {here[:1]}, {native[:1]}")
    check(f"{len(here)} spheres" in browser.text(".state"), f"of the clump the page says {browser.text('.state')}")


def broken_files_say_why(browser, folder):
    """The program's sentences, and the page goes on."""
    broken = {"cut.stl": b"solid x\nfacet normal 0 0 0\nouter loop\n", "words.obj": b"v 0 0 zero\n", "open.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
              "empty.stl": b"", "box.3mf": b"PK\3\4" + bytes(40)}
    for name, content in broken.items():
        with open(os.path.join(folder, name), "wb") as out:
            out.write(content)
        sentence = scree("choose", name, "-u", "mm", folder=folder, fails=True).stderr.decode().strip().splitlines()[-1]
        sentence = sentence.removeprefix("scree: ")
        drop(browser, os.path.join(folder, name))
        browser.wait("document.querySelector('.scans li:last-child .error')")
        said = browser.text(".scans li:last-child .error").strip()
        check(said == sentence, f"{name}: the page says {said!r}, the program {sentence!r}")
        idle(browser)
        browser.run("document.querySelector('.scans li:last-child button').click()")
        idle(browser)


def several(browser, folder):
    scree("sample", "sp-1", "--resolution", "1.5mm", "-o", "sp-1.stl", folder=folder)
    chosen(browser, lambda: drop(browser, os.path.join(folder, "sp-1.stl")))
    native = scree("choose", "fp-1.stl", "sp-1.stl", "-u", "mm", "--json", folder=folder).stdout
    check(saved(browser, "#save-choice")[1] == native, "two scans: not the program's answer")


def other_formats_are_read(browser, folder):
    """3MF and glTF, which state their units: the program's verdict of each."""
    scree("simplify", "fp-1.stl", "-u", "mm", "-n", "2000", "-o", "small.stl", folder=folder)
    scree("export", "small.stl", "-u", "mm", "-o", "model.3mf", folder=folder)
    ready(browser)
    pick(browser, "#unit", "mm")
    with open(os.path.join(folder, "model.glb"), "wb") as out:
        out.write(glb_of_a_cube())
    for name in ("model.3mf", "model.glb"):
        verdict = scree("check", name, folder=folder).stdout.decode().splitlines()[0]
        chosen(browser, lambda name=name: drop(browser, os.path.join(folder, name)))
        said = browser.run("return document.querySelector('.scans li:last-child .scan span').textContent")
        check(said.strip() == verdict.removeprefix(f"{name}: "), f"{name}: the page says {said!r}, the program {verdict!r}")
        browser.run("document.querySelector('.scans li:last-child button').click()")
        browser.wait("!document.querySelector('.scans li')")


def glb_of_a_cube():
    """A binary glTF of one cube of a metre, faces gridded so that it can be decimated."""
    steps, points, triangles = 6, [], []
    for axis in range(3):
        for side in (0, 1):
            first = len(points)
            for i in range(steps + 1):
                for j in range(steps + 1):
                    p = [0.0, 0.0, 0.0]
                    p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = float(side), i / steps, j / steps
                    points.append(p)
            for i in range(steps):
                for j in range(steps):
                    a = first + i * (steps + 1) + j
                    b, c, d = a + 1, a + steps + 1, a + steps + 2
                    triangles += [(a, c, d), (a, d, b)] if side else [(a, d, c), (a, b, d)]
    data = b"".join(struct.pack("<3f", *p) for p in points) + b"".join(struct.pack("<3I", *t) for t in triangles)
    text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                       "buffers": [{"byteLength": len(data)}],
                       "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 12 * len(points)},
                                       {"buffer": 0, "byteOffset": 12 * len(points), "byteLength": 12 * len(triangles)}],
                       "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
                                     {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}]}).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(data), len(text), 0x4E4F534A) + text
            + struct.pack("<II", len(data), 0x004E4942) + data)


def sheets_are_filled(browser, folder):
    """A low pyramid without its base, more than a particle may guess: the program names the repair, and a button does it."""
    with open(os.path.join(folder, "open.off"), "w", encoding="utf-8") as out:
        out.write("OFF\n5 4 0\n0 0 0\n20 0 0\n20 20 0\n0 20 0\n10 10 5.5\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n")
    drop(browser, os.path.join(folder, "open.off"))
    browser.wait("document.querySelector('.scans li:last-child .error')")
    idle(browser)
    check("--holes 100%" in browser.text(".scans li:last-child .advice"), "the repair that is advised has no button")
    chosen(browser, lambda: browser.run("document.querySelector('.advice').click()"))
    check("usable" in browser.text(".scans li:last-child .scan"), "it is not repaired")


def work_is_cancelled(browser, folder):
    scree("sample", "dc-1", "--resolution", "0.5mm", "-o", "dc-1.stl", folder=folder)
    drop(browser, os.path.join(folder, "dc-1.stl"))
    browser.wait("document.querySelector('#panel-0').dataset.busy === 'true'")
    browser.run("document.querySelector('#cancel').click()")
    idle(browser)
    check("Cancelled" in browser.text(".state"), f"after Cancel: {browser.text('.state')}")
    chosen(browser, lambda: browser.run("document.querySelector('.scans li:last-child button').click()"))


def pours(browser):
    browser.run("document.querySelector('#tab-1').click()")
    pick(browser, "#pour-count", 20)
    pick(browser, "#pour-triangles", 40)
    pick(browser, "#pour-stiffness", "0.01")
    pick(browser, "#pour-source", "scans")
    # of one scan its count, of several the least and the most
    counts = browser.run("return document.querySelector('.answer').textContent.match(/Use (.*?) triangles/)[1].match(/[0-9,]*[0-9]/g)")
    browser.run("document.querySelector('#pour-start').click()")
    browser.wait("document.querySelector('#panel-1 .legend').textContent || document.querySelector('#pour-state.error')", 120)
    for count in counts:
        check(f"{count} triangles" in browser.text("#panel-1 .legend"), f"{count} triangles were chosen, poured are {browser.text('#panel-1 .legend')}")
    pick(browser, "#pour-source", "samples")
    browser.run("document.body.dataset.pourEntered = 0; document.querySelector('#pour-start').click()")
    browser.wait("document.body.dataset.pourEntered >= 10 || document.querySelector('#pour-state.error')", 120)
    check(browser.text("#pour-state.error") is None, browser.text("#pour-state"))
    if KEEP:
        browser.screenshot(os.path.join(KEEP, "pour.png"))
    browser.run("document.querySelector('#pour-pause').click()")
    time.sleep(0.5)
    at = browser.run("return document.body.dataset.pourTime")
    time.sleep(0.3)
    check(browser.run("return document.body.dataset.pourTime") == at, "the pour goes on while it pauses")
    own_scenes(browser)
    browser.run("document.querySelector('#tab-0').click()")


def own_scenes(browser):
    """A drum goes on turning what is in it; out of a hopper some fall once it is open."""
    for container, setting, until in (("drum", ("#pour-speed", 20), "document.body.dataset.pourTime > 0.8"),
                                      ("hopper", ("#pour-opens", 0.5), "document.body.dataset.pourLeft > 0")):
        pick(browser, "#pour-container", container)
        pick(browser, *setting)
        pick(browser, "#pour-count", 10)
        pick(browser, "#pour-stiffness", "0.1")  # a hundredth is too soft for the fall into the hopper, in one seed of ten
        browser.run("document.body.dataset.pourTime = document.body.dataset.pourLeft = 0; document.querySelector('#pour-start').click()")
        browser.wait(f"{until} || document.querySelector('#pour-state.error')", 200)
        check(browser.text("#pour-state.error") is None, browser.text("#pour-state"))
        check("came in" in browser.text("#pour-state"), f"{container}: {browser.text('#pour-state')}")
        if KEEP:
            browser.screenshot(os.path.join(KEEP, f"{container}.png"))
    browser.run("document.querySelector('#pour-pause').click()")


def answer_comes_first(browser):
    """On a telephone the sample's answer and all that follows take less than two screens, and nothing is cut; one
    distance is told of one level."""
    browser.look(width=400, height=844)
    ready(browser)
    chosen(browser, lambda: browser.run("document.querySelector('#sample').click()"))
    browser.wait("document.body.dataset.largestDistance")
    wide, high = browser.run("return [document.documentElement.scrollWidth, document.documentElement.scrollHeight]")
    check(wide <= 400 and high <= 2 * 844, f"the page is {wide} wide and {high} high on a screen of 400 by 844")
    mean = re.search(r"surface (\S+) mm off in the mean", browser.text(".answer"))[1]
    check(f"mean {mean} mm" in browser.text(".view + .view figcaption"),
          f"the answer has a mean of {mean} mm, below the level stands {browser.text('.view + .view figcaption')}")
    check(browser.text("main").count("How this was made") == 1, "how it was made is not told")
    browser.look()


def pictures(browser):
    for name, how in (("desktop", {}), ("phone", {"width": 390, "height": 844}), ("dark", {"width": 900, "dark": True})):
        browser.look(**how)
        time.sleep(0.6)
        wide = browser.run("return document.documentElement.scrollWidth - innerWidth")
        check(wide <= 0, f"{name}: the page is {wide} pixels wider than the window")
        barriers = browser.barriers()
        check(not barriers, f"{name}: {barriers}")
        if KEEP:
            browser.screenshot(os.path.join(KEEP, f"{name}.png"))
    browser.look()


def own_scan(browser, scan, folder):
    """A large one: the program's bytes, within the memory."""
    os.symlink(os.path.abspath(scan), os.path.join(folder, "scan.stl"))
    ready(browser)
    pick(browser, "#unit", "mm")
    begin = time.monotonic()
    with Tasks(browser) as tasks:
        chosen(browser, lambda: drop(browser, os.path.join(folder, "scan.stl")), 600)
        taken = time.monotonic() - begin
        browser.wait("document.body.dataset.largestDistance", 120)
    print(f"own scan: {taken:.1f} s to the number, {int(browser.run('return document.body.dataset.memory')) / 1e6:.0f} MB, "
          f"at most {tasks.longest():.0f} ms of the page's own at a time")
    check(saved(browser, "#save-choice")[1] == native_choice("scan.stl", folder), "the scan's choice.json is not the program's")
    check(tasks.longest() <= BLOCKED, f"the page blocked for {tasks.longest():.0f} ms")
    check(int(browser.run("return document.body.dataset.memory")) <= MEMORY, "more memory than allowed")


def main():
    what = missing()
    if what:
        print(f"skipped: no {what} installed")
        return 77
    if not os.path.exists(PAGE):
        print("skipped: no page: `make page` makes it")
        return 77
    newer = stale(PAGE)
    if newer:
        print(f"skipped: {newer} is newer than the page: `make page` makes it anew")
        return 77
    check(os.path.getsize(PAGE) <= SIZE, f"the page has {os.path.getsize(PAGE)} bytes")
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        ready(browser)
        with Tasks(browser) as tasks:
            scan, answer = answer_is_the_programs(browser, folder)
            another_tolerance(browser, folder, scan)
        check(tasks.longest() <= BLOCKED, f"the page blocked for {tasks.longest():.0f} ms")
        level_is_taken(browser, folder, answer)
        clump_is_taken(browser, folder)
        pictures(browser)
        broken_files_say_why(browser, folder)
        several(browser, folder)
        work_is_cancelled(browser, folder)
        pours(browser)
        other_formats_are_read(browser, folder)
        sheets_are_filled(browser, folder)
        answer_comes_first(browser)
        quiet(browser, "the page")
        if os.environ.get("SCREE_SCAN"):
            own_scan(browser, os.environ["SCREE_SCAN"], folder)
            quiet(browser, "a large scan")
    return 0


PROGRAM = os.path.abspath(sys.argv[1])
PAGE = os.path.abspath(sys.argv[2])
KEEP = sys.argv[3] if len(sys.argv) > 3 else None
if __name__ == "__main__":
    sys.exit(main())
