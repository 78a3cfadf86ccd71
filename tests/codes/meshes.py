"""Meshes in other codes: a camera, a phone and a stone go to all that take meshes. Mass and moments are checked against sums
over the files' own triangles; a code that is there runs what was written, and must find the same mass and moments, no turn
in free fall, and the body at rest where scree has it at rest. A code that is not there is replaced by one that notes what its
script asks for.
usage: meshes.py BUILD_FOLDER (mujoco-js of npm goes there)"""
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import scree

BUILD, HERE = pathlib.Path(sys.argv.pop(1)), pathlib.Path(__file__).resolve().parent
FOLDER = pathlib.Path(tempfile.mkdtemp())
DENSITY, COUNT, POSES = 1800, 5, 10


def stone():
    ball = scree.sample("icosphere-2")
    rows = [list(p) for p in ball.positions.tolist()]
    grown = [[x * (1 + 0.25 * math.sin(140 * y + 1) + 0.2 * math.cos(90 * z)) for x in (px, py, pz)] for px, py, pz in rows
             for y, z in [(py, pz)]]
    return scree.Mesh(grown, ball.triangles.tolist())


def integrals(points, triangles):
    """Volume, centre and inertia tensor about the origin, density 1, by signed tetrahedra."""
    volume, first, second = 0.0, [0.0] * 3, [[0.0] * 3 for _ in range(3)]
    for a, b, c in ([points[i] for i in t] for t in triangles):
        d = sum(a[i] * (b[i - 2] * c[i - 1] - b[i - 1] * c[i - 2]) for i in range(3))
        s = [a[i] + b[i] + c[i] for i in range(3)]
        volume += d / 6
        for i in range(3):
            first[i] += d * s[i] / 24
            for j in range(3):
                second[i][j] += d * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]) / 120
    trace = sum(second[i][i] for i in range(3))
    return volume, first, [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]


def turned(q, v):
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]]


def down(q):
    """The direction of the floor, as the body sees it."""
    return turned((q[0], -q[1], -q[2], -q[3]), [0, 0, -1])


def angle_deg(u, v):
    cross = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
    return math.degrees(math.atan2(math.hypot(*cross), sum(a * b for a, b in zip(u, v))))


def poses_of(particle):
    """Where scree has it at rest on a plane, from POSES turns."""
    found, points = [], particle.mesh().positions.tolist()
    for k in range(POSES):
        world = scree.World(law="hertz")
        plastic, floor = world.add_material(density=DENSITY, friction=0.8, restitution=0.1), world.add_material(wall=True)
        world.add_wall("plane", floor)
        turn = [math.cos(k), *(math.sin(k) * x / math.sqrt(14) for x in ((1, 2, 3), (3, 1, 2), (2, 3, 1))[k % 3])]
        height = 1.05 * max(-turned(turn, p)[2] for p in points)
        world.add_body(particle, plastic, position=(0, 0, height), orientation=turn)
        for _ in range(20):
            world.run(0.5)
            state = world.body(0)
            if math.hypot(*state.velocity, *state.angular_velocity) < 1e-3:
                break
        found.append({"height": float(state.position[2]), "turn": [float(x) for x in state.orientation]})
    return found


class Exported:
    def __init__(self, name, mesh):
        self.name, self.mesh = name, mesh
        self.particle = scree.Particle(mesh)
        self.facts = self.particle.measure()
        self.mass = DENSITY * self.facts.volume
        self.inertia = [DENSITY * x for x in self.facts.inertia]
        self._poses = None

    @property
    def poses(self):
        self._poses = self._poses or poses_of(self.particle)
        return self._poses

    def to(self, code, **more):
        folder = FOLDER / f"{self.name}-{code}"
        self.particle.export(code, folder, density=DENSITY, particles=COUNT, **more)
        return folder, self.particle_files(folder)

    def particle_files(self, folder):
        return {path.name: path for path in folder.iterdir()}


