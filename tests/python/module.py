"""The Python module against closed forms, its own C library's facts, and refusals. Run with numpy and, by
SCREE_TEST_WITHOUT_NUMPY, without.
usage: module.py WORLD_WRITER (tests/vtk/world.c, which also writes the checkpoint of a scene)"""
import gc
import html.parser
import inspect
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import typing
import unittest
import xml.etree.ElementTree
import zipfile

if os.environ.get("SCREE_TEST_WITHOUT_NUMPY"):
    sys.modules["numpy"] = None  # import numpy fails
import scree
from scree import _values
from scree._library import lib

WORLD_WRITER = sys.argv.pop(1)
os.chdir(tempfile.mkdtemp())
SIDE = 0.06912  # of the sample box


def tetrahedron():
    return scree.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


class Interface(unittest.TestCase):
    def test_version(self):
        version = (pathlib.Path(__file__).parents[2] / "VERSION").read_text().strip()
        self.assertEqual((scree.__version__, scree.version()), (version, version))

    def test_hints(self):
        """Every public function says of what types its arguments and its answer are."""
        self.assertTrue((pathlib.Path(scree.__file__).parent / "py.typed").exists())
        functions = []
        for name in scree.__all__:
            thing = getattr(scree, name)
            members = vars(thing).items() if inspect.isclass(thing) else [(name, thing)]
            for key, member in members:
                member = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
                if inspect.isfunction(member) and (not key.startswith("_") or key == "__init__"):
                    functions.append(f"{name}.{key}")
                    hints = typing.get_type_hints(member, vars(sys.modules[member.__module__]))
                    wanted = {p for p in inspect.signature(member).parameters if p != "self" and p != "cls"} | {"return"}
                    self.assertEqual(wanted - set(hints), set(), functions[-1])
        self.assertGreater(len(functions), 80)

    def test_as_one_expects(self):
        tetrahedron().write("u.stl", unit="m")
        mesh = scree.Mesh("u.stl")
        self.assertEqual((mesh.source, len(mesh.vertices), len(mesh.faces)), ("u.stl", 4, 4))
        self.assertAlmostEqual(mesh.volume, 1 / 6)
        self.assertAlmostEqual(mesh.area, 1.5 + 3**0.5 / 2)
        self.assertEqual([list(row) for row in mesh.bounds], [[0, 0, 0], [1, 1, 1]])
        self.assertAlmostEqual(scree.Mesh("sample:box-12").describe().elongation, 1)
        with self.assertRaisesRegex(ValueError, "do you mean widths"):
            mesh.choose(tolerances={"width": 0.02})
        with self.assertRaisesRegex(ValueError, "do you mean mujoco"):
            mesh.export("mujocco")
        with self.assertRaisesRegex(scree.Error, "pfc takes clumps"):
            mesh.export("pfc")
        self.assertEqual((scree.codes()["deme"], scree.codes()["yade"], scree.codes()["pfc"]), ("mesh, clump", "clump, mesh", "clump"))
        choice = scree.sample("icosphere-3").choose(tolerances={"mean": 0.01})
        self.assertRegex(choice.answer, f"^Use {choice.recommended.triangle_count} triangles")
        for _ in range(2):  # a script may be run again
            self.assertEqual(choice.export("mujoco").piece_count, 1)
        self.assertTrue(pathlib.Path("icosphere-3-mujoco/icosphere-3.xml").exists())
        clumps = scree.sample("icosphere-2").clumps(most=3)
        self.assertEqual((len(clumps), clumps[0].sphere_count, clumps.recommended.sphere_count), (1, 1, 1))
        self.assertEqual(clumps.particle().measure().kind, "clump")
        clumps.write("spheres.csv")
        clumps.particle(1).export("pfc")

    @unittest.skipIf(_values.numpy is None, "a grid is an array")
    def test_distance_grid(self):
        """Of a ball: the radius less, and no more off than told."""
        import numpy
        ball = scree.sample("icosphere-4")
        grid = ball.distance_grid(24)
        grid.write("ball.npz")
        read = numpy.load("ball.npz")
        self.assertEqual(float(read["spacing"]), grid.spacing)
        places = [grid.origin[k] + grid.spacing * numpy.arange(n) for k, n in enumerate(grid.distances.shape)]
        x, y, z = numpy.meshgrid(*places, indexing="ij")
        wanted = numpy.sqrt(x * x + y * y + z * z) - 0.025
        self.assertLess(abs(read["distances"] - wanted).max(), 1e-4)
        self.assertLess(grid.mean_error, grid.error)
        self.assertLess(grid.error, 3**0.5 / 2 * grid.spacing)

    def test_notebooks(self):
        """Well-formed, with a picture where the library draws, and with texts as texts."""
        class Reader(html.parser.HTMLParser):
            def __init__(self):
                super().__init__()
                self.open, self.seen = [], []

            def handle_starttag(self, tag, attrs):
                self.seen.append(tag)
                self.open += [tag] if tag != "img" else []

            def handle_endtag(self, tag):
                assert self.open.pop() == tag

        scan = scree.sample("icosphere-2")
        scan.source = "<b>scan</b>"
        world = scree.World()
        world.add_body(scree.Particle(scan), world.add_material())
        with open("shown.yaml", "w") as file:
            file.write(Scenes.FILE)
        drawn = [scan, scan.choose(), scree.Particle.clump([[0, 0, 0], [1, 0, 0]], [1, 1]), world, scree.Scene("shown.yaml").run(0.05)]
        for thing in [*drawn, scan.measure(), scan.check()]:
            reader = Reader()
            reader.feed(thing._repr_html_())
            self.assertEqual((reader.open, "b" in reader.seen, "table" in reader.seen), ([], False, True))
            self.assertEqual("img" in reader.seen, thing in drawn and lib.build_has("rays") and lib.build_has("pictures"), thing)


