"""scree: triangle counts for DEM particles from 3D scans, over the shared library by ctypes.

    import scree
    scan = scree.load("phone.stl")              # or "sample:fp-1"
    choice = scan.choose()
    print(choice.answer)                        # choice.recommended.triangle_count, choice.errors["widths"], ...
    choice.export("deme")                       # or choice.mesh().write("particle.stl")

SI units: metres, kilograms, seconds, radians. Tables are numpy arrays where numpy is installed, memoryviews and
lists where it is not. What the library refuses is a scree.Error with one sentence and a `status`. Long work takes
`progress`, a function of (phase, fraction) that cancels by returning False; Ctrl-C works anyway."""
from ._calibrate import calibrate, optimise
from ._library import Error, lib as _lib
from ._mesh import Choice, Clumps, Curve, Mesh, codes, load, sample, samples
from ._report import report
from ._scene import Motion, Scene
from ._values import Record, whole as _whole
from ._world import Particle, World, write_pvd

__all__ = ["Choice", "Clumps", "Curve", "Error", "Mesh", "Motion", "Particle", "Record", "Scene", "World", "calibrate", "codes", "load", "optimise",
           "report", "sample", "samples", "set_threads", "version", "write_pvd"]
__version__: str = _lib.version()


def version() -> str:
    return __version__


def set_threads(count: int) -> None:
    """Threads of parallel work; 0: one per processor. Results do not depend on it."""
    _lib.set_threads(_whole(count, "a number of threads"))
