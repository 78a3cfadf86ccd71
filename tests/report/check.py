#!/usr/bin/python3
"""Loads reports in a headless Chromium, moves the slider, reads what is shown. usage: check.py PROGRAM [KEEP]
Screenshots and the printed page go to the folder KEEP, where given. Exits 77 where no Chromium is installed."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser, missing  # noqa: E402

HOSTILE = "<script>alert(1)<'&\" --><b>"  # a file's name


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def scree(*words, folder):
    done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"scree {' '.join(words)}: {done.stderr}")
    return done.stdout


def ready(browser, page):
    browser.open(page)
    browser.wait("document.body.dataset.ready")
    check(browser.run("return document.body.dataset.ready") == "true", browser.text("#wait"))


def unfolded(browser, page):
    ready(browser, page)
    browser.run("document.querySelectorAll('details').forEach((part) => { part.open = true; })")


NUMBER = re.compile(r"(?<![\w.-])[+−-]?\d[\d,]*(?:\.\d+)?(?:e-?\d+)?(?![\w])")


def numbers_of(value):
    """All numbers of a result but those of single runs, samples and moments."""
    if isinstance(value, dict):
        return [n for key, part in value.items() if key not in ("samples", "all_runs", "history", "columns", "levels") for n in numbers_of(part)]
    if isinstance(value, list):
        return [n for part in value for n in numbers_of(part)] + [len(value)]
    return [value] if isinstance(value, (int, float)) and not isinstance(value, bool) else []


def says_what_the_file_says(browser, told, numbers):
    """The heading is the file's sentence, and each number in it one of the file's, in its digits: itself, in mm, as half of a 90 % interval."""
    heading = browser.text("h1")
    as_shown = re.sub(r"(\d) deg\b", r"\1°", told["sentence"].replace(" +- ", " ± "))
    check(heading.replace("−", "-") == as_shown, f"the page says {heading}, the file {told['sentence']}")
    check(browser.text(".state")[2:].lower() == told["state"].lower(), f"the state is {browser.text('.state')}")
    for token in NUMBER.findall(as_shown.replace("90 %", "")):
        value, digits = float(token.replace(",", "").replace("−", "-")), len(token.partition(".")[2].partition("e")[0])
        close = [n for n in numbers for scale in (1, 1000, 100, 1.645) if abs(abs(value) - abs(scale * n)) <= 0.51 * 10 ** -digits]
        check(close, f"{token} of {told['sentence']!r} is no number of the file")


def has_the_skeleton(browser, page, name):
    """At 1,400 pixels the first screen holds answer, picture and numbers, no page is long, nothing sticks out; the same numbers at 400."""
    browser.look(width=1400, height=900)
    ready(browser, page)
    time.sleep(0.5)
    end, height, tiles, pictures_there = browser.run("""
      const hero = document.querySelector('.hero');
      return [hero.getBoundingClientRect().bottom + scrollY, document.documentElement.scrollHeight, document.querySelectorAll('.tile').length, hero.querySelectorAll('svg, canvas, img').length];""")
    check(end <= 900, f"{name}: answer, picture and numbers end at {end} pixels")
    check(height <= 2500, f"{name}: the page has {height} pixels")
    check(tiles <= 8 and pictures_there, f"{name}: {tiles} numbers, {pictures_there} pictures")
    parts = browser.run("return ['.line', '.state', 'h1', '.hero', '.texts'].map((q) => { const e = document.querySelector(q); return e ? e.getBoundingClientRect().top : -1 })")
    check(parts == sorted(parts) or parts[-1] == 0, f"{name}: the parts are in another order: {parts}")
    pictures(browser, f"{name}-wide", width=1400)
    pictures(browser, f"{name}-narrow", width=400, height=844)
    least = browser.run("""
      return Math.min(...[...document.querySelectorAll('.plot')].filter((e) => e.checkVisibility()).flatMap((plot) => {
        const scale = plot.getBoundingClientRect().width / plot.viewBox.baseVal.width;
        return [...plot.querySelectorAll('text')].map((text) => scale * parseFloat(getComputedStyle(text).fontSize));
      }), 99);""")
    check(least >= 10, f"{name}: a text of a chart has {least} pixels on a telephone")
    pictures(browser, f"{name}-dark", width=800, dark=True)
    browser.look()
    no_complaints(browser, name)


def no_complaints(browser, what):
    """Nothing on the console, and no address asked for but the file's own."""
    said = [entry["message"] for entry in browser.log("browser") if entry["level"] == "SEVERE"]
    check(not said, f"{what}: the console says {said}")
    asked = [line["message"] for line in browser.log("performance") if '"Network.requestWillBeSent"' in line["message"]]
    check(not any('"url":"http' in line for line in asked), f"{what}: asked a network for something")


def shown(browser):
    return int(browser.run("return document.body.dataset.shownTriangles"))


def painted(browser, view):
    """Colours in a 3D view: the picture is drawn onto a small canvas and read."""
    return browser.run("""
      const view = document.querySelectorAll('.view canvas')[arguments[0]];
      const copy = document.createElement('canvas');
      copy.width = copy.height = 64;
      const context = copy.getContext('2d');
      context.drawImage(view, 0, 0, 64, 64);
      const { data } = context.getImageData(0, 0, 64, 64);
      const colors = new Set();
      let covered = 0;
      for (let i = 0; i < data.length; i += 4) {
        if (data[i + 3] > 128) covered++, colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
      }
      return { covered, colors: colors.size, sum: data.reduce((a, b) => a + b, 0) };""", view)


