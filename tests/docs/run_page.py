#!/usr/bin/env python3
"""Runs a page of the manual from its own text, in an empty folder. usage: run_page.py PROGRAM LIBRARY PAGE [--long]

Fenced blocks are taken in their order:
  ```sh               is run by bash -eu; all blocks share one folder
  ```sh needs=TOOL    only where TOOL is installed
  ```sh long          only with --long
  ```python           is run by python3, which finds the module scree; takes needs= and long too
  ```yaml file=NAME   becomes the file NAME (any language)
Each picture that a tutorial shows must be among the files that the commands made; UPDATE=1 copies it into the page's
place. A how-to finds what it speaks of in the folder (howto.sh). What the page quotes in backticks as the program's answer, `Use N triangles ...`, must be what the program said.
Exit code 77 where there is nothing to run."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


def blocks(text):
    for info, body in re.findall(r"^```(\S.*?)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        words = info.split()
        yield words[0], dict(w.split("=", 1) if "=" in w else (w, True) for w in words[1:]), body


def run(language, body, folder, environment):
    command = ["bash", "-euo", "pipefail", "-c", body] if language == "sh" else ["/usr/bin/python3", "-c", body]
    done = subprocess.run(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"failed with exit code {done.returncode}:\n{body}\n{done.stdout[-4000:]}")
    return done.stdout


def pictures(text, page, folder):
    """Exits where a picture of the page was not made by its commands."""
    for link in re.findall(r"!\[[^]]*\]\(([^)]+)\)", text):
        name = os.path.basename(link)
        made = [os.path.join(at, name) for at, _, files in os.walk(folder) if name in files]
        if not made or not os.path.getsize(made[0]):
            sys.exit(f"{page} shows {name}, which its commands do not make")
        if os.environ.get("UPDATE") == "1":
            shutil.copy(made[0], os.path.normpath(os.path.join(os.path.dirname(page), link)))


def main(program, library, page, long=False):
    with open(page, encoding="utf-8") as file:
        text = file.read()
    # one thread: on a busy machine several wait for each other at every step, and the results are the same
    environment = os.environ | {"OMP_NUM_THREADS": "1", "NO_COLOR": "1",
                                "PATH": os.path.dirname(os.path.abspath(program)) + ":" + os.environ["PATH"],
                                "PYTHONPATH": f"{ROOT}/python", "SCREE_LIBRARY": os.path.abspath(library)}
    count, skipped, heard = 0, False, ""
    with tempfile.TemporaryDirectory() as folder:
        if "/howto/" in os.path.abspath(page):
            with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "howto.sh"), encoding="utf-8") as file:
                run("sh", file.read(), folder, environment)
        for language, flags, body in blocks(text):
            if "file" in flags:
                with open(os.path.join(folder, flags["file"]), "w", encoding="utf-8") as file:
                    file.write(body)
            elif language in ("sh", "python"):
                if flags.get("long") and not long or "needs" in flags and not shutil.which(flags["needs"]):
                    skipped = True
                    continue
                start = time.monotonic()
                said = run(language, body, folder, environment)
                count, heard = count + 1, heard + said
                if os.environ.get("VERBOSE"):
                    print(f"--- {time.monotonic() - start:.1f} s\n{body}{said}")
        for quote in re.findall(r"`(Use \d[^`]*)`", text):
            if quote not in heard:
                sys.exit(f"{page} quotes what the program does not say: {quote}")
        if count and "/tutorials/" in os.path.abspath(page) and (not skipped or long):
            pictures(text, page, folder)
    if not count:
        print("nothing to run")
        sys.exit(77)
    print(f"{os.path.relpath(page, ROOT)}: {count} blocks{', some skipped' if skipped else ''}")


if __name__ == "__main__":
    main(*sys.argv[1:4], long="--long" in sys.argv)