class Meshes(unittest.TestCase):
    def test_numpy_is_as_asked(self):
        self.assertEqual(_values.numpy is None, bool(os.environ.get("SCREE_TEST_WITHOUT_NUMPY")) or
                         _values.numpy is None)
        if os.environ.get("SCREE_TEST_WITHOUT_NUMPY"):
            self.assertIsNone(_values.numpy)

    def test_tables(self):
        mesh = tetrahedron()
        self.assertEqual((mesh.vertex_count, mesh.triangle_count), (4, 4))
        self.assertEqual([list(p) for p in mesh.positions.tolist()][3], [0, 0, 1])
        self.assertEqual(mesh.triangles[1, 2], 3)
        with self.assertRaises((ValueError, TypeError)):
            mesh.positions[0, 0] = 1
        positions = tetrahedron().positions  # the table keeps its mesh alive
        gc.collect()
        self.assertEqual(positions[3, 2], 1)

    def test_measures(self):
        m = tetrahedron().measure()
        self.assertTrue(m.closed)
        self.assertAlmostEqual(m.volume, 1 / 6, 14)
        self.assertAlmostEqual(m.area, 1.5 + math.sqrt(3) / 2, 14)
        self.assertAlmostEqual(list(m.centroid)[0], 0.25, 14)
        t = tetrahedron().topology()
        self.assertEqual((t.edge_count, t.genus, t.manifold), (6, 0, True))

    def test_weld(self):
        corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0], [1, 0, 0]]
        self.assertEqual(scree.Mesh(corners, [[0, 1, 2], [3, 4, 5]], weld=True).vertex_count, 3)

    def test_files(self):
        tetrahedron().write("t.stl")
        mesh = scree.load("t.stl")
        self.assertEqual((mesh.format, mesh.source, mesh.triangle_count), ("STL binary", "t.stl", 4))
        self.assertNotEqual(mesh.checksum.high, 0)
        self.assertAlmostEqual(scree.load("t.stl", unit="m").measure().volume, 1e9 / 6, 0)
        tetrahedron().write("t.stl", unit="m", overwrite=True)
        self.assertAlmostEqual(scree.load("t.stl").measure().volume, 1 / 6, 6)
        self.assertEqual(scree.load("t.stl").warning, "")
        with self.assertRaises(scree.Error) as refused:
            tetrahedron().write("t.stl", overwrite=False)
        self.assertEqual(refused.exception.status, "EXISTS")
        tetrahedron().write("t.stl")
        with open("bad.stl", "w") as file:
            file.write("solid nothing")
        with self.assertRaisesRegex(scree.Error, "bad.stl: .*cut off") as refused:
            scree.load("bad.stl")
        self.assertEqual(refused.exception.status, "BAD_FILE")
        with self.assertRaisesRegex(ValueError, "no unit of length"):
            scree.load("t.stl", unit="furlong")

    def test_3mf(self):
        """The archive by Python's zip and XML: every bit of the positions, the unit, the triangles."""
        mesh = scree.Mesh([[0.1, 0, 0], [1 / 3, 0, 1e-9], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        for unit, name, scale in (("mm", "millimeter", 1e-3), ("m", "meter", 1)):
            mesh.write("t.3mf", unit=unit, overwrite=True, comment="a <b> & c")
            with zipfile.ZipFile("t.3mf") as archive:
                self.assertIsNone(archive.testzip())
                self.assertEqual(archive.namelist(), ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"])
                model = xml.etree.ElementTree.fromstring(archive.read("3D/3dmodel.model"))
            space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
            self.assertEqual(model.get("unit"), name)
            self.assertTrue(model.find(space + "metadata").text.endswith("a <b> & c"))
            vertices = [[float(v.get(k)) for k in "xyz"] for v in model.iter(space + "vertex")]
            triangles = [[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in model.iter(space + "triangle")]
            self.assertEqual(vertices, [[x / scale for x in p] for p in mesh.positions.tolist()])
            self.assertEqual(triangles, mesh.triangles.tolist())

    def test_refusals(self):
        with self.assertRaisesRegex(ValueError, "beyond the 3"):
            scree.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])
        with self.assertRaisesRegex(ValueError, "vertex 2 has a coordinate that is not finite: nan"):
            scree.Mesh([[0, 0, 0], [1, 0, 0], [0, float("nan"), 0]], [[0, 1, 2]])
        for wrong in (3, "a", [1, 2], tetrahedron, object()):
            with self.assertRaisesRegex(TypeError, "mesh is .*; a mesh is meant"):
                scree.Scene.template("drop-box", {"a": wrong})
        with self.assertRaisesRegex(TypeError, "radius is 'a'; a number is meant"):
            scree.Particle.sphere("a")
        with self.assertRaisesRegex(TypeError, "there are resolution, noise, seed"):
            scree.sample("fp-1", resolutoin=1e-3)
        with self.assertRaisesRegex(scree.Error, "no sample"):
            scree.load("sample:fp-9")
        with self.assertRaises(ValueError):
            tetrahedron().curve(method="best")

    def test_check_and_repair(self):
        open_mesh = scree.Mesh(tetrahedron().positions.tolist(), tetrahedron().triangles.tolist()[:3])
        check = open_mesh.check()
        self.assertFalse(check.usable)
        self.assertEqual((check.defects["boundary_edges"], check.volume), (3, None))
        repaired, report = open_mesh.repair()
        self.assertEqual((report.done["filled_holes"], report.after.usable), (1, True))
        self.assertAlmostEqual(repaired.measure().volume, 1 / 6, 12)

    def test_repair_options(self):
        box = scree.sample("box-12")
        twice = [p for dx in (0, 0.01) for p in ((x + dx, y + dx, z + dx) for x, y, z in box.positions.tolist())]
        n = len(box.positions)
        both = scree.Mesh(twice, box.triangles.tolist() + [[v + n for v in t] for t in box.triangles.tolist()])
        self.assertGreater(both.check().defects["overlapping_shell_pairs"], 0)
        self.assertFalse(both.check(intersections=False).intersections_known)
        merged, report = both.repair()
        self.assertEqual((merged.topology().shell_count, report.done["merged_shells"]), (1, 2))
        self.assertLess(merged.measure().volume, 1.99 * box.measure().volume)
        with self.assertRaises(scree.Error):
            both.repair(merge_shells=False)
        with self.assertRaises(scree.Error):
            scree.Mesh(tetrahedron().positions.tolist(), tetrahedron().triangles.tolist()[:3]).repair(hole_share=0)
        with self.assertRaisesRegex(TypeError, "merge_shells"):
            both.repair(merge=True)

    def test_distance(self):
        ball, fine = scree.load("sample:icosphere-2"), scree.load("sample:icosphere-4")
        d = fine.distance(ball, sample_count=1000)
        self.assertGreater(d.hausdorff, 0)
        self.assertGreaterEqual(d.hausdorff_bound, d.hausdorff)
        field = list(fine.distance_field(ball))
        self.assertEqual(len(field), fine.vertex_count)
        self.assertLessEqual(max(field), d.forward.maximum * (1 + 1e-12))

    def test_export(self):
        box = scree.load("sample:box-12")
        e = box.export("box.stl", "box.json", unit="m", principal=True, density=1000)
        self.assertAlmostEqual(e.mass, 1000 * SIDE**3, 12)
        self.assertAlmostEqual(e.inertia[0][0], e.mass * SIDE**2 / 6, 12)
        self.assertTrue(os.path.exists("box.json"))
        box.write_vtp("box.vtp", reference=box)


class Curves(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scan = scree.sample("fp-1", resolution=2e-3, noise=0.2e-3)

    def test_curve(self):
        curve = self.scan.curve()
        self.assertEqual(curve[0].triangle_count, self.scan.triangle_count)
        self.assertEqual(curve[-1].triangle_count, curve.facts.floor_count)
        self.assertEqual(curve.facts.method, "volume")
        index = curve.find(100)
        mesh = curve.mesh(index)
        fitted = curve.mesh(index, fit=True)
        self.assertEqual(fitted.triangle_count, mesh.triangle_count)
        self.assertEqual(mesh.triangle_count, curve[index].triangle_count)
        self.assertAlmostEqual(mesh.measure().volume / self.scan.measure().volume, 1, 12)
        with self.assertRaises(IndexError):
            curve[len(curve)]
        del curve.source_mesh  # the record holds its mesh by itself
        gc.collect()
        self.assertLessEqual(self.scan.simplify(count=50, method="qecd").triangle_count, 50)

    def test_choice(self):
        choice = self.scan.choose()
        self.assertEqual(len(choice.levels), 37)
        least = min(choice.levels, key=lambda level: level.ip)
        self.assertEqual(choice.paper.triangle_count, least.triangle_count)
        self.assertEqual(choice.mesh().triangle_count, choice.recommended.triangle_count)
        self.assertEqual(choice.mesh("robust").triangle_count, choice.robust.triangle_count)
        self.assertLess(choice.errors["mean_distance"], 0.003)
        looser = self.scan.choose(tolerances={"mean_distance": 0.02, "hausdorff": 0.1, "thickness": 1, "inertia": 1})
        self.assertLess(looser.recommended.triangle_count, choice.recommended.triangle_count)
        self.assertLessEqual({"area", "volume", "mean_distance", "hausdorff", "inertia", "widths"}, set(choice.best))
        self.assertGreater(len(choice.trace), 200)

    def test_progress(self):
        phases = []
        self.scan.curve(progress=lambda phase, fraction: phases.append(fraction))
        self.assertTrue(phases and all(0 <= fraction <= 1 for fraction in phases))
        with self.assertRaises(scree.Error) as refused:
            self.scan.curve(progress=lambda phase, fraction: False)
        self.assertEqual(refused.exception.status, "CANCELLED")
        with self.assertRaises(ZeroDivisionError):
            self.scan.curve(progress=lambda phase, fraction: 1 / 0)


class Worlds(unittest.TestCase):
    def world(self):
        world = scree.World(stiffness_factor=0.1)
        soft, hard = world.add_material(density=1000), world.add_material(wall=True)
        world.add_wall("plane", hard)
        self.box = scree.Particle(scree.load("sample:box-12"))
        ball = scree.Particle.sphere(0.03)
        world.add_body(self.box, soft, position=(0, 0, SIDE / 2 + 1e-3))
        world.add_body(ball, soft, position=(0.2, 0, 0.5), velocity=(0, 0, 0.5), angular_velocity=(0, 1, 0))
        return world

    def test_fall(self):
        world = self.world()
        world.step(100)
        t = world.time
        self.assertAlmostEqual(t, 100 * world.time_step, 12)
        ball = world.body(1)
        self.assertAlmostEqual(ball.position[2], 0.5 + 0.5 * t - 9.81 * t * t / 2, 5)
        self.assertAlmostEqual(ball.mass, 1000 * 4 / 3 * math.pi * 0.03**3, 12)
        world.run(0.1)
        self.assertGreaterEqual(world.time, t + 0.1 - 1e-12)
        contacts = world.contacts()
        self.assertTrue(contacts and all(k.wall and k.body == 0 for k in contacts))
        self.assertAlmostEqual(world.observe().time, world.time, 3)
        self.assertEqual(len(world.positions()), 2)
        force, _ = world.wall_force(0)
        self.assertLess(force[2], 0)

    def test_checkpoint_and_files(self):
        world = self.world()
        world.step(200)
        world.save("w.scree", overwrite=True)
        again = scree.World.load("w.scree")
        world.step(50)
        again.step(50)
        self.assertEqual(world.hash, again.hash)
        for view in "surfaces", "points", "contacts", "walls":
            world.write_vtp(view + ".vtp", view, overwrite=True)
        scree.write_pvd("w.pvd", ["surfaces.vtp"], [world.time], overwrite=True)
        world.export("pile", overwrite=True)
        self.assertTrue(os.path.exists("pile/shape-0.stl"))

    def test_bodies(self):
        world = self.world()
        world.set_body(1, velocity=(1, 2, 3))
        self.assertEqual(list(world.body(1).velocity), [1, 2, 3])
        with self.assertRaisesRegex(scree.Error, "body 1 is to be set to a state that is not finite"):
            world.set_body(1, position=(math.nan, 0, 0))
        world.remove_body(0)
        self.assertEqual(world.live(), [1])
        with self.assertRaises(IndexError):
            world.body(2)
        all_at_once = world.bodies()
        self.assertEqual(list(all_at_once.inside), [False, True])
        for i in range(2):
            for name, value in vars(world.body(i)).items():
                row = getattr(all_at_once, name)
                row = [row[i, k] for k in range(len(value))] if hasattr(value, "__len__") else row[i]
                self.assertEqual(row, list(value) if hasattr(value, "__len__") else value, name)
        measures = self.box.measure()
        self.assertEqual(measures.kind, "mesh")
        self.assertAlmostEqual(measures.volume, SIDE**3, 12)
        self.assertEqual(self.box.mesh().triangle_count, 12)
        clump = scree.Particle.clump([[0, 0, 0], [0.01, 0, 0]], [0.02, 0.02])
        self.assertEqual(clump.measure().point_count, 2)
        with self.assertRaises(ValueError):
            scree.Particle.clump([[0, 0, 0]], [1, 2])
        fitted = scree.Particle.clump_of(self.box.mesh(), 2).measure()
        self.assertEqual((fitted.kind, fitted.point_count), ("clump", 2))
        self.assertAlmostEqual(fitted.volume, SIDE**3, 12)
        with self.assertRaisesRegex(scree.Error, "1 to 300"):
            scree.Particle.clump_of(self.box.mesh(), 0)
        with self.assertRaises(TypeError):
            world.add_wall("plane", 1, colour="red")

    def test_joints_that_break(self):
        box = scree.Mesh([(x, y, z) for z in (0, .01) for y in (0, .01) for x in (0, .04)],
                         [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2),
                          (2, 4, 6), (1, 3, 5), (3, 7, 5)])
        pieces, faces = box.fracture(2, seed=3)
        self.assertAlmostEqual(sum(p.measure().volume for p in pieces), 4e-6, delta=1e-14)
        self.assertEqual([(f.a, f.b) for f in faces], [(0, 1)])
        world = scree.World(gravity=(0, 0, 0))
        material = world.add_material()
        for piece in pieces:
            particle = scree.Particle(piece)
            measures = particle.measure()
            world.add_body(particle, material, position=measures.centre, orientation=measures.orientation)
        self.assertEqual(world.add_joint(0, 1, faces[0], 1e8, tension=1e5), 0)
        self.assertEqual(list(world.fragments()), [0, 0])
        way = [1 if x > 0 else -1 for x in (pieces[1].measure().centroid[0] - pieces[0].measure().centroid[0],)][0]
        world.set_body(1, velocity=(way, 0, 0))
        world.run(0.01)
        (joint,) = world.joints()
        self.assertEqual((joint.state, joint.mode), ("open", "by_tension"))
        self.assertGreater(joint.fracture, 0)
        self.assertEqual(list(world.fragments()), [0, 1])
        with self.assertRaises(IndexError):
            world.add_joint(0, 2)
        sheet = scree.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        self.assertAlmostEqual(sheet.thicken(0.1).measure().volume, 0.05)

    def test_any_facets_as_a_wall(self):
        # two sides of a sheet that another stands on, wound anyhow
        points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0, 0), (0.5, 1, 0), (0.5, 0, 1), (0.5, 1, 1)]
        facets = [(0, 1, 2), (0, 3, 2), (0, 1, 3), (1, 2, 3), (4, 5, 7), (4, 7, 6)]
        soup, world = scree.Mesh(points, facets), scree.World()
        steel = world.add_material(wall=True)
        with self.assertRaisesRegex(scree.Error, r"wall: .* at the edge from \(0, 0, 0\).*scree_wall_mend"):
            world.add_wall("mesh", steel, mesh=soup)
        wall, mended = soup.as_wall()
        self.assertEqual((mended.doubled, mended.flat), (2, 0))
        self.assertEqual((mended.joined, wall.triangle_count), (2, 6))
        self.assertEqual(world.add_wall("mesh", steel, mesh=wall), 0)
        again, mended = wall.as_wall()
        self.assertEqual((again.triangle_count, mended.doubled, mended.joined), (6, 0, 0))

    def test_motions(self):
        world = scree.World(gravity=(0, 0, 0), time_step=5e-6)
        world.add_wall("plane", world.add_material(wall=True), surface_velocity=(0.5, 0, 0))
        world.set_wall_surface(0, (0.2, 0, 0))
        world.set_wall_motion(0, {"law": "positions", "table": [[0, 0], [0.01, 0.1]]},
                              {"turns": True, "speed": 2, "axis": (1, 0, 0), "until": 0.005})
        world.step(10)
        self.assertEqual(world.wall_power(0), (0, 0))
        for wrong, said in (({"law": "cosine"}, "law 'cosine' is none of"), ({"table": [[0, 1, 2]]}, "rows of 2"),
                            ({"colour": 1}, "wall_motion has no option 'colour'")):
            with self.assertRaisesRegex((ValueError, TypeError), said):
                world.set_wall_motion(0, wrong)
        ball = world.add_body(scree.Particle.sphere(0.01), world.add_material(), position=(0, 0, 1))
        self.assertEqual(world.set_pair(0, 1, rolling_friction=0.1).friction, 0.5)
        with self.assertRaisesRegex(scree.Error, "rolling friction -1; at least 0"):
            world.set_pair(0, 1, rolling_friction=-1)
        world.set_body_force(ball, (1e-3, 0, 0))
        world.step(100)
        self.assertGreater(world.bodies().velocity[ball, 0], 0)
        self.assertAlmostEqual(world.observe().applied_work, world.observe().kinetic, 9)

    def test_numbers_that_c_would_wrap(self):
        world, ball, box = self.world(), scree.Particle.sphere(0.01), scree.load("sample:box-12")
        before = world.hash
        for wrong in (lambda: world.step(-1), lambda: world.set_contact(0, -1, 0.5, 0.5),
                      lambda: world.add_wall("plane", -1), lambda: world.add_body(ball, -1),
                      lambda: world.run(-1), lambda: box.simplify(-1),
                      lambda: box.curve().find(-1), lambda: box.curve(stop_count=-1),
                      lambda: box.distance(box, sample_count=-1), lambda: scree.set_threads(-1),
                      lambda: scree.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, -1]])):
            with self.assertRaisesRegex(ValueError, "is -1"):
                wrong()
        for wrong in (lambda: world.step(2**64 + 1),
                      lambda: scree.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2**32 + 2]]),
                      lambda: box.curve().choose(per_decade=2**32 + 4)):
            with self.assertRaisesRegex(ValueError, "is (18446744073709551617|4294967298|4294967300)"):
                wrong()
        for duration in math.nan, math.inf:
            with self.assertRaisesRegex(ValueError, f"a duration is {duration} s"):
                world.run(duration)
            with self.assertRaisesRegex(ValueError, f"rp is {duration}"):
                box.simplify(rp=duration)
        with self.assertRaisesRegex(TypeError, "step_count is 2.5"):
            world.step(2.5)
        self.assertEqual((world.hash, len(world)), (before, 2))

    def test_vectors_that_c_would_fill_up(self):
        world, ball = self.world(), scree.Particle.sphere(0.01)
        before = world.hash
        for wrong, said in ((lambda: scree.World(gravity=(0, 0)), "world: gravity has 2 numbers; it takes 3"),
                            (lambda: scree.World(gravity=(0, 0, -9.81, 0)), "gravity has 4 numbers"),
                            (lambda: world.add_body(ball, 0, position=[1]), "position has 1 number; it takes 3"),
                            (lambda: world.add_body(ball, 0, orientation=(1, 0, 0)), "orientation has 3 numbers; it takes 4"),
                            (lambda: world.set_body(0, velocity=(1, 2)), "body: velocity has 2 numbers"),
                            (lambda: world.add_wall("disc", 1, radius=1, axis=(0, 1)), "wall: axis has 2 numbers"),
                            (lambda: world.set_wall_velocity(0, (1, 2)), "velocity has 2 numbers"),
                            (lambda: world.set_wall_velocity(0, angular_velocity=(1, 2, 3, 4)), "angular_velocity has 4 numbers")):
            with self.assertRaisesRegex(ValueError, said):
                wrong()
        with self.assertRaisesRegex(TypeError, "world: gravity is -9.81; 3 numbers"):
            scree.World(gravity=-9.81)
        self.assertEqual((world.hash, len(world)), (before, 2))


