# A thin face: everything real is in CMake (CMakePresets.json names the builds).
#   make         build/release/bin/scree; installs nothing
#   make demo    installs what is missing, builds, runs the main job on the built-in samples
#   make test    installs what is missing, builds, runs the tests
#   make check DIR=src/world    builds and runs what tests that folder
#   make quick   builds and runs a selection of a minute
#   make page    build/page/scree.html, the page that does it in a browser (needs emscripten and npm)
#   make npm     build/npm/scree-VERSION.tgz, the npm package
#   make deb     Debian packages in build/deb
#   make wheel   a Python wheel for any Linux in build/wheel
#   make docs    builds the manual as a site that works from disk: build/docs/index.html
#   make evidence  runs scree beside measurements and other codes, hours that resume (docs/background/evidence.md)
#   make install, make uninstall    DESTDIR=... stages below a folder
# PRESET=asan|debug|tsan|clang for another build; DATA_DIR=... for a folder of real scans that some tests
# read; LABELS="-LE slow" and the like are passed to ctest; JOBS=N.
PRESET ?= release
DATA_DIR ?=
LABELS ?=
JOBS ?= $(shell nproc)
DEMO_DIR ?= demo

.PHONY: all build packages demo test check quick docs evidence page npm deb wheel install uninstall clean
all: build

packages:
	@tools/install-packages.sh build

build:
	@cmake --preset $(PRESET) -DSCREE_DATA_DIR="$(DATA_DIR)" -DBUILD_TESTING=OFF >build.log 2>&1 || { cat build.log; exit 1; }
	@rm -f build.log
	@cmake --build --preset $(PRESET) -j $(JOBS)

demo: packages
	@$(MAKE) --no-print-directory build
	@tools/demo.sh build/$(PRESET)/bin/scree "$(DEMO_DIR)"

test:
	@tools/install-packages.sh build test docs
	@cmake --preset $(PRESET) -DSCREE_DATA_DIR="$(DATA_DIR)" -DBUILD_TESTING=ON >build.log 2>&1 || { cat build.log; exit 1; }
	@rm -f build.log
	@cmake --build --preset $(PRESET) -j $(JOBS)
	@tools/test.sh $(PRESET) -j $(JOBS) $(LABELS)

check:
	@tools/check.sh $(PRESET) -j $(JOBS) $$(tools/tests-of.py "$(DIR)")

quick:
	@tools/check.sh $(PRESET) -j $(JOBS) $$(sed 's/ *#.*//' tests/quick.txt)

page npm:
	@tools/install-packages.sh build browser
	@tools/library-sources.sh build/library-sources
	@cmake --preset wasm >build.log 2>&1 || { cat build.log; exit 1; }
	@rm -f build.log
	@cmake --build --preset wasm -j $(JOBS) --target $@

deb:
	@tools/deb.sh

wheel:
	@tools/wheel.sh

docs:
	@tools/install-packages.sh build docs
	@$(MAKE) --no-print-directory build
	@tools/site/build.sh build/$(PRESET) build/docs

evidence: build
	@bench/evidence/run.sh

install: build
	@cmake --install build/$(PRESET)

uninstall:
	@tools/uninstall.sh build/$(PRESET)

clean:
	@rm -rf build