BODIES = [Exported("camera", scree.sample("dc-1", resolution=2e-3).simplify(140)),
          Exported("phone", scree.sample("fp-1", resolution=2e-3).simplify(140)), Exported("stone", stone().simplify(60))]
MESH_CODES = [code for code, kinds in scree.codes().items() if "mesh" in kinds]


class Checks(unittest.TestCase):
    def near(self, found, wanted, share, scale=None):
        self.assertLessEqual(abs(found - wanted), share * abs(scale or wanted), (found, wanted))

    def check_solid(self, body, points, triangles, share=1e-9):
        """Outward and closed, of the body's volume, about its centre, along its axes."""
        self.assertEqual(sorted((t[i - 1], t[i]) for t in triangles for i in range(3)),
                         sorted((t[i], t[i - 1]) for t in triangles for i in range(3)))
        volume, first, inertia = integrals(points, triangles)
        self.near(DENSITY * volume, body.mass, share)
        for i in range(3):
            self.near(first[i], 0, share, volume * body.facts.size)
            for j in range(3):
                self.near(DENSITY * inertia[i][j], body.inertia[i] if i == j else 0, share, body.inertia[2])

    def each(self, code, **more):
        for body in BODIES:
            folder, files = body.to(code, **more)
            for path in files.values():
                self.assertNotRegex(path.read_bytes(), rb"\b(nan|inf)\b|\{\{|@each|@let")
            yield body, folder