def whole_in_view(browser, view):
    """Whether something is drawn, and nothing opaque on the rim of the 3D view."""
    return browser.run("""
      const view = document.querySelectorAll('.view canvas')[arguments[0]];
      const copy = document.createElement('canvas');
      const [width, height] = [copy.width = view.width, copy.height = view.height];
      const context = copy.getContext('2d');
      context.drawImage(view, 0, 0);
      const opaque = (...box) => context.getImageData(...box).data.some((v, i) => i % 4 === 3 && v > 200);
      return opaque(0, 0, width, height) && !opaque(0, 0, width, 2) && !opaque(0, height - 2, width, 2)
        && !opaque(0, 0, 2, height) && !opaque(width - 2, 0, 2, height);""", view)


def redrawn(browser, view, before, what):
    """The view's new picture; a loaded machine takes its time with keys."""
    end = time.monotonic() + 20
    while (now := painted(browser, view))["sum"] == before["sum"]:
        check(time.monotonic() < end, what)
        time.sleep(0.1)
    return now


def slide(browser, row):
    browser.run("const s = document.querySelector('.slider'); s.value = arguments[0];"
                "s.dispatchEvent(new Event('input'))", row)
    browser.wait("document.querySelector('.level-text').innerText.startsWith("
                 "Number(document.body.dataset.shownTriangles).toLocaleString('en'))")