class Calibrations(unittest.TestCase):
    """A line with noise, by a command: what was measured is found again."""

    def test_a_line_is_found(self):
        with open("line.sh", "w") as file:
            file.write("awk -v a=$1 -v s=$2 'BEGIN { print \"answer:\", 10 * a + (s * 7919 % 101 - 50) / 500 }'\n")
        with open("line.yaml", "w") as file:
            file.write("experiments: {line: {command: [sh, '{here}/line.sh', '{a}', '{seed}']}}\n"
                       "parameters: {a: {from: 0, to: 1}}\n"
                       "targets: {t: {answer: answer, value: 3, uncertainty: 0.1}}\n"
                       "budget: {runs: 16}\n")
        found = scree.calibrate("line.yaml", "line")
        self.assertEqual(found.names, ["a"])
        self.assertAlmostEqual(found.parameters[0]["mean"], 0.3, delta=0.03)
        self.assertTrue(found.parameters[0]["identified"])
        values = [row[0] for row in (found.samples.tolist() if hasattr(found.samples, "tolist") else found.samples)]
        self.assertAlmostEqual(sum(values) / len(values), found.parameters[0]["mean"], delta=1e-9)
        again = scree.calibrate("line.yaml", "line")
        self.assertEqual(again.parameters, found.parameters)
        with self.assertRaisesRegex(ValueError, "is for scree.calibrate"):
            scree.optimise("line.yaml", "other")


