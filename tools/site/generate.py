#!/usr/bin/env python3
"""Gathers the manual for Sphinx: docs/ as it is, and pages made from the program's tables, the public headers and the
Python module. usage: generate.py PROGRAM LIBRARY SOURCE_FOLDER
SOURCE_FOLDER gets the pages, with the site's tree of contents; the order of the navigation is that of the links in each part's index.md."""
import inspect
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as tree

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
PARTS = [("tutorials", "Tutorials"), ("howto", "How to"), ("reference", "Reference"), ("background", "Background"), ("contributing", "Contributing"), ("changes", "Earlier versions")]


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


# ---- blocks of code that are files ----

def name_files(source):
    """`yaml file=drum.yaml` on a block of code is a caption there."""
    for folder, _, names in os.walk(source):
        for name in names:
            if not name.endswith(".md"):
                continue
            text = read(f"{folder}/{name}")
            named = re.sub(r"^```(\w+) file=(\S+).*\n", r"```{code-block} \1\n:caption: \2\n\n", text, flags=re.MULTILINE)
            if named != text:
                write(f"{folder}/{name}", named)


# ---- the whole ----

def links(page):
    return [l for l in re.findall(r"\]\(([^)#:]+\.md)", read(page)) if not l.startswith("..")]


def tree_of(pages):
    return "\n```{toctree}\n:hidden:\n\n" + "\n".join(page[:-3] for page in pages) + "\n```\n"


def append(path, text):
    with open(path, "a", encoding="utf-8") as file:
        file.write(text)


def navigation(source, made):
    """Each part's pages under its index, in the order of its links; pages that are made under an index of their own."""
    for folder, name in PARTS:
        index = f"{source}/{folder}/index.md"
        pages = [page for page in dict.fromkeys(links(index))
                 if os.path.dirname(page) == "" and os.path.exists(f"{source}/{folder}/{page}")]
        append(index, tree_of(pages + made.get(folder, [])))
    append(f"{source}/index.md", tree_of(["install.md"] + [f"{folder}/index.md" for folder, _ in PARTS]
                                         + ["faq.md", "glossary.md", "releasing.md"]))


def with_pages_below(folder, pages):
    """The index of pages that are made, as the entry of their part."""
    if not pages:
        return []
    append(f"{folder}/index.md", tree_of([page for page in pages if page != "index.md"]))
    return [f"{os.path.basename(folder)}/index.md"]


def main(program, library, source):
    shutil.rmtree(source, ignore_errors=True)
    shutil.copytree(f"{ROOT}/docs", source)
    name_files(source)
    reference = f"{source}/reference"
    made = with_pages_below(f"{reference}/verbs", make_verbs(program, f"{reference}/verbs"))
    made += with_pages_below(f"{reference}/c", make_c(f"{reference}/c", f"{source}.doxygen"))
    made += make_python(f"{reference}/python-module.md", library)
    navigation(source, {"reference": made})


if __name__ == "__main__":
    main(*sys.argv[1:])
