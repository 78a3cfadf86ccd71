"""What the cases share: where the program, the library and the folder of measurements are, tables that grow, statistics."""
import csv
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BUILD = pathlib.Path(os.environ.get("SCREE_BUILD", ROOT / "build" / "release"))
PROGRAM = os.environ.get("SCREE", str(BUILD / "bin" / "scree"))
WORK = pathlib.Path(os.environ.get("SCREE_EVIDENCE_WORK", ROOT / "build" / "evidence"))
DATA = pathlib.Path(os.environ.get("SCREE_EVIDENCE_DIR", ROOT.parent / "shared" / "evidence"))


def data(folder):
    """The folder of a case's measurements; without it the case is skipped."""
    path = DATA / folder
    if not path.is_dir():
        print(f"{pathlib.Path(sys.argv[0]).name}: skipped, there is no folder {path}; SCREE_EVIDENCE_DIR names another", file=sys.stderr)
        sys.exit(0)
    return path


def needs(code):
    """Another code's program, by its name's environment variable or in the PATH; without it the case is skipped."""
    path = shutil.which(os.environ.get(code, code.lower()))
    if not path:
        print(f"{pathlib.Path(sys.argv[0]).name}: skipped, {code} is not installed; the variable {code} names its program", file=sys.stderr)
        sys.exit(0)
    return path


def processor_time():
    """Seconds of this process and of the programs that it waited for."""
    return time.process_time() + os.times().children_user


def library():
    """The Python module of this checkout, on one thread: the runs are processes."""
    sys.path.insert(0, str(ROOT / "python"))
    for name in ("libscree.so", "libscree.dylib"):
        for path in BUILD.rglob(name):
            os.environ.setdefault("SCREE_LIBRARY", str(path))
    import scree
    scree.set_threads(1)
    return scree


def run(*words, folder=None):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, cwd=folder, stdout=subprocess.PIPE, text=True).stdout


def liggghts(template, folder, words, code="LIGGGHTS"):
    """Runs LIGGGHTS, or LAMMPS, in the folder on the template with its capital words replaced. Environment: LIGGGHTS, LMP (the
    programs)."""
    text = template.read_text()
    for name, value in words.items():
        text = text.replace(name, str(value))
    (folder / template.name).write_text(text)
    subprocess.run([needs(code), "-in", template.name, "-log", "none"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)


def read_stl(path):
    """Corners of the facets of a binary file."""
    return [(v[3:6], v[6:9], v[9:12]) for v in struct.iter_unpack("<12fH", pathlib.Path(path).read_bytes()[84:])]


def write_stl(path, triangles):
    lines = ["solid wall"]
    for corners in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex {:.9g} {:.9g} {:.9g}".format(*c) for c in corners), "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid wall"]) + "\n")


def commit():
    """Of this checkout; of a copy without its history what .commit says, if there is one."""
    if shutil.which("git"):
        told = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True).stdout.strip()
        if told:
            return told
    note = ROOT / ".commit"
    return note.read_text().strip() if note.exists() else "unknown"


class Table:
    """A CSV that grows by a row at a time: a run that was broken off goes on behind its last whole row."""

    def __init__(self, path, columns, key_count):
        self.path, self.columns, self.key_count, self.rows = pathlib.Path(path), columns, key_count, []
        if self.path.exists():
            lines = self.path.read_text().splitlines(keepends=True)
            whole = [line for line in lines if line.endswith("\n")]
            self.rows = list(csv.DictReader(line for line in whole if not line.startswith("#")))
            if len(whole) < len(lines):
                self.path.write_text("".join(whole))
        else:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            words = " ".join([pathlib.Path(sys.argv[0]).name, *sys.argv[1:]]).replace(f"{ROOT}/", "")
            self.path.write_text(f"# commit {commit()}; {words}\n" + ",".join(columns) + "\n")
        self.done = {self.key(row.values()) for row in self.rows}

    def key(self, values):
        return tuple(map(cell, values))[:self.key_count]

    def add(self, *values):
        with open(self.path, "a") as out:
            out.write(",".join(map(cell, values)) + "\n")
        self.rows.append(dict(zip(self.columns, map(str, values))))
        self.done.add(self.key(values))


def show(*values):
    """A row of a table on standard output."""
    print(",".join(cell(v) for v in values))


def cell(value):
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def read(path):
    with open(path) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def mean(values):
    return sum(values) / len(values)


def deviation(values):
    m = mean(values)
    return math.sqrt(sum((v - m) ** 2 for v in values) / (len(values) - 1))


def student(free):
    """Student's quantile 0.95, within 1 % from 3 degrees of freedom on."""
    return 1.645 * (1 + 0.93 / free)


def kolmogorov(a, b):
    """The largest distance between both distribution functions."""
    a, b, i, j, most = sorted(a), sorted(b), 0, 0, 0.0
    while i < len(a) and j < len(b):
        x = min(a[i], b[j])
        while i < len(a) and a[i] == x:
            i += 1
        while j < len(b) and b[j] == x:
            j += 1
        most = max(most, abs(i / len(a) - j / len(b)))
    return most


def kolmogorov_p(d, n, m):
    """Asymptotic p of two samples of one distribution (Stephens's correction)."""
    k = math.sqrt(n * m / (n + m))
    x = (k + 0.12 + 0.11 / k) * d
    return min(1.0, 2 * sum((-1) ** (i - 1) * math.exp(-2 * i * i * x * x) for i in range(1, 101))) if x > 0.2 else 1.0


def bootstrap(statistic, *samples, rounds=1000, level=0.9, seed=1):
    """Percentile interval; every sample is drawn anew, each by itself."""
    rng = random.Random(seed)
    values = sorted(statistic(*([s[rng.randrange(len(s))] for _ in s] for s in samples)) for _ in range(rounds))
    low = (1 - level) / 2
    return values[int(low * rounds)], values[min(rounds - 1, int((1 - low) * rounds))]


def main(run, compare, codes, usage):
    """`run TABLE CASES CODE...`, of these codes, or `compare TABLE`."""
    if sys.argv[1:2] == ["run"] and len(sys.argv) > 4 and set(sys.argv[4:]) <= set(codes):
        run(*sys.argv[2:4], sys.argv[4:])
    elif sys.argv[1:2] == ["compare"] and len(sys.argv) == 3:
        compare(sys.argv[2])
    else:
        sys.exit(usage)
