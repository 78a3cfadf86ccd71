#!/usr/bin/env python3
"""The site is built without a warning; nothing on it is missing or asked from a network: pages, anchors, styles, scripts,
pictures; the keyboard reaches code; its search finds from disk; ten pages do not scroll sideways on a telephone and can be read and
reached. usage: site.py ROOT BUILD"""
import html.parser
import os
import re
import subprocess
import sys
import tempfile
import urllib.parse

root, build = sys.argv[1:]
sys.path.insert(0, os.path.join(root, "tests", "report"))
import browser  # noqa: E402


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.ids, self.unreached = [], set(), 0
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids.add(values.get("id"))
        self.unreached += tag == "pre" and "tabindex" not in values
        link = values.get("href") if tag in ("a", "link") else values.get("src")
        if link:
            self.links.append((tag, link))


def missing(folder):
    pages = {os.path.join(at, name): None for at, _, files in os.walk(folder) for name in files if name.endswith(".html")}
    for path in pages:
        pages[path] = Page(path)
    for path, page in pages.items():
        if page.unreached:
            yield f"{path}: code that the keyboard does not reach"
        for tag, link in page.links:
            url = urllib.parse.urlsplit(link)
            if url.scheme in ("http", "https"):
                if tag != "a":
                    yield f"{path}: asks {link} from a network"
                continue
            if url.scheme:
                continue
            target = os.path.normpath(os.path.join(os.path.dirname(path), urllib.parse.unquote(url.path))) if url.path else path
            if not os.path.exists(target):
                yield f"{path}: {link} is not there"
            elif url.fragment and target in pages and urllib.parse.unquote(url.fragment) not in pages[target].ids:
                yield f"{path}: {link} has no such place"
    for at, _, files in os.walk(folder):
        for name in (n for n in files if n.endswith(".css")):
            with open(os.path.join(at, name), encoding="utf-8") as file:
                # browsers take the first form of a font that they know
                for sources in re.findall(r"(?:src:|@import|background[a-z-]*:)([^;}]*)", file.read()):
                    url = re.search(r"url\(['\"]?([^'\")?#]+)", sources)
                    if url and not url[1].startswith("data:") and not os.path.exists(os.path.join(at, url[1])):
                        yield f"{at}/{name}: {url[1]} is not there"


def look(window, site):
    for words, page in (("tolerance", "reference/verbs/choose.html"), ("hausdorff", "background/method.html"), ("install", "install.html"),
                        ("windows", "install.html"), ("macos python", "install.html"), ("restit", "glossary.html"),
                        ("tolerence", "reference/verbs/choose.html"), ("licence", "index.html"), ("inches", "howto/units.html"),
                        ("moisture", "background/physics.html"), ("blender", "howto/other-programs.html")):
        window.open(f"{site}/search.html", f"?q={urllib.parse.quote(words)}")
        window.wait("document.querySelector('#found > li > a')", 60)
        found = window.run("return [...document.querySelectorAll('#found > li > a')].map(a => a.getAttribute('href'))")
        if page not in (link.split("#")[0] for link in found) or len(found) != len(set(found)):
            sys.exit(f"the search for {words} finds {found[:10]}, not {page}, or one place twice")
    window.open(f"{site}/index.html")
    if window.run("return document.documentElement.classList.contains('no-js')"):
        sys.exit("the theme's script does not run from disk")
    for page in ("index", "install", "search", "background/method", "background/physics", "tutorials/own-machine", "reference/scenes",
                 "reference/verbs/choose", "reference/formats", "reference/python"):
        window.open(f"{site}/{page}.html")
        for width, dark in ((400, False), (1200, True)):
            window.look(width=width, dark=dark)
            wide = window.run("return document.documentElement.scrollWidth")
            barriers = [barrier for barrier in window.barriers() if not re.search(r": \.(sidebar|toc)-", barrier)]  # the theme's
            if wide > width or barriers:
                sys.exit(f"{page} at {width}: {wide} wide; {barriers}")


with tempfile.TemporaryDirectory() as folder:
    done = subprocess.run([f"{root}/tools/site/build.sh", build, folder + "/site"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        print(done.stdout)
        sys.exit(done.returncode)
    site = folder + "/site"
    wrong = list(missing(site))
    if wrong:
        sys.exit("\n".join(wrong[:20]))
    count = sum(name.endswith(".html") for _, _, files in os.walk(site) for name in files)
    if len(os.listdir(f"{site}/reference/verbs")) < 15:
        sys.exit("pages of verbs are missing")
    lacking = browser.missing()
    if lacking:
        print(f"{count} pages; no {lacking}: they are not looked at")
        sys.exit(0)
    with browser.Browser() as window:
        look(window, site)
    print(f"{count} pages")