class Files(Checks):
    def test_twice(self):
        """Into the same folder again, and not where that is refused."""
        BODIES[2].particle.export("deme", FOLDER / "twice")
        BODIES[2].particle.export("deme", FOLDER / "twice")
        with self.assertRaises(scree.Error) as refused:
            BODIES[2].particle.export("deme", FOLDER / "twice", overwrite=False)
        self.assertEqual(refused.exception.status, "EXISTS")

    def test_shapes_of_rockable(self):
        for code in ("rockable", "exadem"):
            for body, folder in self.each(code):
                text = (folder / "particle.shp").read_text()
                words = text[:text.index(">")].split()

                def numbers(key, count, kind=float):
                    at = words.index(key) + 1
                    return [kind(x) for x in words[at:at + count]]

                nv, ne, nf = (numbers(key, 1, int)[0] for key in ("nv", "ne", "nf"))
                self.assertEqual(nv - ne + nf, 2)
                flat, ends = numbers("nv", 1 + 3 * nv)[1:], numbers("ne", 1 + 2 * ne, int)[1:]
                rows = numbers("nf", 1 + 4 * nf, int)[1:]
                points = [flat[k:k + 3] for k in range(0, 3 * nv, 3)]
                triangles = [rows[k + 1:k + 4] for k in range(0, 4 * nf, 4)]
                self.check_solid(body, points, triangles)
                self.assertEqual({tuple(sorted(ends[k:k + 2])) for k in range(0, 2 * ne, 2)},
                                 {tuple(sorted((t[i - 1], t[i]))) for t in triangles for i in range(3)})
                self.near(numbers("volume", 1)[0], body.facts.volume, 1e-9)
                for found, wanted in zip(numbers("I/m", 3), body.inertia):
                    self.near(found, wanted / body.mass, 1e-9)
                extent, centre, radius = numbers("obb.extent", 3), numbers("obb.center", 3), numbers("radius", 1)[0]
                for point in points:
                    self.assertTrue(all(abs(p - c) + radius <= e * (1 + 1e-9) for p, c, e in zip(point, centre, extent)))
                heap = next(folder.glob("*-heap.txt"), None) or folder / "particle-heap.conf"
                rows = re.findall(r"^particle 1 0 1 (.*)$", heap.read_text(), re.M)
                self.assertEqual([len(row.split()) for row in rows], [19] * COUNT)
                if code == "exadem":
                    self.check_yaml(folder)

    def check_yaml(self, folder):
        try:
            import yaml
        except ImportError:
            return
        for path in folder.glob("*.msp"):
            self.assertIsInstance(yaml.safe_load(path.read_text()), dict)

    def read_obj(self, path):
        points, triangles = [], []
        for line in path.read_text().splitlines():
            word, *rest = line.split()
            if word == "v":
                points.append([float(x) for x in rest])
            elif word == "f":
                triangles.append([int(x) - 1 for x in rest])
        return points, triangles

    def run_with(self, script, argv, modules):
        scope = {"__name__": "__main__", "__file__": str(script)}
        with mock.patch.dict(sys.modules, modules), mock.patch.object(sys, "argv", [str(script), *argv]), mock.patch("builtins.print"):
            exec(compile(script.read_text(), str(script), "exec"), scope)
        return scope

    def test_scripts_of_engines(self):
        """OBJ and script; engine and bodies are stand-ins that note the calls."""
        for code, module in (("deme", "deme"), ("chrono", "pychrono")):
            for body, folder in self.each(code):
                self.check_solid(body, *self.read_obj(folder / "particle.obj"))
                for argv, count in (([], COUNT), (["1"], 1)):
                    engine = mock.MagicMock()
                    solver = engine.DEMSolver.return_value
                    solver.Track.return_value.Pos.return_value = [0, 0, 1]
                    engine.ChSystemNSC.return_value.GetChTime.side_effect = [0, 1e9]
                    engine.ChBody.return_value.GetPos.return_value.z = 1.0
                    scope = self.run_with(folder / "particle.py", argv, {module: engine})
                    self.near(scope["MASS"], body.mass, 1e-9)
                    for found, wanted in zip(scope["INERTIA"], body.inertia):
                        self.near(found, wanted, 1e-9)
                    added = solver.AddMeshFromTemplate if code == "deme" else engine.ChBody
                    self.assertEqual(added.call_count, count)

    def test_blender(self):
        for body, folder in self.each("blender"):
            data = (folder / "particle.glb").read_bytes()
            magic, version, length, json_length, kind = struct.unpack_from("<4sIII4s", data)
            self.assertEqual((magic, version, length, kind), (b"glTF", 2, len(data), b"JSON"))
            document = json.loads(data[20:20 + json_length])
            binary_length, kind = struct.unpack_from("<I4s", data, 20 + json_length)
            self.assertEqual((kind, binary_length), (b"BIN\0", document["buffers"][0]["byteLength"]))
            binary = data[28 + json_length:]
            count, corners = (a["count"] for a in document["accessors"])
            flat = struct.unpack_from(f"<{3 * count}f", binary)
            ends = struct.unpack_from(f"<{corners}I", binary, 12 * count)
            rows = [flat[k:k + 3] for k in range(0, 3 * count, 3)]
            self.assertEqual([min(r[i] for r in rows) for i in range(3)],
                             [struct.unpack("<f", struct.pack("<f", x))[0] for x in document["accessors"][0]["min"]])
            # Blender turns y up into z up
            self.check_solid(body, [[x, -z, y] for x, y, z in rows], [ends[k:k + 3] for k in range(0, corners, 3)], 1e-5)
            extras = document["nodes"][0]["extras"]
            self.near(extras["mass_kg"], body.mass, 1e-9)
            read = scree.load(folder / "particle.glb")
            self.near(read.volume, body.facts.volume, 1e-5)
            bpy = mock.MagicMock()
            bpy.context.selected_objects = [mock.MagicMock()]
            bpy.context.selected_objects[0].matrix_world.translation.z = 1.0
            bpy.context.selected_objects[0].copy.return_value.matrix_world.translation.z = 1.0
            bpy.context.selected_objects[0].__getitem__.return_value = 1.0
            self.run_with(folder / "particle.py", [], {"bpy": bpy})
            self.assertEqual(bpy.ops.rigidbody.object_add.call_count, COUNT + 1)

    def test_pieces(self):
        """Convex, apart, and of the volume told."""
        for body, folder in self.each("mujoco"):
            text = (folder / "particle-assets.xml").read_text()
            pieces = [[float(x) for x in found.split()] for found in re.findall(r'vertex="([^"]*)"', text)]
            told = body.particle.export("mujoco", folder, density=DENSITY)
            self.assertEqual(len(pieces), told.piece_count)
            self.assertLessEqual(max(told.volume_error, told.inertia_error), 0.02)
            self.assertGreaterEqual(told.volume_error, -1e-9)
            few = body.particle.export("mujoco", FOLDER / "few", pieces=2)
            self.assertLessEqual(few.piece_count, 2 if told.piece_count > 2 else told.piece_count)


