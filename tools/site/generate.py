#!/usr/bin/env python3
"""Gathers the manual for MkDocs: docs/ as it is, and pages made from the program's tables, the public headers and the
Python module. usage: generate.py PROGRAM LIBRARY SOURCE_FOLDER SITE_FOLDER
SOURCE_FOLDER gets the pages and mkdocs.yml; the order of the navigation is that of the links in each part's index.md."""
import inspect
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as tree

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
PARTS = [("tutorials", "Tutorials"), ("howto", "How to"), ("reference", "Reference"), ("background", "Background")]


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


# ---- verbs ----

def make_verbs(program, folder):
    def said(*words):
        return subprocess.run([program, "help", *words], check=True, stdout=subprocess.PIPE, text=True).stdout
    index = said("--markdown")
    write(f"{folder}/index.md", index)
    names = re.findall(r"\]\((\w+)\.md\)", index)
    for name in names:
        write(f"{folder}/{name}.md", said("--markdown", name))
    return ["index.md"] + [f"{name}.md" for name in names]


# ---- C ----

def text_of(node):
    """The words of a description, its references without links."""
    if node is None:
        return ""
    paragraphs = [" ".join("".join(p.itertext()).split()) for p in node.iter("para")]
    return "\n\n".join(re.sub(r"([_*<>|])", r"\\\1", p) for p in paragraphs if p)


def describe(member):
    return "\n\n".join(filter(None, [text_of(member.find("briefdescription")), text_of(member.find("detaileddescription"))]))


def prototype(member):
    kind = "".join(member.find("type").itertext()).replace("SCREE_API ", "").strip()
    arguments = member.findtext("argsstring") or ""
    line = f"{kind} {member.findtext('name')}{arguments}".replace("* ", "*")
    return line if len(line) < 100 else line.replace(", ", ",\n    ")


def cell(text):
    return text.replace("\n\n", " ").replace("|", "\\|")


def make_struct(folder, reference):
    struct = tree.parse(f"{folder}/{reference}.xml").getroot().find("compounddef")
    lines = [f"### `{struct.findtext('compoundname')}`", describe(struct), "| field | meaning |\n|---|---|"]
    for member in struct.iter("memberdef"):
        kind = "".join(member.find("type").itertext())
        lines[-1] += f"\n| `{kind} {member.findtext('name')}{member.findtext('argsstring') or ''}` | {cell(describe(member))} |"
    return "\n\n".join(filter(None, lines))


def make_enum(member):
    lines = [f"### `{member.findtext('name')}`", describe(member), "| value | meaning |\n|---|---|"]
    for value in member.iter("enumvalue"):
        lines[-1] += f"\n| `{value.findtext('name')}` | {cell(describe(value))} |"
    return "\n\n".join(filter(None, lines))


def make_header(folder, name):
    file = tree.parse(f"{folder}/{name}_8h.xml").getroot().find("compounddef")
    top = re.match(r"/\* (.*?) \*/", read(f"{ROOT}/include/scree/{name}.h"), re.DOTALL)
    parts = [f"# scree/{name}.h", re.sub(r"\n \* ?", "\n", top[1]) if top else ""]
    members = [m for section in file.iter("sectiondef") for m in section.iter("memberdef")]
    functions = [m for m in members if m.get("kind") == "function"]
    enums = [m for m in members if m.get("kind") == "enum" and not m.findtext("name", "").startswith("@")]
    structs = [c.get("refid") for c in file.iter("innerclass") if os.path.exists(f"{folder}/{c.get('refid')}.xml")]
    if functions:
        parts.append("## Functions")
    for f in functions:
        parts += [f"### `{f.findtext('name')}`", "    " + prototype(f).replace("\n", "\n    "), describe(f)]
    if structs:
        parts.append("## Structs")
    parts += [make_struct(folder, s) for s in structs]
    if enums:
        parts.append("## Enums")
    parts += [make_enum(e) for e in enums]
    return "\n\n".join(filter(None, parts)) + "\n"


