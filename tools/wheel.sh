#!/bin/sh
# Builds build/wheel/scree-*.whl: the Python module with a library inside that needs the C and C++ libraries
# alone, and so runs on other Linux systems too. It draws no pictures: cairo and Embree would need X11 and TBB.
# usage: wheel.sh
set -eu
cd "$(dirname "$0")/.."
tools/install-packages.sh build wheel
tools/library-sources.sh build/library-sources
cmake --preset wheel >/dev/null
cmake --build --preset wheel --target scree_shared >build/wheel/log || { tail -30 build/wheel/log; exit 1; }
rm -f build/wheel/*.whl
SCREE_LIBRARY=$PWD/build/wheel/libscree.so python3 -m pip wheel -q --no-index --no-deps -w build/wheel ./python
ls build/wheel/*.whl