class Runs(Checks):
    """By the codes themselves."""

    def check_rest(self, body, turns):
        off = [angle_deg(down(q), down(p["turn"])) for q, p in zip(turns, body.poses)]
        self.assertGreaterEqual(sum(a < 1 for a in off) * 10, 9 * len(off), (body.name, off))

    def mujoco(self):
        module = BUILD / "mujoco/node_modules/mujoco-js/dist/mujoco_wasm.js"
        if not shutil.which("node"):
            self.skipTest("no node")
        if not module.exists() and shutil.which("npm"):
            (BUILD / "mujoco").mkdir(exist_ok=True)
            subprocess.run(["npm", "install", "--silent", "--no-save", "--prefix", BUILD / "mujoco", "mujoco-js@0.0.7"], check=False,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if not module.exists():
            self.skipTest("no mujoco-js, and none to be had")
        return module

    def test_mujoco(self):
        module = self.mujoco()
        for body, folder in self.each("mujoco"):
            (FOLDER / "poses.json").write_text(json.dumps(body.poses))
            said = json.loads(subprocess.run(["node", HERE / "mujoco.mjs", module, folder, "particle", FOLDER / "poses.json"], check=True,
                                             stdout=subprocess.PIPE, text=True).stdout)
            self.near(said["mass"], body.mass, 1e-6)
            for found, wanted in zip(sorted(said["inertia"]), body.inertia):
                self.near(found, wanted, 1e-6)
            self.near(said["fall"]["velocity"][2], -9.81 * said["fall"]["time"], 1e-6)
            self.assertLess(max(map(abs, said["fall"]["velocity"][3:])), 1e-9)
            self.check_rest(body, [rest["turn"] for rest in said["rest"]])
            self.assertEqual(said["heap"]["count"], COUNT)
            self.assertGreater(said["heap"]["lowest"], 0)

    def test_lammps(self):
        if not shutil.which("lmp"):
            self.skipTest("no lmp")
        for body, folder in self.each("lammps"):
            script = (folder / "in.particle").read_text()
            step = float(re.search(r"^timestep (\S+)", script, re.M)[1])
            spin, rows = 1e-3 * body.inertia[0], []
            # about each axis: the energy of rotation says the moment
            for axis in range(3):
                momentum = [spin if k == axis else 0 for k in range(3)]
                more = ("compute rotation all temp/body dof rotate\ncompute_modify rotation extra/dof 0\n"
                        f"set atom 1 angmom {momentum[0]:.12g} {momentum[1]:.12g} {momentum[2]:.12g}\n"
                        "thermo_style custom step c_rotation\nthermo_modify format float %.15g\nrun 0\n")
                alone = re.sub(r"^variable steps.*", more, script, flags=re.M)
                alone = re.sub(r"^run \$\{steps\}.*", "", alone, flags=re.M)
                rows.append(float(re.search(r"^ +0 +([0-9.e+-]+) *$", self.lammps(folder, alone, "heap 0"), re.M)[1]))
            # LAMMPS sorts the axes, and turns the body so
            found = sorted(spin**2 / (3 * 1.3806504e-23 * temperature) for temperature in rows)
            for moment, wanted in zip(found, body.inertia):
                self.near(moment, wanted, 1e-6)
            steps = int(0.5 * math.sqrt(2 * body.facts.bounding_radius / 9.81) / step)
            fall = re.sub(r"^dump bodies all custom \d+", f"dump bodies all custom {steps}", script, flags=re.M)
            self.lammps(folder, fall, "heap 0", f"steps {steps}")
            last = [float(x) for x in (folder / "bodies.dump").read_text().splitlines()[-1].split()]
            self.near(last[1], body.mass, 1e-6)
            self.near(last[7], -9.81 * steps * step, 1e-6)
            self.assertEqual(last[8:], [0, 0, 0])
            self.assertEqual(self.lammps(folder, script, "steps 100").count("Created 1 atoms"), COUNT)

    def lammps(self, folder, script, *variables):
        (folder / "in.test").write_text(script)
        words = [word for variable in variables for word in ("-var", *variable.split())]
        ran = subprocess.run(["lmp", "-in", "in.test", "-log", "none", *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                             text=True, env={**os.environ, "OMP_NUM_THREADS": "1"}, timeout=300)
        self.assertEqual(ran.returncode, 0, ran.stdout[-2000:])
        return ran.stdout

    def test_yade(self):
        if not shutil.which("yade"):
            self.skipTest("no yade")
        for body, folder in self.each("yade", pieces=12):
            checks = ("s = start([(0, 0, 50, 0.8, 0.36, 0.48, 0)])[0]\n"
                      "print('CENTRE', (s.pos - Vector3(0, 0, 50)).norm())\nbefore = O.time\nO.run(500, True)\n"
                      "print('FALL', s.mass, *s.inertia, s.vel[2], s.angVel.norm(), O.time - before)\n"
                      "states = start(POSES)\n"
                      "def tell(word):\n"
                      "    for s in states:\n        print(word, s.ori[3], s.ori[0], s.ori[1], s.ori[2])\n"
                      "tell('FIRST')\nO.run(int(0.1 / O.dt), True)\ntell('LAST')\n")
            reach = 3 * body.facts.bounding_radius
            # YADE takes its time: of poses alike, which differ by a turn about the vertical, one
            alike = {}
            for p in body.poses:
                alike.setdefault(tuple(round(x, 2) for x in down(p["turn"])), []).append(p)
            poses = [(k * reach, 0, p["height"], *p["turn"]) for k, (p, *_) in enumerate(alike.values())]
            (folder / "test.py").write_text((folder / "particle.py").read_text() + f"\nPOSES = {poses}\n" + checks)
            ran = subprocess.run(["yade", "-n", "-x", "test.py"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 env={**os.environ, "SCREE_ONLY_DEFINE": "1", "OMP_NUM_THREADS": "1"}, timeout=1500).stdout

            def said(word):
                rows = [[float(x) for x in line.split()[1:]] for line in ran.splitlines() if line.startswith(word)]
                self.assertTrue(rows, ran[-2000:])
                return rows
            self.assertLess(said("CENTRE")[0][0], 1e-9)
            mass, *inertia, speed, spin, time = said("FALL")[0]
            self.near(mass, body.mass, 1e-6)
            for found, wanted in zip(sorted(inertia), body.inertia):
                self.near(found, wanted, 1e-6)
            self.near(speed, -9.81 * time, 1e-6)
            self.assertLess(spin, 1e-9)
            # the axes that YADE finds may point the other way: what counts is how far it tips from its first pose
            off = [angle_deg(down(last), down(first)) for first, last in zip(said("FIRST"), said("LAST"))]

            kept = sum(len(all_of) for all_of, a in zip(alike.values(), off) if a < 1)
            self.assertGreaterEqual(kept * 10, 9 * POSES, (body.name, off))


if __name__ == "__main__":
    unittest.main()
