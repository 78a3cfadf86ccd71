"""Builds the wheel of the module with its shared library inside (PEP 517), by Python's own library alone.

The library is the file that SCREE_LIBRARY names, else it is built by CMake from the checkout that this folder lies
in. That one stands on the system's cairo, qhull and the like, so its wheel is for this system, not for others.
A library that stands on the C and C++ libraries alone (tools/wheel.sh) makes a manylinux wheel."""
import base64
import hashlib
import os
import pathlib
import re
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


def _objdump(option, library):
    return subprocess.run(["objdump", option, library], check=True, capture_output=True, text=True).stdout


def _soname(library):
    """The name under which programs and the module look for it."""
    return re.search(r"SONAME +(\S+)", _objdump("-p", library))[1]


def _contents(library, version):
    """(name in the wheel, bytes) of everything but RECORD."""
    for source in [*sorted((HERE / "scree").glob("*.py")), HERE / "scree/py.typed"]:
        yield f"scree/{source.name}", source.read_bytes()
    for header in sorted((ROOT / "include/scree").glob("*.h")):
        yield f"scree/include/scree/{header.name}", header.read_bytes()
    yield "scree/VERSION", version.encode()
    yield f"scree/{_soname(library)}", library.resolve().read_bytes()
    info = f"scree-{version}.dist-info"
    yield f"{info}/METADATA", _metadata(version).encode()
    yield f"{info}/WHEEL", ("Wheel-Version: 1.0\nGenerator: scree\nRoot-Is-Purelib: false\n"
                            f"Tag: {_tag(library)}\n").encode()
    yield f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes()


def _metadata(version):
    """Of the table [project] in pyproject.toml, which Python reads from 3.11 on; before, the least that pip needs."""
    try:
        import tomllib
        project = tomllib.loads((HERE / "pyproject.toml").read_text())["project"]
    except ModuleNotFoundError:
        project = {}
    lines = ["Metadata-Version: 2.1", "Name: scree", f"Version: {version}", "Requires-Python: >=3.9", "License: MIT"]
    if "description" in project:
        lines += [f"Summary: {project['description']}", f"Keywords: {','.join(project['keywords'])}"]
    lines += [f"Author: {author['name']}" for author in project.get("authors", [])]
    lines += [f"Classifier: {classifier}" for classifier in project.get("classifiers", [])]
    lines += [f"Project-URL: {name}, {url}" for name, url in project.get("urls", {}).items() if url.startswith("http")]
    lines += ["Provides-Extra: arrays", "Requires-Dist: numpy; extra == 'arrays'", "Description-Content-Type: text/markdown"]
    return "\n".join(lines) + "\n\n" + (HERE / "README.md").read_text()


def _tag(library):
    """PEP 600: manylinux_2_N where only the C library of version 2.N or later and the C++ library
    are needed, which every such system has; else this system alone."""
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    needed = re.findall(r"NEEDED +(\S+)", _objdump("-p", library))
    if all(name.startswith(("libc.so.", "libm.so.", "libstdc++.so.", "ld-linux")) for name in needed):
        version = max(int(minor) for minor in re.findall(r"GLIBC_2\.(\d+)", _objdump("-T", library)))
        platform = platform.replace("linux", f"manylinux_2_{version}")
    return f"py3-none-{platform}"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version = (ROOT / "VERSION").read_text().strip()
    with tempfile.TemporaryDirectory() as folder:
        named = os.environ.get("SCREE_LIBRARY")
        library = pathlib.Path(named) if named else _build_library(folder)
        name = f"scree-{version}-{_tag(library)}.whl"
        record = ""
        with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
            for path, content in _contents(library, version):
                digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                record += f"{path},sha256={digest},{len(content)}\n"
                wheel.writestr(path, content)
            info = f"scree-{version}.dist-info/RECORD"
            wheel.writestr(info, record + f"{info},,\n")
    return name
