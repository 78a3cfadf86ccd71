"""What lives how long, in whose hands: every public class copied, pickled and let go of; threads; memory.
Run with numpy and, by SCREE_TEST_WITHOUT_NUMPY, without."""
import copy
import gc
import inspect
import multiprocessing
import os
import pathlib
import pickle
import sys
import tempfile
import threading
import unittest

if os.environ.get("SCREE_TEST_WITHOUT_NUMPY"):
    sys.modules["numpy"] = None  # import numpy fails
import scree
from scree._library import lib

os.chdir(tempfile.mkdtemp())
pathlib.Path("scene.yaml").write_text("""
time: 0.05
materials: {m: {young: 1e5, density: 1000, restitution: 0.3, friction: 0.3}}
shapes: {ball: {sphere: 0.01}, brick: {box: [0.01, 0.008, 0.006]}}
geometry: {belt: {box: [2, 1, 0.1], at: [0, 0, -0.05], surface_velocity: [0.1, 0, 0]}}
inlets: {i: {box: {min: [-0.05, -0.05, 0], max: [0.05, 0.05, 0.05]}, shapes: {ball: 1, brick: 1}, count: 10}}
output: {series: 0.01}
""")


def mesh():
    return scree.sample("icosphere-2")


def world():
    made = scree.World(stiffness_factor=0.01)
    grain = made.add_material()
    made.add_wall("plane", made.add_material(wall=True))
    for particle, z in ((scree.Particle(mesh()), 0.05), (scree.Particle.sphere(0.02), 0.2),
                        (scree.Particle.clump([[0, 0, 0], [0.01, 0, 0]], [0.02, 0.01]), 0.3)):
        made.add_body(particle, grain, position=(0, 0, z))
    made.step(100)
    return made


def scene():
    return scree.Scene("scene.yaml").run(0.01)


def heap():
    """Of shapes and particles that Python made."""
    made = scree.Scene.template("drop", {"ball": scree.Particle.sphere(0.03), "mesh": mesh()}, {"particles": 4})
    made.step(50)
    return made


def motion():
    scree.Scene("scene.yaml").complete("moved", overwrite=True)
    return scree.Motion("moved")


def rows(table):
    return table.tolist() if hasattr(table, "tolist") else table


