#!/usr/bin/python3
"""A picture of the page with its sample, after the choice, or of the top of a report, in a headless Chromium.
usage: picture.py PAGE PICTURE.png       PAGE: build/page/scree.html, as `make page` builds it, or a report.html"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "report"))
from browser import Browser, missing  # noqa: E402

page, picture = sys.argv[1:]
if missing() or not os.path.exists(page):
    print(f"no {missing() or page}")
    sys.exit(77)
with Browser() as browser:
    browser.look(1000, 860)
    browser.open(page)
    browser.wait("document.body?.dataset.ready")
    if browser.run("return Boolean(document.querySelector('#sample'))"):
        browser.run("document.querySelector('#sample').click()")
        browser.wait("document.body.dataset.chosen > 0 || document.querySelector('.error')", 300)
        browser.wait("document.querySelector('#panel-0').dataset.busy === 'false'", 300)
    else:
        browser.look(1000, 1150)
        slider = "document.querySelector('input[type=range]')"
        browser.wait(slider)
        browser.run(f"const s = {slider}; s.value = 0.78 * s.max; s.dispatchEvent(new Event('input', {{bubbles: true}}))")
    browser.run("window.scrollTo(0, 0)")
    browser.screenshot(picture, whole=False)
