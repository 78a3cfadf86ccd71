#!/usr/bin/env python3
"""Feeds a program mutated files of every format that it reads, as whole calls: none may crash, take more than 20 s, or
more than 2 GB. Made for a program with sanitizers, whose own exit code is 99 here; failures are kept in FOLDER.
usage: mutated.py PROGRAM [COUNT] [SEED] [FOLDER]"""
import concurrent.futures
import io
import os
import random
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

program = os.path.abspath(sys.argv[1])
count = int(sys.argv[2]) if len(sys.argv) > 2 else 10000
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
keep = os.path.abspath(sys.argv[4]) if len(sys.argv) > 4 else None
TIME, MEMORY = 20, 2000  # s, MB
os.environ["ASAN_OPTIONS"] = f"exitcode=99:hard_rss_limit_mb={MEMORY}:allocator_may_return_null=1"
os.environ["UBSAN_OPTIONS"] = "halt_on_error=1:exitcode=99:print_stacktrace=1"
os.environ["LSAN_OPTIONS"] = "print_suppressions=0:suppressions=" + os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lsan.supp")
os.environ["OMP_NUM_THREADS"] = "1"


def scree(*words, folder):
    subprocess.run([program, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def cube():
    points = [(x, y, z) for x in (0, 10) for y in (0, 10) for z in (0, 10)]
    return points, [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def ascii_stl():
    points, faces = cube()
    corners = "".join(f"facet normal 0 0 0\nouter loop\n{''.join('vertex %g %g %g' % points[v] + chr(10) for v in f)}endloop\nendfacet\n" for f in faces)
    return f"solid cube\n{corners}endsolid cube\n".encode()


def gltf(binary):
    points, faces = cube()
    data = b"".join(struct.pack("<3f", *p) for p in points) + b"".join(struct.pack("<3H", *f) for f in faces)
    source = "" if binary else ', "uri": "data:application/octet-stream;base64,' + __import__("base64").b64encode(data).decode() + '"'
    text = ('{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": [0.001, 0.001, 0.001]}], '
            '"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], '
            f'"buffers": [{{"byteLength": {len(data)}{source}}}], "bufferViews": [{{"buffer": 0, "byteLength": 96}}, {{"buffer": 0, "byteOffset": 96, "byteLength": 72}}], '
            '"accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [10, 10, 10]}, '
            '{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}').encode()
    if not binary:
        return text
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(data), len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data


SCENE = """time: 0.0005
materials: {grain: {young: 1e6, density: 2500}}
shapes: {ball: {sphere: 8 mm, material: grain}, rod: {clump: c.csv, unit: mm, material: grain}}
geometry: {floor: {plane: [0, 0, 1], material: grain}, plate: {box: [0.05, 0.05, 0.01], at: [0, 0, 0.2], material: grain, motion: [{path: {file: path.csv}}]}}
bodies: {file: bodies.csv}
inlets: {feed: {box: {min: [-0.05, -0.05, 0.1], max: [0.05, 0.05, 0.15]}, shapes: {ball: 2, rod: 1}, rate: 1000}}
outlets: {bin: {box: {min: [-1, -1, -1], max: [1, 1, -0.5]}}}
sensors: {through: {flow: {through: [0, 0, 0.05], normal: [0, 0, -1]}}}
output: {series: 0.0001}
"""
TABLES = {"bodies.csv": b"shape,x,y,z\nball,0,0,0.05\nrod,0.03,0,0.05\n", "path.csv": b"t [s],x,y,z\n0,0,0,0\n1,0.1,0,0\n",
          "c.csv": b"x,y,z,radius\n0,0,0,2\n3,0,0,1.5\n"}
STUDY = b"base: {preset: demo}\nunit: mm\nreplicates: 2\nshapes: [sample:box-12]\nfactors: {friction: [0.3, 0.6]}\n"
CALIBRATION = (b"experiments: {e: {scene: scene.yaml}}\nparameters: {friction: {field: materials.grain.friction, from: 0.1, to: 0.9}}\n"
               b"targets: {mass: {experiment: e, answer: through.count, value: 3, uncertainty: 1}}\nstart: {points: 6}\nbatch: 2\nbudget: {runs: 12}\n")


def picture():
    """A dark heap on white, 8 bits of grey, as PNG."""
    rows = b"".join(b"\0" + bytes(20 if 60 - abs(x - 80) * 0.6 > 119 - y else 240 for x in range(160)) for y in range(120))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 160, 120, 8, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def seeds(folder):
    """{kind: (bytes, name of the file, words of the call)}; tables lie beside it."""
    os.makedirs(folder)
    for name, text in {"scene.yaml": SCENE.encode(), **TABLES}.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(text)
    made = {}
    for ending in ("stl", "ply", "obj", "off", "3mf"):
        scree("sample", "icosphere-1", "-o", f"ball.{ending}", folder=folder)
    scree("run", "scene.yaml", "-o", "ran", "--no-picture", folder=folder)
    scree("choose", "ball.ply", "-o", "chosen", folder=folder)
    for name in sorted(os.listdir(folder)):
        if name.startswith("ball."):
            made[name[5:]] = name, ["check", name]
    for name, text in (("text.stl", ascii_stl()), ("cube.gltf", gltf(False)), ("cube.glb", gltf(True)), ("study.yaml", STUDY), ("calibrate.yaml", CALIBRATION), ("picture.png", picture())):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(text)
        made[name] = name, ["check", name]
    run = ["run", "scene.yaml", "-o", "out", "-f", "--no-picture"]
    made.update({name: (name, run) for name in ("scene.yaml", *TABLES)})
    made["table"] = "c.csv", ["export", "c.csv", "--to", "yade", "-o", "out", "-f"]
    made["study.yaml"] = "study.yaml", ["study", "study.yaml", "--dry-run"]
    made["calibrate.yaml"] = "calibrate.yaml", ["calibrate", "calibrate.yaml", "--dry-run"]
    made["checkpoint"] = "ran/checkpoint.scree", ["export", "ran/checkpoint.scree", "-o", "out.csv", "-f"]
    made["resumed"] = "ran/checkpoint.scree", ["run", "--resume", "-o", "ran", "--no-picture"]
    for name in ("ran/motion.scree", "ran/result.json", "ran/series.csv", "chosen/choice.json", "chosen/ball.curve.csv", "chosen/provenance.json"):
        made[name] = name, ["report", name.split("/")[0], "-o", "out.html", "-f"]
    made["picture.png"] = "picture.png", ["pile", "picture.png", "--picture-width", "0.3m"]
    return {kind: (open(os.path.join(folder, name), "rb").read(), name, words) for kind, (name, words) in made.items()
            if os.path.exists(os.path.join(folder, name))}


NUMBERS = [b"0", b"-1", b"1e308", b"-1e308", b"1e-320", b"nan", b"inf", b"4294967296", b"18446744073709551616", b"2147483647", b"", b"1,5", b"x"]


def mutate(data, rng, others):
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        at = rng.randrange(len(data) + 1)
        size = min(rng.choice((1, 2, 4, 8, 64, 1000)), len(data) - at)
        how = rng.randrange(8)
        if how == 0 and at < len(data):
            data[at] ^= 1 << rng.randrange(8)
        elif how == 1:
            data[at:at + size] = rng.randbytes(size)
        elif how == 2:
            del data[at:at + size]
        elif how == 3:
            data[at:at] = bytes(data[at:at + size]) * rng.choice((1, 2, 100))
        elif how == 4:
            del data[at:]
        elif how == 5:
            numbers = list(re.finditer(rb"[-+]?\d+(\.\d*)?(e[-+]?\d+)?", bytes(data[:100000])))
            if numbers:
                begin, end = rng.choice(numbers).span()
                data[begin:end] = rng.choice(NUMBERS)
        elif how == 6 and size >= 4:
            data[at:at + 4] = struct.pack("<I", rng.choice((0, 1, 0x7FFFFFFF, 0xFFFFFFFF, 0x10000, rng.getrandbits(32))))
        elif how == 7:
            other = rng.choice(others)
            begin = rng.randrange(len(other) + 1)
            data[at:at + size] = other[begin:begin + rng.choice((4, 64, 1000))]
    return bytes(data)


def mutate_zip(data, rng, others):
    """The members of an archive whose checksums hold."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            content = old.read(name)
            new.writestr(name, mutate(content, rng, others) if name.endswith(".model") else content)
    return out.getvalue()


def call(words, folder, well):
    """Why the call failed; "" where it is well, or refused what it was given. Its time is the processor's: others are at work."""
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen([program, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (TIME, TIME + 1)))
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().decode(errors="replace")[-3000:]
    if used.ru_utime + used.ru_stime >= TIME:
        return f"more than {TIME} s"
    if used.ru_maxrss > 1000 * MEMORY:
        return f"{used.ru_maxrss / 1e3:.0f} MB"
    return "" if child.returncode in well else f"exit code {child.returncode}: {text}"


def try_one(number, made, root):
    rng = random.Random(f"{seed} {number}")
    kinds = sorted(made)
    kind = kinds[number % len(kinds)]
    data, name, words = made[kind]
    others = [made[k][0] for k in kinds]
    changed = mutate_zip(data, rng, others) if kind == "3mf" and rng.random() < 0.7 else mutate(data, rng, others)
    if number < len(kinds):
        changed = data  # which must be read, or mutants of it tell nothing
    folder = os.path.join(root, str(number))
    os.makedirs(folder)
    for entry in os.listdir(os.path.join(root, "seeds")):
        source, target = os.path.join(root, "seeds", entry), os.path.join(folder, entry)
        if os.path.isdir(source) and name.startswith(entry + "/"):
            shutil.copytree(source, target)
        elif entry in TABLES or entry == "scene.yaml":
            shutil.copy(source, target)
    with open(os.path.join(folder, name), "wb") as file:
        file.write(changed)
    words = list(words)
    if words[0] == "check" and number >= len(kinds):
        words = rng.choice([words, words, words, ["repair", words[1], "-o", "out.ply", "-f"], ["measure", words[1]]])
    why = call(words, folder, (0,) if number < len(kinds) else (0, 1, 2))
    if why and keep:
        shutil.copytree(folder, os.path.join(keep, str(number)), dirs_exist_ok=True)
    shutil.rmtree(folder)
    return number, kind, words, why


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as root:
        made = seeds(os.path.join(root, "seeds"))
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for number, kind, words, why in pool.map(lambda n: try_one(n, made, root), range(count)):
                if why:
                    failed += 1
                    print(f"{number} ({kind}: {' '.join(words)}): {why}", flush=True)
    print(f"{count} files of {len(made)} kinds, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