def slider_drives_the_mesh(browser):
    start, picture = shown(browser), painted(browser, 1)
    check(f"Use {start:,} triangles" in browser.text(".answer"), "the slider does not begin at the answer")
    check(picture["covered"] > 400 and picture["colors"] > 5, f"no mesh to be seen: {picture}")
    slide(browser, 0)
    coarse = painted(browser, 1)
    check(shown(browser) < start and coarse["sum"] != picture["sum"], "the slider does not change the mesh")
    last = int(browser.run("return document.querySelector('.slider').max"))
    before = shown(browser)
    for row in range(last // 4, last + 1, last // 4):
        slide(browser, row)
        check(shown(browser) > before, "levels do not grow along the slider")
        before = shown(browser)
    browser.keys(".slider", "\ue012")  # arrow left
    browser.wait(f"Number(document.body.dataset.shownTriangles) < {before}")
    browser.run("[...document.querySelectorAll('button')].find(b => b.innerText === 'Chosen').click()")
    browser.wait(f"document.body.dataset.shownTriangles == {start}")


def views_obey(browser):
    before = painted(browser, 1), painted(browser, 0)
    browser.keys(".view + .view canvas", "\ue012\ue012\ue013")
    redrawn(browser, 1, before[0], "arrow keys do not turn the view")
    redrawn(browser, 0, before[1], "the scan does not turn with the level")
    wired = painted(browser, 1)
    browser.run("document.querySelector('[data-key=wire]').click()")
    check(painted(browser, 1)["sum"] != wired["sum"], "edges cannot be switched off")
    browser.wait("document.body.dataset.largestDistance")
    far = []
    for row in (0, 150):
        slide(browser, row)
        browser.wait("document.body.dataset.largestDistance")
        far.append(float(browser.run("return document.body.dataset.largestDistance")))
    check(far[0] > 3 * far[1], f"coarse levels are not further off: {far} mm")
    check(browser.run("return document.querySelector('.scale').innerText.includes('mm')"), "no scale to the colours")


def tables_are_saved(browser):
    saved = browser.run("""
      const texts = [];
      const make = URL.createObjectURL;
      URL.createObjectURL = (blob) => (texts.push(blob.text()), make.call(URL, blob));
      const click = HTMLAnchorElement.prototype.click;
      HTMLAnchorElement.prototype.click = () => {};
      document.querySelectorAll('button.save').forEach((button) => button.click());
      HTMLAnchorElement.prototype.click = click;
      URL.createObjectURL = make;
      return Promise.all(texts);""")
    check(len(saved) == browser.run("return document.querySelectorAll('table').length + 1"), "a table without CSV")
    for text in saved:
        rows = text.split("\r\n")
        check(len(rows) > 2 and rows[-1] == "", "CSV without rows")
    check(any(row.startswith('"robust') for text in saved for row in text.split("\r\n")), "no candidates in the CSV")


def fingers_do(browser, slider, view, shown_as):
    """On a phone: one finger on the slider moves it, one on the 3D view turns it; the page does not scroll meanwhile."""
    browser.look(width=390, height=844)
    browser.fingers(True)
    browser.wait("innerWidth == 390 && [...document.querySelectorAll('.plot')].every((e) => e.getBoundingClientRect().width < 390)")
    before = float(browser.run(f"return document.body.dataset.{shown_as}"))
    browser.run("const s = document.querySelector(arguments[0]); s.value = 0; s.dispatchEvent(new Event('input'))", slider)
    browser.wait(f"Number(document.body.dataset.{shown_as}) < {before}")
    before = float(browser.run(f"return document.body.dataset.{shown_as}"))
    browser.drag_finger(slider, (0.02, 0.5), (0.7, 0.5))
    browser.wait(f"Number(document.body.dataset.{shown_as}) > {before}")
    share = float(browser.run("const s = document.querySelector(arguments[0]); return s.value / s.max", slider))
    check(0.5 < share < 0.9, f"the slider is not where the finger left it: {share}")
    index = browser.run("return [...document.querySelectorAll('.view canvas')].indexOf(document.querySelector(arguments[0]))", view)
    seen = painted(browser, index)
    browser.resting_box(view)
    top = browser.run("return scrollY")
    browser.drag_finger(view, (0.3, 0.5), (0.8, 0.3))
    redrawn(browser, index, seen, "a finger does not turn the view")
    check(browser.run("return scrollY") == top, "the page scrolls under the finger that turns the view")
    browser.fingers(False)
    browser.look()
    browser.wait("innerWidth == 1200")


def pictures(browser, name, **how):
    """The page from another window: nothing sticks out, all can be read and reached; screenshot and print where asked for."""
    browser.look(**how)
    browser.wait(f"innerWidth == {how.get('width', 1200)}")
    time.sleep(0.4)  # the curve is drawn anew a little after the size has changed
    try:
        browser.wait("document.documentElement.scrollWidth <= innerWidth", 10)
    except AssertionError:
        wide = browser.run("return document.documentElement.scrollWidth - innerWidth")
        raise AssertionError(f"{name}: the page is {wide} pixels wider than the window") from None
    barriers = browser.barriers()
    check(not barriers, f"{name}: {barriers}")
    if KEEP:
        browser.screenshot(os.path.join(KEEP, f"{name}.png"))
        browser.print_pdf(os.path.join(KEEP, f"{name}.pdf"))


def one_object(browser, folder):
    scree("choose", "sample:sp-1", "--resolution", "1.5mm", "-o", "one", folder=folder)
    page = os.path.join(folder, "one", "report.html")
    scree("report", "one", "-o", "again.html", folder=folder)
    with open(page, "rb") as a, open(os.path.join(folder, "again.html"), "rb") as b:
        check(a.read() == b.read(), "report makes another page than choose")
    ready(browser, page)
    slider_drives_the_mesh(browser)
    views_obey(browser)
    tables_are_saved(browser)
    fingers_do(browser, ".slider", ".view + .view canvas", "shownTriangles")
    no_complaints(browser, "one object")
    pictures(browser, "light")
    pictures(browser, "phone", width=390, height=844)
    pictures(browser, "dark", width=800, dark=True)
    browser.look()
    return page


def several_objects(browser, folder):
    scree("sample", "icosphere-5", "-o", "ball.stl", folder=folder)
    shutil.move(os.path.join(folder, "ball.stl"), os.path.join(folder, HOSTILE + ".stl"))
    scree("choose", HOSTILE + ".stl", "sample:fp-1", "--resolution", "1.5mm", "-o", "two", folder=folder)
    ready(browser, os.path.join(folder, "two", "report.html"))
    check(HOSTILE in browser.text("main"), "the hostile name is not shown as it is")
    check(browser.run("return document.querySelectorAll('b').length") == 0, "a name became markup")
    check(shown(browser) > 0, "no mesh for the hostile name")
    first = browser.text(".object-name")
    browser.run("document.querySelectorAll('.objects button')[1].click()")
    check(browser.text(".object-name") not in (first, None), "the second object cannot be picked")
    no_complaints(browser, "two objects")
    pictures(browser, "two")
    scree("report", "one", "two", "-o", "both.html", folder=folder)
    ready(browser, os.path.join(folder, "both.html"))
    check(browser.text("main").count("How this was made") == 2, "a page of two folders lacks one")


def the_set_is_the_text_s(browser, folder):
    """The headline of several objects says what choice.txt says: of all of them, by either rule."""
    scree("sample", "sphere", "--resolution", "2mm", "-o", "sphere.stl", folder=folder)
    scree("sample", "fp-1", "dc-1", "sp-1", "--resolution", "1.5mm", "-o", "scans", folder=folder)
    for name, words in (("floor", ("scans/fp-1.stl", "scans/sp-1.stl", "sphere.stl", "--weight", "20")),
                        ("paper", ("scans/fp-1.stl", "scans/dc-1.stl", "scans/sp-1.stl", "--paper"))):
        scree("choose", *words, "-o", name, folder=folder)
        ready(browser, os.path.join(folder, name, "report.html"))
        page = " ".join(browser.text(".answer").split()).replace("−", "-")
        with open(os.path.join(folder, name, "choice.txt"), encoding="utf-8") as file:
            text = file.read()
        check(all(sentence + "." in text for sentence in page.rstrip(".").split(". ")),
              f"{name}: the page says {page}, the text {text}")


def pyramid(file, width, height):
    """An STL in text of a square pyramid that stands on its base, every face split in many."""
    half, steps = width / 2, 8
    ring = [(-half, -half), (half, -half), (half, half), (-half, half)]
    base = [((0, 0, 0), (*ring[(k + 1) % 4], 0), (*ring[k], 0)) for k in range(4)]

    def at(k, step):
        return (*(x * (1 - step / steps) for x in ring[k % 4]), height * step / steps)
    sides = [face for k in range(4) for i in range(steps) for face in (
        (at(k, i), at(k + 1, i), at(k, i + 1)), *([(at(k + 1, i), at(k + 1, i + 1), at(k, i + 1))] if i + 1 < steps else []))]
    with open(file, "w", encoding="utf-8") as out:
        out.write("solid pyramid\n")
        for face in base + sides:
            out.write("facet normal 0 0 0\nouter loop\n" + "".join("vertex %.9g %.9g %.9g\n" % corner for corner in face) + "endloop\nendfacet\n")
        out.write("endsolid pyramid\n")


def long_bodies_are_whole(browser, folder):
    """However long the body and narrow the panel, the view shows all of it at first, and where it is turned back."""
    pyramid(os.path.join(folder, "long.stl"), 10, 100)
    pyramid(os.path.join(folder, "flat.stl"), 100, 6)
    scree("choose", "--unit", "mm", "long.stl", "flat.stl", "-o", "long", folder=folder)
    scree("drop", "sphere:20mm=3", "--container", "cylinder", "-w", "22mm", "--time", "0.5", "-o", "column", folder=folder)
    for width in (1200, 390):
        browser.look(width=width, height=844)
        ready(browser, os.path.join(folder, "long", "report.html"))
        for button in range(2):
            browser.run("document.querySelectorAll('.objects button')[arguments[0]].click()", button)
            for view in range(2):
                browser.wait(f"document.querySelectorAll('.view canvas')[{view}].clientWidth < {width}")
                check(whole_in_view(browser, view), f"view {view} of object {button} is cut off in a window of {width}")
        browser.keys(".view + .view canvas", "++++++++")
        check(not whole_in_view(browser, 1), "plus does not move nearer")
        browser.keys(".view + .view canvas", "0")
        check(whole_in_view(browser, 1), "0 does not turn back")
        ready(browser, os.path.join(folder, "column", "report.html"))
        browser.wait("document.body.dataset.shownTime > 0.13")  # it plays, to its end at 0.14 s
        check(whole_in_view(browser, 0), f"a pour is cut off in a window of {width}")
    browser.look()


def one_level_is_said(browser, folder):
    """A scan that cannot be reduced: no empty curve, and the next object has its own."""
    with open(os.path.join(folder, "tetrahedron.off"), "w", encoding="utf-8") as file:
        file.write("OFF\n4 4 0\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n")
    scree("sample", "icosphere-3", "-o", "reducible.stl", folder=folder)
    scree("choose", "--unit", "mm", "tetrahedron.off", "reducible.stl", "-o", "single", folder=folder)
    ready(browser, os.path.join(folder, "single", "report.html"))
    drawn = "return [...document.querySelectorAll('.curves .plot, .slider')].filter((e) => e.checkVisibility()).length"
    said = "The scan has one level only"
    check(said in browser.text("main") and browser.run(drawn) == 0, "a single level is drawn as a curve")
    check(shown(browser) == 4 and whole_in_view(browser, 1), "the single level is not to be seen")
    browser.run("document.querySelectorAll('.objects button')[1].click()")
    check(said not in browser.text("main") and browser.run(drawn) >= 2, "an object after that of one level has no curve")
    no_complaints(browser, "one level")


def a_large_page(browser, folder):
    """Folders that are too much for one page: scans, then levels are left out, and that is said."""
    scree("choose", "sample:dc-1", "--resolution", "0.45mm", "-o", "many/1", folder=folder)
    for i in range(2, 7):
        shutil.copytree(os.path.join(folder, "many", "1"), os.path.join(folder, "many", str(i)))
    os.remove(os.path.join(folder, "many", "1", "report.html"))
    scree("report", "many", "-o", "many.html", folder=folder)
    page = os.path.join(folder, "many.html")
    check(os.path.getsize(page) < 6e6, f"the page has {os.path.getsize(page)} bytes")
    ready(browser, page)
    text = browser.text("main")
    check("the finest that fits into this page" in text, "a scan is left out, and nothing is said")
    check(text.count("are not in this page, which would grow too large") >= 1, "levels are left out, and nothing is said")
    check(text.count("How this was made") == 6, "a folder is missing")
    check(painted(browser, 0)["covered"] > 300, "no level stands in for the scan")
    no_complaints(browser, "a large page")


def seek(browser, moment):
    browser.run("const s = document.querySelector('.time'); s.value = arguments[0]; s.dispatchEvent(new Event('input'))", moment)
    return float(browser.run("return document.body.dataset.shownTime")), int(browser.run("return document.body.dataset.shownBodies"))


def begins_and_plays(browser):
    """A scene's page begins at the start and plays by itself; answers the end's time and bodies."""
    browser.wait("Number(document.body.dataset.shownTime) > 0")
    return seek(browser, int(browser.run("return document.querySelector('.time').max")))


def a_heap(browser, folder):
    scree("repose", "sample:fp-1", "sample:sp-1", "--resolution", "3mm", "-r", "1e-2", "--particles", "24", "--pack-time", "1", "--cylinder", "0.2", "--angles", "0.1",
          "--settle-time", "0.2", "--lift-time", "1.5", "--hold-time", "0.3", "--drop-height", "0.05", "-o", "heap", folder=folder)
    page = os.path.join(folder, "heap", "report.html")
    with open(os.path.join(folder, "heap", "result.json"), encoding="utf-8") as file:
        result = json.load(file)
    ready(browser, page)
    text = browser.text("main")
    for part in ("No angle yet", "would do", "of a processor", "fp-1", "Energy of motion", "How this was made"):
        check(part in text, f"the heap does not say: {part}")
    check("Where the angle comes from" not in text and "°" not in text, "so few particles have an angle")
    end, count = seek(browser, int(browser.run("return document.querySelector('.time').max")))
    check(abs(end - result["time"]) < 1e-9 and count == result["book"]["inside_count"], "the slider does not go to the end")
    last = painted(browser, 0)
    check(last["covered"] > 40 and last["colors"] > 5, f"no heap to be seen: {last}")
    check(browser.run("return document.querySelectorAll('body > img').length") == 0, "the picture is shown beside the 3D view")
    start = seek(browser, 0)
    check(start[0] == 0 and start[1] < count and "inside" in browser.text(".level-text"), f"the slider does not go to the start: {start}")
    redrawn(browser, 0, last, "the slider does not change the view")
    before = -1
    for moment in range(0, int(browser.run("return document.querySelector('.time').max")) + 1, 20):
        time_then, _ = seek(browser, moment)
        check(time_then > before, "time does not grow along the slider")
        before = time_then
    browser.keys(".time", "\ue012")  # arrow left
    browser.wait(f"Number(document.body.dataset.shownTime) != {before}")
    at = browser.run("return document.body.dataset.shownTime")
    browser.run("const plot = [...document.querySelectorAll('.plot')].find((p) => p.getAttribute('aria-label').startsWith('Energy'));"
                "plot.dispatchEvent(new PointerEvent('pointermove', { clientX: plot.getBoundingClientRect().left + 80 }));"
                "plot.dispatchEvent(new MouseEvent('click'))")
    check(browser.run("return document.body.dataset.shownTime") != at, "a click on a curve does not go to its moment")
    check(browser.run("return document.querySelectorAll('.cur').length") > 1, "the moment is not marked in all charts")
    seek(browser, int(browser.run("return document.querySelector('.time').max")))  # disc and cylinder alone are round
    turned = painted(browser, 0)
    browser.keys(".pile canvas", "\ue012\ue013")
    redrawn(browser, 0, turned, "arrow keys do not turn the heap")
    seek(browser, 0)
    browser.keys(".pile canvas", " ")  # plays
    browser.wait("document.querySelector('.play').innerText === 'Pause'")
    browser.wait("Number(document.body.dataset.shownTime) > 0.2")
    browser.keys(".pile canvas", " ")
    browser.wait("document.querySelector('.play').innerText === 'Play'")
    stopped = browser.run("return document.body.dataset.shownTime")
    time.sleep(0.3)
    check(browser.run("return document.body.dataset.shownTime") == stopped, "it does not stop")
    browser.run("document.querySelector('select').value = '4'; document.querySelector('select').dispatchEvent(new Event('change'))")
    browser.run("document.querySelector('.play').click()")
    browser.wait(f"Number(document.body.dataset.shownTime) == {end}")
    check(browser.text(".play") == "Play", "it does not end")
    seek(browser, 0)
    browser.run("dispatchEvent(new Event('beforeprint'))")
    check(float(browser.run("return document.body.dataset.shownTime")) == end, "print does not show the end")
    browser.run("dispatchEvent(new Event('afterprint'))")
    fingers_do(browser, ".time", ".pile canvas", "shownTime")
    no_complaints(browser, "a heap")
    pictures(browser, "heap")
    pictures(browser, "heap-phone", width=390, height=844)
    pictures(browser, "heap-dark", width=800, dark=True)
    browser.look()
    browser.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    seek(browser, 0)
    browser.run("document.querySelector('.play').click()")
    browser.wait("Number(document.body.dataset.shownTime) > 0")
    moments = browser.run("return [document.querySelector('.time').value, document.body.dataset.shownTime]")
    browser.run("document.querySelector('.play').click()")
    check(seek(browser, int(moments[0]))[0] == float(moments[1]), "with less motion wanted it plays between moments")
    browser.devtools("Emulation.setEmulatedMedia", features=[])
    scree("repose", "sample:fp-1", "--resolution", "3mm", "-r", "1e-2", "--spheres", "--particles", "8", "--pack-time", "0.2",
          "--settle-time", "0.1", "--lift-time", "0.3", "--hold-time", "0.1", "--drop-height", "0.05", "--no-picture", "-o", "levels", folder=folder)
    ready(browser, os.path.join(folder, "levels", "report.html"))
    check(browser.text("main").count("How this was made") == 2, "a page of two levels lacks one")
    return page


def a_pour(browser, folder):
    scree("drop", "sample:fp-1=5", "sphere:30mm=4", "--resolution", "3mm", "-n", "60", "--container", "box", "-w", "230mm", "--time", "0.3",
          "--frames", "0", "-o", "pour", folder=folder)
    page = os.path.join(folder, "pour", "report.html")
    with open(os.path.join(folder, "pour", "result.json"), encoding="utf-8") as file:
        pour = json.load(file)
    with open(os.path.join(folder, "pour", "series.csv"), encoding="utf-8") as file:
        check(len(file.readlines()) == 2 + len(pour["columns"][0]["values"]), "result.json has other moments than series.csv")
    ready(browser, page)
    text = browser.text("main")
    for part in ("drop into a box", "9 particles came in", "Energy of motion", "How this was made"):
        check(part in text, f"the pour does not say: {part}")
    end, _ = begins_and_plays(browser)
    check(abs(end - pour["time"]) < 1e-9, "the slider does not go to the end")
    check(int(browser.run("return document.body.dataset.shownBodies")) == 9, "a particle is missing")
    last = painted(browser, 0)
    check(last["covered"] > 100 and last["colors"] > 5, f"no pour to be seen: {last}")
    start = seek(browser, 0)
    check(start[0] == 0 and start[1] < 9, f"the slider does not go to the start: {start}")
    redrawn(browser, 0, last, "the slider does not change the view")
    check(browser.run("return document.querySelectorAll('.grid .plot').length") == 3, "a curve is missing")
    no_complaints(browser, "a pour")
    pictures(browser, "pour")
    pictures(browser, "pour-phone", width=390, height=844)
    browser.look()
    return page


MACHINE = """
title: A bin
time: 0.6
materials: {m: {young: 1e6, density: 1500, restitution: 0.2, friction: 0.4}}
shapes: {grain: {material: m, size: {distribution: [[8 mm, 0.5], [14 mm, 0.5]]}}, brick: {box: [0.01, 0.012, 0.016], material: m}}
geometry: {bin: {file: bin.obj, unit: m, material: m}}
inlets: {i: {box: {min: [-0.04, -0.04, 0.02], max: [0.04, 0.04, 0.2]}, shapes: {grain: 1, brick: 1}, count: 60}}
domain: {min: [-1, -1, -1], max: [1, 1, 1]}
sensors: {load: {wall: bin, from: 0.3}}
output: {series: 0.02, motion: 0.02}
"""


def choose(browser, label, text):
    """Picks an option by its text; answers what there are."""
    return browser.run("""
      const choice = [...document.querySelectorAll('.controls label')].find((l) => l.textContent.startsWith(arguments[0])).querySelector('select');
      const options = [...choice.options].map((o) => o.textContent);
      choice.value = options.indexOf(arguments[1]);
      choice.dispatchEvent(new Event('change'));
      return options;""", label, text)


def a_machine(browser, folder):
    """A bin without a lid, split into squares: colours of particles and walls with their legends, the cut, the table of sensors."""
    side, n = 0.1, 5
    faces = [((0, 0, 0), (1, 0, 0), (0, 1, 0))] + [((0, 0, 0), (1, 0, 0), (0, 0, 1)), ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
                                                   ((0, 0, 0), (0, 1, 0), (0, 0, 1)), ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    with open(os.path.join(folder, "bin.obj"), "w", encoding="utf-8") as file:
        count = 0
        for origin, u, v in faces:
            for i in range(n):
                for j in range(n):
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        x, y, z = (side * (o + (a * p + b * q) / n) for o, p, q in zip(origin, u, v))
                        file.write(f"v {x - side / 2} {y - side / 2} {z}\n")
                    file.write(f"f {count + 1} {count + 2} {count + 3}\nf {count + 1} {count + 3} {count + 4}\n")
                    count += 4
    with open(os.path.join(folder, "bin.yaml"), "w", encoding="utf-8") as file:
        file.write(MACHINE)
    scree("run", "bin.yaml", "-o", "bin", "--no-picture", folder=folder)
    unfolded(browser, os.path.join(folder, "bin", "report.html"))
    begins_and_plays(browser)
    check(choose(browser, "Particles by", "shape") == ["shape", "class", "speed", "time since it came in", "size"], "a colouring is missing")
    check(choose(browser, "Walls by", "nothing, seen through")[1:] == ["pressure", "shear", "wear"], "a map is missing, or one that is empty is offered")
    check(browser.text(".ruler").endswith(" mm"), "there is no scale bar")
    for label, text, legend in (("Particles by", "class", "grain"), ("Particles by", "speed", "speed / m/s: 0"), ("Particles by", "size", "size / mm: 8"),
                                ("Particles by", "time since it came in", "time since it came in / s"), ("Walls by", "pressure", "pressure / Pa: 0"), ("Walls by", "wear", "wear / J/m2")):
        before = painted(browser, 0)
        choose(browser, label, text)
        redrawn(browser, 0, before, f"{label} {text} changes nothing")
        check(legend in browser.text(".legend"), f"the legend of {text} says {browser.text('.legend')}")
    for i in range(2):  # the walls alone, then the particles too
        before = painted(browser, 0)
        browser.run("const [range, box] = document.querySelectorAll('.controls input'); if (arguments[0]) box.click(); else { range.value = 0.6; range.dispatchEvent(new Event('input')); }", i)
        redrawn(browser, 0, before, "the cut shows nothing new")
    text = browser.text("main")
    for part in ("load: highest pressure", "from 0.3 s on", "Zero throughout", "sd"):
        check(part in text, f"the table does not say: {part}")
    check(browser.run("return document.querySelectorAll('td svg polyline').length") > 5, "the table has no curves")
    then = browser.run("return document.querySelector('tbody td:nth-child(3)').textContent")
    seek(browser, 5)
    check(browser.run("return document.querySelector('tbody td:nth-child(3)').textContent") != then, "the table does not follow the time")
    no_complaints(browser, "a machine")
    pictures(browser, "machine")
    pictures(browser, "machine-phone", width=400, height=844)
    browser.look()
    with open(os.path.join(folder, "fall.yaml"), "w", encoding="utf-8") as file:
        file.write("time: 0.4\nshapes: {ball: {sphere: 0.01}}\ninlets: {i: {box: {min: [0, 0, 0.2], max: [0.2, 0.2, 0.4]}, shapes: ball, count: 20}}\n"
                   "outlets: {o: {box: {min: [-1, -1, -2], max: [1, 1, 0]}}}\ndomain: {min: [-1, -1, -2], max: [1, 1, 1]}\nsensors: {stay: {residence: {bins: 5}}}\n")
    scree("run", "fall.yaml", "-o", "fall", "--no-picture", folder=folder)
    ready(browser, os.path.join(folder, "fall", "report.html"))
    check("stay.histogram" in browser.text("main"), "the residence times are not drawn")


def a_real_study(browser, folder):
    with open(os.path.join(folder, "small.yaml"), "w", encoding="utf-8") as file:
        file.write("name: small\nshapes: [sample:fp-1]\nsample: {resolution: 3e-3}\nreplicates: 2\nfactors: {rp: [spheres, 1e-2]}\n"
                   "base: {preset: demo, particles: 8, phases: {pack_time: 0.2, settle_time: 0.1, lift_time: 0.3, hold_time: 0.1, drop_height: 0.05}}\n")
    scree("study", "small.yaml", "-o", "real", "--jobs", "1", folder=folder)
    unfolded(browser, os.path.join(folder, "real", "report.html"))
    check("A heap of each point" in browser.text("main"), "the study shows no heap")
    check(browser.run("return document.querySelectorAll('.points button').length") == 2, "not a heap of each point")
    browser.wait("document.body.dataset.shownTime")
    first = painted(browser, 0)
    browser.run("document.querySelectorAll('.points button')[0].click()")
    redrawn(browser, 0, first, "another point shows the same heap")
    seek(browser, 10)
    check(0 < float(browser.run("return document.body.dataset.shownTime")) < 0.5, "the study's heap has no motion")
    no_complaints(browser, "a real study")
    pictures(browser, "real-study")


def a_study_of_a_scene(browser, folder):
    with open(os.path.join(folder, "rain.yaml"), "w", encoding="utf-8") as file:
        file.write("time: 0.1\nshapes: {ball: {sphere: 0.01}}\ngeometry: {floor: {plane: [0, 0, 1]}}\n"
                   "inlets: {feed: {box: {min: [0, 0, 0.1], max: [0.1, 0.1, 0.2]}, shapes: ball, rate: 100}}\n"
                   "sensors: {load: {wall: floor}, all: {region: {box: {min: [-1, -1, -1], max: [1, 1, 1]}}}}\n")
    with open(os.path.join(folder, "rains.yaml"), "w", encoding="utf-8") as file:
        file.write("base: {scene: rain.yaml}\nfactors: {inlets.feed.rate: [50, 100], inlets.feed.orientation: [fixed, random]}\n"
                   "answers: [all.count, load.force_z]\nreplicates: 2\n")
    scree("study", "rains.yaml", "-o", "rains", "--jobs", "1", folder=folder)
    with open(os.path.join(folder, "rains", "study.json"), encoding="utf-8") as file:
        check(json.load(file)["points"][3]["factors"] == {"inlets.feed.rate": 100, "inlets.feed.orientation": "random"}, "the factors are others")
    unfolded(browser, os.path.join(folder, "rains", "report.html"))
    text = browser.text("main")
    for part in ("inlets.feed.rate", "inlets.feed.orientation fixed", "Force z", "all alike", "rate with orientation, besides"):
        check(part in text, f"the scene's study does not say: {part}")
    no_complaints(browser, "a study of a scene")
    pictures(browser, "scene-study")


TRAY = """
import math, random, sys
friction, rolling, seed = float(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
noise = random.Random(1009 * seed + round(1e5 * friction) + round(1e6 * rolling)).gauss
print(f"heap_angle: {10 + 30 * friction ** 0.7 + 18 * math.sqrt(rolling) * (0.5 + friction / 0.65) + noise(0, 0.7):.4f}")
print(f"crater_angle: {8 + 36 * friction ** 0.8 + 10 * math.sqrt(rolling) + noise(0, 0.8):.4f}")
print(f"mass_rate: {1.1 - 0.25 * friction - 0.315 * rolling / (0.1 + rolling) + noise(0, 0.012):.5f}")
"""
RUN = "command: [python3, '{here}/tray.py', '{friction}', '{rolling_friction}', '{seed}']"
CALIBRATION = """
title: gravel
experiments: {tray: {""" + RUN + """}}
parameters: {friction: {from: 0.1, to: 0.9}, rolling_friction: {from: 0.01, to: 0.5}}
targets:
  heap_angle: {answer: heap_angle, unit: deg, measured: [HEAP]}
  crater_angle: {answer: crater_angle, unit: deg, measured: [34.6, 36.0, 35.1]}
predict: {mass_rate: {answer: mass_rate, unit: kg/s}}
budget: {runs: 30}
"""


def written(folder, name, text):
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def calibrations(browser, folder):
    """One that fits, one that cannot, a search: the page says what calibration.json says; a misfit's holds no answer."""
    written(folder, "tray.py", TRAY)
    written(folder, "fits.yaml", CALIBRATION.replace("HEAP", "38.9, 39.6, 37.8, 39.1"))
    written(folder, "misfit.yaml", CALIBRATION.replace("HEAP", "78.1, 79.4, 77.2, 78.8"))
    written(folder, "search.yaml", "title: fastest\nexperiments: {tray: {" + RUN + "}}\nparameters: {friction: {from: 0.1, to: 0.9}, rolling_friction: {from: 0.01, to: 0.5}}\n"
            "maximise: {answer: mass_rate}\nlimits: {steep: {answer: heap_angle, at_least: 30}}\nbudget: {runs: 24}\n")
    for verb, name in (("calibrate", "fits"), ("calibrate", "misfit"), ("optimise", "search")):
        scree(verb, f"{name}.yaml", "-o", name, "-q", "--jobs", "2", folder=folder)
        page = os.path.join(folder, f"{name}.html")
        scree("report", name, "-o", page, folder=folder)
        with open(os.path.join(folder, name, "calibration.json"), encoding="utf-8") as file:
            told = json.load(file)
        check(told.get("fits") == {"fits": True, "misfit": False}.get(name), f"{name}: fits is {told.get('fits')}")
        ready(browser, page)
        says_what_the_file_says(browser, told, numbers_of(told) + [a["value"] + a["gap"] for a in told["answers"] if a["gap"] is not None])
        if name == "misfit":
            text = browser.run("return document.querySelector('main').textContent")
            for word in ("identified", "agrees with what was measured", "predicted:", "Each point is a pair"):
                check(word not in text, f"a misfit's page holds {word!r}")
            check(text.count("mean") == 0 or "interval of" not in text, "a misfit's page holds intervals of parameters")
        if name == "fits":
            browser.run("document.querySelector('.grid .plot .pt.c3').dispatchEvent(new PointerEvent('pointerenter'))")
            browser.wait("document.querySelectorAll('.pt.on').length > 1")  # the same run elsewhere
            browser.wait("document.querySelector('.read.live')")
        has_the_skeleton(browser, page, name)
    return page


def a_study_of_a_command(browser, folder):
    written(folder, "tray.yaml", "name: tray\nbase: {" + RUN + "}\nfactors: {friction: [0.2, 0.4, 0.6], rolling_friction: [0.02, 0.25]}\nanswers: [heap_angle, mass_rate]\nreplicates: 4\n")
    scree("study", "tray.yaml", "-o", "tray", "-q", "--jobs", "2", folder=folder)
    page = os.path.join(folder, "tray", "report.html")
    with open(os.path.join(folder, "tray", "study.json"), encoding="utf-8") as file:
        told = json.load(file)
    first = told["told"][0]
    means = {(p["factors"]["friction"], p["factors"]["rolling_friction"]): p["answers"]["heap_angle"]["mean"] for p in told["points"]}
    friction = sum(means[0.6, r] - means[0.2, r] for r in (0.02, 0.25)) / 2
    both = means[0.6, 0.25] - means[0.6, 0.02] - (means[0.2, 0.25] - means[0.2, 0.02])
    sizes = {(e["factor"], e["other"]): e["size"] for e in first["effects"]}
    check(abs(sizes["friction", None] - friction) < 1e-9, f"the effect of friction is {sizes}, by hand {friction}")
    check(any(abs(abs(size) - abs(both)) < 1e-9 for (_, other), size in sizes.items() if other), f"that of both besides is {sizes}, by hand {both}")
    ready(browser, page)
    says_what_the_file_says(browser, told, numbers_of(told))
    check(first["finding"] in browser.text("main"), "no title says what the effects show")
    before = browser.run("return document.querySelectorAll('.cur').length")
    browser.keys(".pic .plot", "\ue014")  # arrow right
    check(before == 0 and browser.run("return document.querySelectorAll('.cur').length") >= 2, "an arrow key marks nothing in the other charts")
    has_the_skeleton(browser, page, "tray")
    return page


def summary(mean, sd):
    return {"count": 8, "mean": mean, "mean_low": mean - sd, "mean_high": mean + sd, "sd": sd, "sd_low": sd / 2,
            "sd_high": 2 * sd, "cv": sd / mean}


def made_up_study():
    """A study.json (docs/reference/formats.md) with numbers that no run gave."""
    points = [{
        "label": f"shapes {shapes}, rp {rp}", "rp": rp, "factors": {"shapes": shapes, "rp": rp}, "answers": {}, "shapes": shapes, "heap_count": 8, "triangle_count": 100 * i,
        "runs": {"done": 8, "failed": 1, "running": 0, "leased": 0, "waiting": 1},
        **{key: summary(30 + i, 1) for key in ("angle_deg", "seconds", "height", "run_out", "coordination",
                                              "left", "peak_rotation")},
        "packing_fraction": summary(0.5, 0),
        "rotation": {"time": [0, 1, 2], "mean": [0, 5 + i, 1], "low": [0, 4, 0], "high": [1, 9, 2]},
    } for shapes in ("a", "b") for i, rp in enumerate(("spheres", "1e-4", "1e-3", "scan"))]
    families = [{
        "label": f"shapes {shapes}", "finest": "scan", "converged": shapes == "a",
        "converged_from": "1e-3" if shapes == "a" else None,
        "against_finest": [{"rp": "1e-3", "difference": 0.2, "low": -0.5, "high": 0.9, "equivalent": shapes == "a",
                            "different": False, "count_needed": 12}],
        "time_law": {"count": 3, "factor": 100, "exponent": 0.5, "exponent_low": None, "exponent_high": None,
                     "r2": 0.9},
    } for shapes in ("a", "b")]
    told = [{"name": "angle_deg", "unit": "deg", "sentence": "No sentence", "finding": "Nothing", "scatter": 1, "half": 0.8, "effects": []}]
    return {"version": "0", "name": HOSTILE, "verdict": "answered", "state": "Made up", "sentence": "No sentence", "but": "", "next": None, "told": told, "design": "grid", "method": "volume", "angle": "sector", "seed": 1,
            "replicates": 8, "margin_deg": 1, "confidence": 0.95, "workers": 2, "seconds_spent": 10,
            "seconds_left": 0, "mixed_versions": False, "points": points, "families": families,
            "runs": {"done": 64, "failed": 8, "running": 0, "leased": 0, "waiting": 8},
            "failures": [{"label": "shapes a, rp scan", "replicate": 3, "reason": HOSTILE}]}


def a_study(browser, folder):
    os.mkdir(os.path.join(folder, "study"))
    with open(os.path.join(folder, "study", "study.json"), "w", encoding="utf-8") as out:
        json.dump(made_up_study(), out)
    scree("report", "study", "-o", "study.html", folder=folder)
    unfolded(browser, os.path.join(folder, "study.html"))
    text = browser.text("main")
    for part in (HOSTILE, "No sentence", "Computation time of a run", "Rotation while the heap forms", "cannot be told yet"):
        check(part in text, f"the study does not say: {part}")
    check(browser.run("return document.querySelectorAll('b').length") == 0, "a text became markup")
    no_complaints(browser, "study")
    pictures(browser, "study")


def what_is_missing_is_said(page, heap, pour, search, study):
    with Browser(webgl=False) as browser:
        ready(browser, page)
        text = browser.text("main")
        check("shows no WebGL" in text and "Candidate levels" in text, "nothing is said where WebGL is missing")
        pictures(browser, "no-webgl", width=600)
        ready(browser, heap)
        check("shows no WebGL" in browser.text("main"), "nothing is said where WebGL is missing")
        check(browser.run("const i = document.querySelector('.pile img'); return i.complete && i.naturalWidth > 100"), "no picture stands in for the heap")
        pictures(browser, "heap-no-webgl", width=600)
        ready(browser, pour)
        check("shows no WebGL" in browser.text("main"), "nothing is said where WebGL is missing")
        check(browser.run("return document.querySelectorAll('.pile img').length") == 1, "no picture stands in for the pour")
    with Browser(script=False) as browser:
        browser.open(page)
        check("Use " in browser.text("body"), "nothing is said where JavaScript is off")
        browser.open(heap)
        check("No angle yet" in browser.text("body"), "nothing is said of a heap where JavaScript is off")
        browser.open(pour)
        check("touching neighbours" in browser.text("body"), "nothing is said of a pour where JavaScript is off")
        for each, part in ((search, "is greatest"), (study, "Heap angle goes from")):
            browser.open(each)
            check(part in browser.text("body"), f"{part!r} is not said where JavaScript is off")


def main():
    what = missing()
    if what:
        print(f"skipped: no {what} installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        with Browser() as browser:
            page = one_object(browser, folder)
            several_objects(browser, folder)
            the_set_is_the_text_s(browser, folder)
            long_bodies_are_whole(browser, folder)
            one_level_is_said(browser, folder)
            a_study(browser, folder)
            search = calibrations(browser, folder)
            study = a_study_of_a_command(browser, folder)
            heap = a_heap(browser, folder)
            pour = a_pour(browser, folder)
            a_machine(browser, folder)
            a_real_study(browser, folder)
            a_study_of_a_scene(browser, folder)
            a_large_page(browser, folder)
            for name, path in (("one", page), ("two", os.path.join(folder, "two", "report.html")), ("heap", heap), ("pour", pour)):
                has_the_skeleton(browser, path, f"{name}-skeleton")
        what_is_missing_is_said(page, heap, pour, search, study)
    return 0


PROGRAM = os.path.abspath(sys.argv[1])
KEEP = sys.argv[2] if len(sys.argv) > 2 else None
if __name__ == "__main__":
    sys.exit(main())