def make_c(folder, work):
    if not shutil.which("doxygen"):
        print("no doxygen: the site goes without the C interface")
        return []
    os.makedirs(work, exist_ok=True)
    subprocess.run(["doxygen", f"{ROOT}/tools/site/Doxyfile"], check=True, cwd=work,
                   env=os.environ | {"INCLUDE": f"{ROOT}/include"})
    order = re.findall(r'#include "scree/(\w+)\.h"', read(f"{ROOT}/include/scree.h"))
    names = order + sorted({f[:-2] for f in os.listdir(f"{ROOT}/include/scree")} - set(order))
    lines = ["# C interface", "`#include <scree.h>` gives all of it; `pkg-config --cflags --libs scree` says how to build.",
             "| header | |\n|---|---|"]
    for name in names:
        page = make_header(f"{work}/xml", name)
        write(f"{folder}/{name}.md", page)
        first = page.split("\n\n")[1].replace("\n", " ") if page.count("\n\n") else ""
        lines[-1] += f"\n| [scree/{name}.h]({name}.md) | {first.split('. ')[0]} |"
    write(f"{folder}/index.md", "\n\n".join(lines) + "\n")
    return ["index.md"] + [f"{name}.md" for name in names]


# ---- Python ----

def document(name, thing, level):
    try:
        signature = str(inspect.signature(thing))
    except (TypeError, ValueError):
        signature = ""
    head = f"{'#' * level} `{name}`"
    return "\n\n".join(filter(None, [head, f"    {name}{signature}", inspect.getdoc(thing)]))


def make_python(path, library):
    sys.path.insert(0, f"{ROOT}/python")
    os.environ["SCREE_LIBRARY"] = os.path.abspath(library)
    try:
        import scree
    except Exception as error:
        print(f"the site goes without the Python module: {error}")
        return []
    parts = ["# Python module", "How to begin is in [Python](python.md)."]
    for name in sorted(getattr(scree, "__all__", None) or [n for n in vars(scree) if not n.startswith("_")]):
        thing = getattr(scree, name)
        if inspect.ismodule(thing) or not callable(thing):
            continue
        parts.append(document(name, thing, 2))
        if inspect.isclass(thing):
            parts += [document(f"{name}.{method}", member, 3) for method, member in vars(thing).items()
                      if not method.startswith("_") and inspect.isfunction(member) and member.__doc__]
    write(path, "\n\n".join(parts) + "\n")
    return [os.path.basename(path)]


# ---- the whole ----

def links(page):
    return [l for l in re.findall(r"\]\(([^)#:]+\.md)", read(page)) if not l.startswith("..")]


def title(page):
    return re.search(r"^# (.*)", read(page), re.MULTILINE)[1].replace("`", "").replace("\\", "")


def navigation(source, made):
    nav = ["  - index.md"]
    for folder, name in PARTS:
        index = f"{source}/{folder}/index.md"
        if not os.path.exists(index):
            continue
        nav += [f"  - {name}:", f"      - {folder}/index.md"]
        nav += [f"      - {folder}/{page}" for page in dict.fromkeys(links(index))
                if os.path.dirname(page) == "" and os.path.exists(f"{source}/{folder}/{page}")]
        for heading, pages in made.get(folder, {}).items():
            nav += [f"      - {heading}:"] + [f"          - {page}" for page in pages]
    return "nav:\n" + "\n".join(nav + [f"  - {page}" for page in ("faq.md", "glossary.md", "releasing.md")
                                       if os.path.exists(f"{source}/{page}")]) + "\n"


def main(program, library, source, site):
    shutil.rmtree(source, ignore_errors=True)
    shutil.copytree(f"{ROOT}/docs", source)
    shutil.copy(f"{ROOT}/tools/site/site.css", source)
    reference = f"{source}/reference"
    verbs = [f"reference/verbs/{page}" for page in make_verbs(program, f"{reference}/verbs")]
    c = [f"reference/c/{page}" for page in make_c(f"{reference}/c", f"{source}.doxygen")]
    module = [f"reference/{page}" for page in make_python(f"{reference}/python-module.md", library)]
    made = {"reference": {key: pages for key, pages in (("Verbs", verbs), ("C interface", c), ("Python module", module)) if pages}}
    config = read(f"{ROOT}/tools/site/mkdocs.yml").replace("custom_dir: theme", f"custom_dir: {ROOT}/tools/site/theme")
    config = config.replace("- hooks.py", f"- {ROOT}/tools/site/hooks.py")
    write(f"{source}.yml", config + f"docs_dir: {os.path.abspath(source)}\nsite_dir: {os.path.abspath(site)}\n"
          + navigation(source, made))


if __name__ == "__main__":
    main(*sys.argv[1:])
