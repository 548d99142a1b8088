# The two commands of the README (demo, test), and long jobs. Each installs its packages first and works on a fresh Debian 12.
SHELL := /bin/bash
# Paths below the clone are relative for ccache, so all clones share one cache.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := true
BUILD := build/release
OUT ?= out
JOBS ?= $(shell nproc)

.PHONY: demo test check docs nightly setup build asan clean
.DEFAULT_GOAL := build

setup:
	@tools/setup develop

# Builds tests, benchmarks and lab/ too; `make demo` leaves them out.
build: setup
	@tools/build_page
	@grep -qs '^SUREFOOT_DEVELOPER:BOOL=ON' $(BUILD)/CMakeCache.txt || cmake --preset release -DSUREFOOT_DEVELOPER=ON > /dev/null
	@cmake --build $(BUILD) -j $(JOBS)

demo:
	@echo "make demo: 1. packages"
	@tools/setup run
	@echo "make demo: 2. the live page"
	@tools/build_page
	@echo "make demo: 3. the programs (the first time about 11 minutes on two cores)"
	@test -f $(BUILD)/build.ninja || cmake --preset release -DSUREFOOT_DEVELOPER=OFF > /dev/null
	@NINJA_STATUS='[%f of %t, %e s] ' cmake --build $(BUILD) -j $(JOBS) --target surefoot surefoot-gate
	@echo "make demo: 4. the demonstration"
	@tools/demo $(BUILD)/bin/surefoot $(OUT)/demo

test: build
	@tools/setup page
	ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure
	@echo "$$(grep -cE 'skipped 1 check' $(BUILD)/Testing/Temporary/LastTest.log) checks skipped, data missing"

# Tests of readers, gate, gate process, audit log, REX link and stairs with AddressSanitizer and UndefinedBehaviorSanitizer.
asan: setup
	@test -f build/asan-ubsan/build.ninja || cmake --preset asan-ubsan > /dev/null
	@cmake --build build/asan-ubsan -j $(JOBS) --target core_test io_test gate_test grid_test stairs_test gate_process_test rex_link_test
	ctest --test-dir build/asan-ubsan -j $(JOBS) --output-on-failure -R '^(core|io|gate|grid|stairs|gate_process|rex_link)\.'

check:
	@tools/check

# Builds the documentation site and the C++ reference in build/docs. Fails on broken links and on errors in header comments.
docs:
	@tools/setup docs
	@mkdocs build --strict --quiet
	@rm -rf build/docs/api
	@doxygen docs/Doxyfile
	@echo "the documents are in build/docs/index.html"

nightly: build
	@tools/nightly

clean:
	rm -rf build