def facts(thing):
    """What of a thing must be the same in a copy."""
    values = {scree.Mesh: lambda m: (rows(m.positions), rows(m.triangles), m.source),
              scree.Particle: lambda p: str(p.measure()) + str(facts(p.mesh()) if p.mesh().triangle_count else ""),
              scree.Curve: lambda c: (str(c.facts), str(c[len(c) // 2]), facts(c.mesh(c.find(40)))),
              scree.Choice: lambda c: (str(c.recommended), str(c.levels), facts(c.mesh())),
              scree.Clumps: lambda c: (len(c), str(c[0])),
              scree.World: lambda w: (w.hash, w.time),
              scree.Scene: lambda s: (s.world.hash, str(s.sensors), str(s.book()), len(s._hooks)),
              scree.Motion: lambda m: (str(m.poses), m.body_count),
              scree.Record: str,
              scree.Error: lambda e: (str(e), e.status)}
    return next(of for kind, of in values.items() if isinstance(thing, kind))(thing)


def error():
    try:
        scree.load("missing.stl")
    except scree.Error as refused:
        return refused


MAKERS = {"Mesh": [mesh, scree.Mesh], "Curve": [lambda: mesh().curve()], "Choice": [lambda: mesh().choose()], "Clumps": [lambda: mesh().clumps(most=3)],
          "Particle": [lambda: scree.Particle(mesh()), lambda: scree.Particle.sphere(0.02),
                       lambda: scree.Particle.clump([[0, 0, 0], [0.01, 0, 0]], [0.02, 0.01], like=scree.Particle(mesh()))],
          "World": [world, lambda: scene().world], "Scene": [scene, heap], "Motion": [motion],
          "Record": [lambda: mesh().measure()], "Error": [error]}


def churn():
    """Takes the memory that was just freed."""
    gc.collect()
    return [scree.Particle(mesh()) for _ in range(5)] + [mesh() for _ in range(20)]


class Copies(unittest.TestCase):
    def test_every_class_is_tried(self):
        classes = {name for name in scree.__all__ if inspect.isclass(getattr(scree, name))}
        self.assertEqual(classes, set(MAKERS))

    def each(self):
        for makers in MAKERS.values():
            for make in makers:
                yield make()

    def test_a_copy_outlives_its_original(self):
        for how in copy.copy, copy.deepcopy:
            for original in self.each():
                twin, was = how(original), facts(original)
                del original
                other = churn()
                self.assertEqual(facts(twin), was)
                del other

    def test_an_original_outlives_its_copy(self):
        for original in self.each():
            was = facts(original)
            copy.copy(original)
            other = churn()
            self.assertEqual(facts(original), was)
            del other

    def test_pickles(self):
        for original in self.each():
            was = facts(original)
            if isinstance(original, (scree.Curve, scree.Clumps)):
                with self.assertRaisesRegex(TypeError, "not pickled: pickle .*mesh"):
                    pickle.dumps(original)
                continue
            image = pickle.dumps(original)
            del original
            other = churn()
            self.assertEqual(facts(pickle.loads(image)), was)
            del other

    def test_worlds_and_scenes_go_on_by_themselves(self):
        for make in world, scene, heap:
            for again in copy.copy, copy.deepcopy, lambda w: pickle.loads(pickle.dumps(w)):
                one = make()
                two, was = again(one), facts(one)
                two.step(20)
                self.assertEqual(facts(one), was)
                one.step(20)
                self.assertEqual(facts(one), facts(two))

    def test_hooks_go_along(self):
        one = scene()
        one.every(0.01, print_nothing)
        self.assertEqual(len(pickle.loads(pickle.dumps(one))._hooks), 1)
        one.every(0.01, lambda s: None)
        with self.assertRaises((pickle.PicklingError, AttributeError)):  # a function without a name
            pickle.dumps(one)

    def test_a_choice_from_a_pickle(self):
        choice = pickle.loads(pickle.dumps(mesh().choose()))
        with self.assertRaisesRegex(ValueError, "'paper' is not there"):
            choice.mesh("paper")

    def test_parts_keep_the_whole(self):
        part = scene().world
        other = churn()
        self.assertEqual(len(part), len(part.bodies().mass))
        particle = pickle.loads(pickle.dumps(scree.Particle.sphere(0.02)))
        gc.collect()
        self.assertAlmostEqual(particle.measure().size, 0.04)
        del other

    def test_nothing_is_left(self):
        def use():
            for original in self.each():
                twins = [copy.copy(original), copy.deepcopy(original)]
                if not isinstance(original, (scree.Curve, scree.Clumps)):
                    twins.append(pickle.loads(pickle.dumps(original)))

        use()
        gc.collect()
        before = lib.memory_used()
        use()
        gc.collect()
        self.assertEqual(lib.memory_used(), before)


    def test_choices_of_other_processes(self):
        scans = [mesh(), scree.sample("icosphere-3")]
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            choices = pool.map(scree.Mesh.choose, scans)
        self.assertEqual([facts(choice) for choice in choices], [facts(scan.choose()) for scan in scans])


def print_nothing(_scene):
    pass


class Threads(unittest.TestCase):
    """While a thread steps, what another one may do with the same world is read its clock."""
    FREE = {"time", "step_count"}
    ARGUMENTS = {"add_body": lambda: (scree.Particle.sphere(0.01), 0), "add_joint": lambda: (0,), "add_wall": lambda: ("plane", 0), "body": lambda: (0,),
                 "export": lambda: ("folder",), "remove_body": lambda: (0,), "run": lambda: (0.1,), "save": lambda: ("w.scree",),
                 "set_backend": lambda: ("cpu",), "set_body": lambda: (0,), "set_body_force": lambda: (0,), "set_contact": lambda: (0, 0, 0.5, 0.5),
                 "set_pair": lambda: (0, 0), "set_wall_motion": lambda: (0,), "set_wall_surface": lambda: (0,),
                 "set_wall_velocity": lambda: (0,), "wall_force": lambda: (0,), "wall_power": lambda: (0,),
                 "write_vtp": lambda: ("w.vtp",), "write_json": lambda: ("w.json",), "geometry_note": lambda: (0,), "__reduce__": lambda: (), "__len__": lambda: (),
                 "__str__": lambda: ()}
    OF_PYTHON = {"load", "template", "templates", "every", "__init__", "__repr__", "_repr_html_"}

    def test_every_method_is_refused(self):
        whole = scene()
        at_hook, go_on, problems = threading.Event(), threading.Event(), []

        def wait(_scene):
            if threading.current_thread() is thread:
                at_hook.set()
                go_on.wait(60)

        whole.every(0.001, wait)
        thread = threading.Thread(target=lambda: self.keep(problems, whole.run))
        thread.start()
        self.assertTrue(at_hook.wait(60))
        try:
            tried = 0
            for thing in whole, whole.world:
                for name, member in inspect.getmembers(type(thing)):
                    if name.startswith("_") and name not in self.ARGUMENTS or name in self.OF_PYTHON | self.FREE:
                        continue
                    if not hasattr(type(thing), name) or not (isinstance(member, property) or inspect.isfunction(member)):
                        continue
                    tried += 1
                    with self.subTest(name), self.assertRaisesRegex(RuntimeError, "another thread is stepping this scene"):
                        value = getattr(thing, name)
                        if callable(value):
                            value(*self.ARGUMENTS.get(name, tuple)())
            self.assertGreater(tried, 40)
            self.assertGreater(whole.time, 0)
            self.assertGreater(whole.world.step_count, 0)
        finally:
            go_on.set()
            thread.join()
        self.assertEqual(problems, [])
        self.assertEqual(whole.end, "the time is over")

    def test_two_threads_that_look(self):
        both, problems, seen = world(), [], set()
        contacts = str(both.contacts())

        def look():
            for _ in range(50):
                seen.add((both.hash, str(both.observe()), str(both.contacts()) == contacts))

        threads = [threading.Thread(target=lambda: self.keep(problems, look)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((problems, len(seen)), ([], 1))

    def test_a_thread_that_steps_and_one_that_looks(self):
        """Single steps with looks in between: refused or right, and the steps go on."""
        both, alone, problems, looks = world(), world(), [], []

        def step():
            for _ in range(200):
                both.step()

        thread = threading.Thread(target=lambda: self.keep(problems, step))
        thread.start()
        while thread.is_alive():
            try:
                looks.append(len(both.bodies().mass))
                both.contacts()
            except RuntimeError:
                pass
        thread.join()
        alone.step(200)
        self.assertEqual((problems, both.hash), ([], alone.hash))
        self.assertEqual(set(looks) | {3}, {3})

    def test_a_particle_for_worlds_of_many_threads(self):
        particle, problems, hashes = scree.Particle(mesh()), [], []

        def use():
            own = scree.World(stiffness_factor=0.01)
            material = own.add_material()
            for i in range(30):
                own.add_body(particle, material, position=(i, 0, 0))
            own.step(5)
            hashes.append(own.hash)

        threads = [threading.Thread(target=lambda: self.keep(problems, use)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((problems, len(set(hashes))), ([], 1))

    def test_a_mesh_and_a_curve_for_many_threads(self):
        scan, problems, seen = scree.sample("icosphere-3"), [], set()
        curve = scan.curve()

        def use():
            level = curve.mesh(curve.find(100))
            seen.add((str(facts(level)), str(scan.measure()), str(scan.distance(level)), str(curve.choose().recommended)))

        threads = [threading.Thread(target=lambda: self.keep(problems, use)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((problems, len(seen)), ([], 1))

    def test_many_threads_use_the_library_first(self):
        """Functions and types are made when they are first asked for: once, in whichever thread."""
        fresh, seen, ready = type(lib)(), [], threading.Barrier(4)

        def ask():
            ready.wait()
            seen.append([fresh.headers.type(name) for name in sorted(fresh.headers.structs)] +
                        [getattr(fresh, name[len("scree_"):]) for name in sorted(fresh.headers.functions)])

        interval = sys.getswitchinterval()
        sys.setswitchinterval(1e-6)
        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        sys.setswitchinterval(interval)
        self.assertEqual([types == seen[0] for types in seen], 4 * [True])

    @staticmethod
    def keep(problems, function):
        try:
            function()
        except BaseException as problem:
            problems.append(problem)


if __name__ == "__main__":
    unittest.main()
