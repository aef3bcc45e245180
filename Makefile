# A thin wrapper: CMake builds, .ci/ holds the scripts. `make help` lists the targets.
.DEFAULT_GOAL := build
.PHONY: help build demo bare check test test-asan test-tsan fuzz bench bench-budget bench-cycles tradeoff exemplars \
  traits scenes gallery format clean

JOBS := $(shell nproc)

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  \1\t\2/' | expand -t 16

build: ## install what is missing, configure, compile (Release) into build/
	@.ci/install build
	@cmake --preset release > build.log 2>&1 || { cat build.log; rm -f build.log; exit 1; }
	@rm -f build.log
	@cmake --build build --target scumble scumble_library -j $(JOBS)

demo: build ## draw a dozen pictures and a contact sheet into out/demo/; ALL=1 draws every scene in every style
	@.ci/demo $(if $(filter-out 0,$(ALL)),--all)

bare: ## run demo and test in a new Debian root that holds only git and make (as root); ONLY=demo runs one; DEBIAN=12
	@exec env DEBIAN=$(or $(DEBIAN),12) .ci/bare $(foreach target,$(or $(ONLY),demo test),"make $(target)")

check: ## the quick tests, for between edits: under a minute once built; one folder's: CHECK=transfer
	@.ci/install test
	@cmake --preset release -DSCUMBLE_TESTS=ON > build.log 2>&1 || { cat build.log; rm -f build.log; exit 1; }
	@rm -f build.log
	@cmake --build build --target check_$(or $(CHECK),programs) -j $(JOBS)
	@ctest --test-dir build --output-on-failure --no-tests=error -j $(JOBS) -L '^$(if $(CHECK),check_$(CHECK),unit)$$'

test: ## install what is missing (Blender too), build everything, run all tests
	@.ci/install test
	@cmake --preset release -DSCUMBLE_TESTS=ON -DSCUMBLE_BENCH=ON
	@cmake --build build -j $(JOBS)
	@ctest --test-dir build --output-on-failure -j $(JOBS)

test-asan: ## all tests but the painter's longest with AddressSanitizer and UBSan, in build-asan/; an hour or two
	@.ci/install test
	@cmake --preset asan
	@cmake --build build-asan -j $(JOBS)
	@ASAN_OPTIONS=$(NO_GUESSED_TLS) LSAN_OPTIONS=suppressions=$(CURDIR)/tests/support/leaks.supp \
	  ctest --test-dir build-asan --output-on-failure -j $(JOBS) -E painting_repeats

# GCC 12's sanitizer guesses the place of the C library's thread-local memory, wrongly once a library is loaded late,
# and then crashes in its search for leaks there.
NO_GUESSED_TLS := intercept_tls_get_addr=0

test-tsan: ## all tests but the longest of Blender's and the painter's with ThreadSanitizer, in build-tsan/; hours
	@.ci/install tsan
	@.ci/tsan_tbb build-tsan/onetbb
	@cmake --preset tsan
	@cmake --build build-tsan -j $(JOBS)
	@TSAN_OPTIONS=history_size=7:suppressions=$(CURDIR)/tests/support/threads.supp \
	  ctest --test-dir build-tsan --output-on-failure -j $(JOBS) -E "painting_repeats|cycles_matrix_test"

fuzz: ## libFuzzer (clang) on everything that reads other people's files, 60 s each; FUZZ="600 gltf" 600 s of one
	@.ci/install fuzz
	@cmake --preset fuzz
	@cmake --build build-fuzz --target fuzzers -j $(JOBS)
	@.ci/fuzz $(FUZZ)

bench: ## measure speed against its targets, one table (docs/performance.md); BENCH=flicker runs another bench
	@.ci/install bench
	@cmake --preset release -DSCUMBLE_BENCH=ON > build.log 2>&1 || { cat build.log; rm -f build.log; exit 1; }
	@rm -f build.log
	@cmake --build build --target scumble benches -j $(JOBS)
	@$(if $(BENCH),build/bench/$(BENCH)_bench,/usr/bin/python3 bench/performance.py) $(BENCH_ARGS)

bench-cycles: build ## our speed beside Cycles' on the same scene, into out/bench-cycles/
	@.ci/install test
	@/usr/bin/python3 bench/cycles_bench.py --scumble build/scumble $(BENCH_ARGS)

bench-budget: build ## whether --budget-ms keeps its budgets (docs/budget.md)
	@/usr/bin/python3 bench/budget.py --scumble build/scumble $(BENCH_ARGS)

tradeoff: build ## speed against accuracy on the sample scenes, into out/tradeoff/; WRITE_DOCS=1: docs/tradeoff.md too
	@.ci/install test
	@/usr/bin/python3 bench/tradeoff.py $(if $(WRITE_DOCS),--write-docs) $(TRADEOFF_ARGS)

exemplars: ## repaint the bundled styles and the strokes of hatching (libmypaint), thumbnails and docs/exemplars.md
	@.ci/install test
	@cmake --preset release
	@cmake --build build --target paint_exemplars scumble -j $(JOBS)
	@build/exemplars/paint/paint_exemplars --style all --seed 1 -o exemplars
	@build/exemplars/paint/paint_exemplars --hatching --seed 1 -o finish/hatching
	@.ci/optimise_png exemplars finish/hatching
	@.ci/traits

traits: build ## measure the bundled styles: docs/exemplars.md, and thumbnails
	@.ci/install test
	@.ci/traits

scenes: ## make the sample scenes again (Blender)
	@.ci/install test
	@blender -b -noaudio --factory-startup -P blender_scripts/make_scenes.py -- --output scenes

gallery: build ## make the pictures of README and docs/; ONLY="edge colorize" makes those, "materials" takes minutes
	@.ci/install test
	@.ci/gallery $(ONLY)

format: ## clang-format every C++ file
	@.ci/install format
	@git ls-files '*.h' '*.cpp' | xargs clang-format -i

clean: ## remove what was built and written
	@rm -rf build build-asan build-tsan build-fuzz out
