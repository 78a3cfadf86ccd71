from spack.package import *


class Scree(CMakePackage):
    """From a 3D scan to the particle that a discrete-element (DEM) simulation needs: repair, decimation, the choice of a
    triangle count, clumps of spheres, and a simulation of non-convex particles."""

    homepage = "FILL-IN-REPOSITORY"
    url = "FILL-IN-REPOSITORY/releases/download/v0.2.0/scree-0.2.0-src.tar.gz"

    license("MIT")
    maintainers("FILL-IN-MAINTAINER")

    version("0.2.0", sha256="FILL-IN-SHA256")

    variant("pictures", default=True, description="Figures by cairo and pictures by Embree")
    variant("study", default=True, description="Studies of many runs, with results in SQLite")

    depends_on("c", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("expat")
    depends_on("libyaml")
    depends_on("meshoptimizer")
    depends_on("qhull@2020.2:")
    depends_on("xxhash")
    depends_on("zlib-api")
    depends_on("cairo", when="+pictures")
    depends_on("embree", when="+pictures")
    depends_on("sqlite", when="+study")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("SCREE_PICTURES", "pictures"),
            self.define_from_variant("SCREE_STUDY", "study"),
            self.define("BUILD_TESTING", False),
        ]
