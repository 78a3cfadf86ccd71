"""Builds the wheel of the module with its shared library inside (PEP 517), by Python's own library alone.

The library is the file that SCREE_LIBRARY names, else it is built by CMake from the checkout that this folder lies
in. It stands on the system's cairo, qhull and the like, so the wheel is for this system, not for others."""
import base64
import hashlib
import os
import pathlib
import shutil
import subprocess
import sysconfig
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent


def _build_library(folder):
    if not (ROOT / "CMakeLists.txt").exists() or not shutil.which("cmake"):
        raise SystemExit("scree: building the library needs the whole checkout and cmake; or name a built one in SCREE_LIBRARY")
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF"], check=True)
    subprocess.run(["cmake", "--build", folder, "--target", "scree_shared", "--parallel"], check=True)
    return pathlib.Path(folder) / "libscree.so"


def _soname(library):
    """The name under which programs and the module look for it."""
    lines = subprocess.run(["objdump", "-p", library], check=True, capture_output=True, text=True).stdout.splitlines()
    return next(line.split()[1] for line in lines if line.split()[:1] == ["SONAME"])


def _contents(library, version):
    """(name in the wheel, bytes) of everything but RECORD."""
    for source in sorted((HERE / "scree").glob("*.py")):
        yield f"scree/{source.name}", source.read_bytes()
    yield "scree/VERSION", version.encode()
    yield f"scree/{_soname(library)}", library.resolve().read_bytes()
    info = f"scree-{version}.dist-info"
    yield f"{info}/METADATA", (f"Metadata-Version: 2.1\nName: scree\nVersion: {version}\nRequires-Python: >=3.9\n"
                               "Provides-Extra: arrays\nRequires-Dist: numpy; extra == 'arrays'\n").encode()
    yield f"{info}/WHEEL", ("Wheel-Version: 1.0\nGenerator: scree\nRoot-Is-Purelib: false\n"
                            f"Tag: {_tag()}\n").encode()
    yield f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes()


def _tag():
    return "py3-none-" + sysconfig.get_platform().replace("-", "_").replace(".", "_")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version = (ROOT / "VERSION").read_text().strip()
    name = f"scree-{version}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as folder:
        named = os.environ.get("SCREE_LIBRARY")
        library = pathlib.Path(named) if named else _build_library(folder)
        record = ""
        with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
            for path, content in _contents(library, version):
                digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                record += f"{path},sha256={digest},{len(content)}\n"
                wheel.writestr(path, content)
            info = f"scree-{version}.dist-info/RECORD"
            wheel.writestr(info, record + f"{info},,\n")
    return name