class Scenes(unittest.TestCase):
    FILE = """
time: 0.2
materials: {m: {young: 1e5, density: 1000, restitution: 0.3, friction: 0.3}}
shapes: {ball: {sphere: 0.01}, brick: {box: [0.01, 0.008, 0.006]}}
geometry: {belt: {box: [2, 1, 0.1], at: [0, 0, -0.05], surface_velocity: [0.1, 0, 0]}}
inlets: {i: {box: {min: [-0.05, -0.05, 0], max: [0.05, 0.05, 0.05]}, shapes: {ball: 1, brick: 1}, count: 10}}
sensors: {all: {region: {box: {min: [-1, -1, -1], max: [1, 1, 1]}}}, belt: {wall: belt}}
output: {series: 0.05}
"""

    def setUp(self):
        with open("scene.yaml", "w") as file:
            file.write(self.FILE)

    def test_a_scene_runs(self):
        scene = scree.Scene("scene.yaml", {"inlets.i.count": 12, "inlets.i.velocity": [0, 0, -0.2]})
        seen = []
        scene.every(0.05, lambda s: seen.append(s.time))
        scene.run(0.1)
        self.assertIsNone(scene.end)
        self.assertAlmostEqual(scene.time, 0.1, delta=2 * scene.world.time_step)
        scene.run()
        self.assertEqual(scene.end, "the time is over")
        self.assertEqual([round(t, 2) for t in seen], [0, 0.05, 0.1, 0.15, 0.2])
        self.assertEqual(scene.sensors["all.count"], 12)
        self.assertEqual(scene.sensors["all.count.ball"], 6)
        self.assertEqual(scene.units()["belt.force_z"], "N")
        tables = scene.tables()
        self.assertEqual(list(tables), ["belt.map"])
        self.assertEqual([int(t) for t in tables["belt.map"]["triangle"]], list(range(12)))
        self.assertGreater(max(tables["belt.map"]["pressure"]), 0)
        self.assertEqual([round(t, 2) for t in scene.series()["time"]], [0, 0.05, 0.1, 0.15, 0.2])
        bodies = scene.bodies()
        self.assertEqual(len(bodies.position), 12)
        self.assertEqual(sum(bodies.inside), 12)
        self.assertEqual(sorted(set(bodies.shape)), [0, 1])
        book = scene.book()
        self.assertEqual(book.entered_count, book.inside_count + book.left_count)
        self.assertEqual(scene.inlets()["i"].count, 12)
        self.assertEqual(scene.outlets()[None].count, 0)
        self.assertIn("count: 12", str(scene))

    def test_saved_and_loaded(self):
        scene = scree.Scene("scene.yaml").run(0.05)
        scene.save("half.scree", overwrite=True)
        other = scree.Scene.load("half.scree").run()
        self.assertEqual(scene.run().world.hash, other.world.hash)

    def test_refusals(self):
        with self.assertRaisesRegex(scree.Error, "did you mean 'count'"):
            scree.Scene("scene.yaml", {"inlets.i.cuont": 12})
        with self.assertRaisesRegex(scree.Error, "no template 'silo'; there are hopper, drum"):
            scree.Scene.template("silo")
        self.assertIn("time:", scree.Scene.templates()["drum"])
        scene = scree.Scene("scene.yaml")
        with self.assertRaisesRegex(ValueError, "step_count is -1"):
            scene.step(-1)

        def stop(scene):
            raise KeyError("enough")

        scene = scree.Scene("scene.yaml")
        with self.assertRaisesRegex(TypeError, "cannot be called"):
            scene.every(0.01, 3)
        with self.assertRaisesRegex(ValueError, "until nan s"):
            scene.run(float("nan"))
        scene.every(0.01, stop)
        with self.assertRaisesRegex(KeyError, "enough"):
            scene.run()


