"""Sphinx on the pages that generate.py has gathered: MyST reads the Markdown, Furo is the theme, KaTeX sets the formulas
here, and lunr searches (static/search.js), so that the site asks no network and opens from disk."""
import json
import os
import re
import shutil
import subprocess

from docutils import nodes

project = "scree"
html_title = "scree"
html_baseurl = ""
extensions = ["myst_parser", "sphinx_copybutton"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
highlight_language = "none"
pygments_style = "default"
pygments_dark_style = "native"
copybutton_selector = "div.highlight pre"
templates_path = ["templates"]
html_math_renderer = "katex"
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_use_index = False
html_permalinks_icon = "#"
KATEX = "/usr/share/javascript/katex/katex.min.css"
LUNR = "/usr/share/javascript/lunr/lunr.min.js"
KATEX_FONTS = "/usr/share/fonts/truetype/katex"
NORMALIZE = "/usr/share/javascript/normalize.css/normalize.css"

# ---- formulas, set once here: no browser needs a script for them ----

SET = """
const katex = require('katex'), jobs = JSON.parse(require('fs').readFileSync(0, 'utf8'));
console.log(JSON.stringify(jobs.map(([text, displayMode]) => katex.renderToString(text, {displayMode, throwOnError: true}))));
"""


def set_formulas(app, doctree, name):
    found = [node for kind in (nodes.math, nodes.math_block) for node in doctree.findall(kind)]
    if not found:
        return
    jobs = [[node.astext(), isinstance(node, nodes.math_block)] for node in found]
    done = subprocess.run(["node", "-e", SET], input=json.dumps(jobs), stdout=subprocess.PIPE, text=True, check=True,
                          env=os.environ | {"NODE_PATH": "/usr/share/nodejs"})
    for node, made in zip(found, json.loads(done.stdout)):
        node.replace_self(nodes.raw("", made, format="html"))


# ---- what the search reads: one entry for every section ----

def sections(doctree, name):
    for section in doctree.findall(nodes.section):
        title = section.next_node(nodes.title)
        text = " ".join(child.astext() for child in section.children
                        if not isinstance(child, (nodes.section, nodes.title)) and not child.astext().startswith("<span class=\"katex"))
        first = section.parent is doctree
        yield [name + ".html" + ("" if first else "#" + section["ids"][0]), title.astext(), re.sub(r"\s+", " ", text)]


def gather_sections(app, doctree, name):
    app.env.scree_sections = getattr(app.env, "scree_sections", []) + list(sections(doctree, name))


def finish(app, failure):
    if failure or app.builder.name != "html":
        return
    static = os.path.join(app.outdir, "_static")
    with open(os.path.join(static, "sections.js"), "w", encoding="utf-8") as file:
        file.write("const screeSections = " + json.dumps(app.env.scree_sections, ensure_ascii=False) + ";\n")
    shutil.copy(KATEX, static)
    shutil.copy(LUNR, static)
    os.makedirs(os.path.join(static, "fonts"), exist_ok=True)
    for font in os.listdir(KATEX_FONTS):
        if font.endswith(".woff2"):
            shutil.copy(os.path.join(KATEX_FONTS, font), os.path.join(static, "fonts"))
    make_theme_whole(static)
    for unused in ("searchindex.js", "objects.inv", ".buildinfo"):
        if os.path.exists(os.path.join(app.outdir, unused)):
            os.remove(os.path.join(app.outdir, unused))


def replace(path, old, new):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    assert old in text, f"{path} has no {old}"
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(old, new))


def make_theme_whole(static):
    """Debian's Furo takes one style from its web server, and a script as a module, which browsers refuse from disk."""
    shutil.copy(NORMALIZE, os.path.join(static, "styles"))
    replace(os.path.join(static, "styles", "furo.css"), "url(/javascript/normalize.css/normalize.css)", "url(normalize.css)")
    scripts = os.path.join(static, "scripts")
    with open(os.path.join(scripts, "gumshoe-patched.js"), encoding="utf-8") as file:
        replace(os.path.join(scripts, "furo.js"), 'import Gumshoe from "./gumshoe-patched.js";', file.read())
    os.remove(os.path.join(scripts, "gumshoe-patched.js"))


def style_formulas(app, name, template, context, doctree):
    if doctree and any("katex" in node.astext() for node in doctree.findall(nodes.raw)):
        app.add_css_file("katex.min.css")


def reach_what_scrolls(app, name, template, context, doctree):
    """Code, tables and formulas that scroll sideways must be reached by the keyboard."""
    if "body" in context:
        context["body"] = re.sub('<(pre(?=>)|div(?= class="table-wrapper)|span(?= class="katex-display))', r'<\1 tabindex="0"', context["body"])


def set_before(translator, node):
    raise AssertionError("formulas are set before pages are written")


def setup(app):
    app.add_html_math_renderer("katex", (set_before, None), (set_before, None))
    app.connect("doctree-resolved", gather_sections, priority=400)
    app.connect("doctree-resolved", set_formulas, priority=500)
    app.connect("html-page-context", style_formulas)
    app.connect("html-page-context", reach_what_scrolls)
    app.connect("build-finished", finish)
