#!/usr/bin/env python3
"""The site is built without a warning, needs no network, and its search finds from disk. usage: site.py ROOT BUILD"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

root, build = sys.argv[1:]
if not shutil.which("mkdocs"):
    print("no mkdocs")
    sys.exit(77)
with tempfile.TemporaryDirectory() as folder:
    done = subprocess.run([f"{root}/tools/site/build.sh", build, folder], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(done.stdout)
    names = [os.path.join(at, name) for at, _, files in os.walk(folder) for name in files if name.endswith(".html")]
    verbs = [name for name in names if "/verbs/" in name]
    asked = [(name, url) for name in names for url in
             re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(https?:[^"]*)"', open(name, encoding="utf-8").read())]
    if len(verbs) < 15 or asked:
        sys.exit(f"{len(verbs)} verbs; asked from the network: {asked[:5]}")
    browser = shutil.which("chromium")
    if not browser:
        print(f"{len(names)} pages; no chromium: the search is not tried")
        sys.exit(0)
    for word, page in (("tolerance", "reference/verbs/choose.html"), ("hausdorff", "background/method.html")):
        seen = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=5000", "--dump-dom",
                               f"file://{folder}/search.html?q={word}"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
        if f'href="./{page}' not in seen:
            sys.exit(f"the search for {word} does not find {page}")
    print(f"{len(names)} pages")