class Templates(unittest.TestCase):
    REPOSE = {"particles": 8, "cylinder.diameter": 0.2, "disc.diameter": 0.6, "phases.pack_time": 0.3, "phases.lift_time": 0.2,
              "phases.settle_time": 0.1, "phases.hold_time": 0.1, "phases.lift_speed": 1, "phases.drop_height": 0.03,
              "preset": "demo"}

    def repose(self, **fields):
        scan = scree.sample("fp-1", resolution=4e-3, noise=0)
        shapes = {"phone": scan.simplify(count=40), "ball": scree.Particle.sphere(0.02)}
        return scree.Scene.template("repose", shapes, {**self.REPOSE, **fields})

    def test_a_heap_in_a_folder(self):
        seen = []
        with self.assertRaises(scree.Error) as refused:
            self.repose().complete("heap", progress=lambda phase, fraction: seen.append((phase, fraction)) or False)
        self.assertEqual((refused.exception.status, seen[0][0]), ("CANCELLED", "pack"))
        with self.assertRaises(ZeroDivisionError):
            self.repose().complete("heap", resume=True, progress=lambda phase, fraction: 1 / 0)
        scene = self.repose().complete("heap", resume=True)
        whole = self.repose().run()
        self.assertEqual((scene.end, scene.world.hash), (whole.end, whole.world.hash))
        self.assertEqual(scene.costs().piece_count, 3)
        self.assertEqual((scene.shapes, scene.phase), (["phone", "ball"], None))
        self.assertEqual(sorted(scene.bodies().shape), [0] * 4 + [1] * 4)
        motion, walls = scree.Motion("heap"), len(scene.geometry)
        self.assertEqual((len(motion), motion.body_count), (len(motion.time), walls + 8))
        self.assertEqual(motion.time[len(motion) - 1], scene.time)
        last = motion.poses[len(motion) - 1]
        for body in scene.world.live():
            for k in range(3):
                self.assertAlmostEqual(last[walls + body][k], scene.world.body(body).position[k], 6)
        heap = scene.piles()["heap"]
        self.assertFalse(heap.repose.heap)
        self.assertTrue(scene.piles(cell=0.005)["heap"].repose.peak > 0)
        with self.assertRaisesRegex(TypeError, "pile has no option 'colour'"):
            scene.piles(colour=1)
        page = scree.report("heap", "heap.html")
        self.assertGreater(os.path.getsize(page), 600000)
        shown = page._repr_html_()
        self.assertEqual(html.unescape(shown[shown.index('srcdoc="') + 8:shown.rindex('"')]), page.read_text(encoding="utf-8"))
        frame = scree.Scene.load("heap/last.scree")
        self.assertEqual((frame.is_frame, frame.time, frame.piles()["heap"].body_count), (True, scene.time, heap.body_count))
        with self.assertRaises(scree.Error):
            scree.Motion("heap/last.scree")
        with self.assertRaisesRegex(ValueError, "has no beginning"):
            frame.complete()

    def test_a_drop(self):
        box, ball = scree.load("sample:box-12"), scree.Particle.sphere(0.03)
        fields = {"particles": 7, "width": 0.4, "depth": 0.3, "seed": 5, "density": 1000, "contact.stiffness_factor": 0.01}
        scene = scree.Scene.template("drop-box", {"box": (box, 3), "ball": (ball, 4)}, fields)
        scene.complete()
        self.assertEqual((len(scene.world), list(scene.bodies().shape).count(1)), (7, 4))
        self.assertLess(abs(scene.book().ledger), 0.01)
        for x, y, z in scene.world.positions():
            self.assertTrue(abs(x) < 0.2 and abs(y) < 0.15 and z > 0)
        world = scene.world
        del scene  # its world keeps it
        gc.collect()
        self.assertEqual(len(world), 7)

    def test_refusals(self):
        ball = scree.Particle.sphere(0.03)
        with self.assertRaisesRegex(scree.Error, "too narrow"):
            scree.Scene.template("drop", {"ball": ball}, {"width": 0.05})
        with self.assertRaisesRegex(ValueError, "'a.b'"):
            scree.Scene.template("drop", {"a.b": ball})
        with self.assertRaisesRegex(scree.Error, "no preset 'huge'"):
            self.repose(preset="huge")


if __name__ == "__main__":
    unittest.main()
