#!/usr/bin/env python3
"""How right the times are that `scree run` foretells: of templates, the seconds left as first told and at a fifth of the
processor's time, over those that it then took. All in processor time, so that other work on the machine matters little.
usage: estimates.py [SCREE]"""
import os
import re
import subprocess
import sys
import tempfile
import time

SCREE = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build/release/bin/scree")
SCENES = (("hopper", 1.5), ("drum", 1), ("belt", 1.5), ("tumbler", 0.6), ("shredder", 0.3), ("drawdown", 1), ("hammer-mill", 0.3),
          ("paddle-mixer", 0.5), ("hollow-cylinder", 1))
UNITS = {"s": 1, "min": 60, "h": 3600}


def used(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def watch(name, until):
    """Rows of clock, processor time and seconds left as told, and the processor's time at the end."""
    call = [SCREE, "run", "--template", name, "--set", f"time={until}", "--progress", "-j", "1", "-o", name, "--no-picture"]
    process = subprocess.Popen(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    os.set_blocking(process.stderr.fileno(), False)
    began, rows, last = time.time(), [], 0
    while process.poll() is None:
        last = max(last, used(process.pid))
        text = (process.stderr.read() or b"").decode(errors="replace")
        found = re.search(r"steps/s  ([\d.]+) (s|min|h) left", text)
        if found:
            rows.append((time.time() - began, last, float(found[1]) * UNITS[found[2]]))
        time.sleep(0.02)
    return rows, last


def main():
    os.chdir(tempfile.mkdtemp())
    print("| template | processor, s | first told, at | over what it took | at a fifth |\n|---|--:|--:|--:|--:|")
    for name, until in SCENES:
        rows, total = watch(name, until)
        cells = []
        for share in (0, 0.2):
            clock, done, left = next((r for r in rows if r[1] >= share * total), (1, total, 0))
            before = next((r for r in reversed(rows) if r[0] < clock - 2), (0, 0, 0))
            rate = (done - before[1]) / (clock - before[0])
            cells += [done, left * rate / max(total - done, 0.01)]
        print(f"| {name} | {total:.1f} | {cells[0]:.1f} s | {cells[1]:.2f} | {cells[3]:.2f} |", flush=True)


if __name__ == "__main__":
    main()
