#!/usr/bin/env python3
"""Files of src that reach each other in a circle by calls, counted in each folder. Fails where the largest circle of a
folder has more files than it may. usage: knots.py FOLDER      the objects of src; exits 77
where nm is missing."""
import collections
import glob
import os
import shutil
import subprocess
import sys

MOST = 3
MORE = {"world": 4}


def read_objects(root):
    """Of each object what it defines and what it calls."""
    paths = sorted(glob.glob(os.path.join(root, "**/*.o"), recursive=True))
    if not paths:
        sys.exit(f"knots.py: no objects in {root}")
    objects = {os.path.relpath(path, root)[:-2]: (set(), set()) for path in paths}
    for line in subprocess.run(["nm", "-A", "-g", *paths], capture_output=True, text=True, check=True).stdout.splitlines():
        path, _, rest = line.partition(".o:")
        kind, symbol = rest.split()[-2:]
        objects[os.path.relpath(path, root)][kind == "U"].add(symbol)
    return objects


def folder_of(name):
    """mesh has folders of its own, with layers between."""
    parts = name.split("/")
    return "/".join(parts[:2]) if parts[0] == "mesh" and len(parts) > 2 else parts[0]


def circles(calls):
    """The strongly connected components of more than one file, the largest first."""
    def reached(start):
        seen, left = set(), [start]
        while left:
            for other in calls[left.pop()] - seen:
                seen.add(other)
                left.append(other)
        return seen
    reach = {name: reached(name) for name in calls}
    found = {frozenset(other for other in reach[name] if name in reach[other]) for name in calls}
    return sorted((circle for circle in found if len(circle) > 1), key=len, reverse=True)


def main():
    if not shutil.which("nm"):
        print("skipped: no nm installed")
        sys.exit(77)
    objects = read_objects(sys.argv[1])
    folders = collections.defaultdict(list)
    for name in objects:
        folders[folder_of(name)].append(name)
    failed = False
    for folder, names in sorted(folders.items()):
        owner = {symbol: name for name in names for symbol in objects[name][0]}
        calls = {name: {owner[s] for s in objects[name][1] if s in owner and owner[s] != name} for name in names}
        for circle in circles(calls)[:1]:
            most = MORE.get(folder, MOST)
            print(f"{folder}: {len(circle)} of {len(names)} files" + (f", more than {most}" if len(circle) > most else ""))
            if len(circle) > most:
                failed = True
                print("  " + "\n  ".join(f"{name} -> {other}" for name in sorted(circle) for other in sorted(calls[name] & circle)))
    sys.exit(failed)


main()
