#!/usr/bin/env python3
"""The site is built without a warning; nothing on it is missing or asked from a network: pages, anchors, styles, scripts,
pictures; the keyboard reaches code; its search finds from disk, and no page scrolls sideways on a telephone. usage: site.py ROOT BUILD"""
import html.parser
import os
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

root, build = sys.argv[1:]


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


def look(browser, address, *options):
    return subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=5000", *options, "--dump-dom", address],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout


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
    browser = shutil.which("chromium")
    if not browser:
        print(f"{count} pages; no chromium: the search is not tried")
        sys.exit(0)
    for words, page in (("tolerance", "reference/verbs/choose.html"), ("hausdorff", "background/method.html"), ("install", "install.html"),
                        ("windows", "install.html"), ("macos python", "install.html"), ("restit", "glossary.html")):
        seen = look(browser, f"file://{site}/search.html?q={urllib.parse.quote(words)}")
        found = re.findall(r'<li><a href="([^"#]*)[^"]*">', seen)
        if page not in found or len(re.findall(r"<li><a ", seen)) != len(set(re.findall(r'<li><a href="([^"]*)"', seen))):
            sys.exit(f"the search for {words} finds {found[:10]}, not {page}, or one place twice")
    if 'class="no-js"' in look(browser, f"file://{site}/index.html"):
        sys.exit("the theme's script does not run from disk")
    # a page in a frame of 400 points tells how wide it would be
    for page in ("index", "install", "background/physics", "reference/scenes", "reference/verbs/choose", "reference/formats"):
        with open(f"{folder}/frame.html", "w", encoding="utf-8") as file:
            file.write(f'<iframe id="f" src="site/{page}.html" width="400" height="800" style="border:0" onload="'
                       "document.title = f.contentDocument.documentElement.scrollWidth\"></iframe>")
        width = re.search(r"<title>(\d+)", look(browser, f"file://{folder}/frame.html", "--allow-file-access-from-files"))
        if not width or int(width[1]) > 400:
            sys.exit(f"{page} is {width[1] if width else 'not'} wide on a screen of 400")
    print(f"{count} pages")
