# SPDX-License-Identifier: Apache-2.0
# What a user types. `make help` lists the targets; setup/install.sh installs what they need on Debian 12.

DEMOS := cornell restaurant atrium
DEMO_STEPS := $(words programs $(DEMOS))
DEMO_SIZE := 960x540
PYTHON := /usr/bin/python3
BUILD := build
PLAY := $(BUILD)/bin/chandelier-play
BAKE := $(BUILD)/bin/chandelier-bake
CPP_FILES := $(shell git ls-files '*.cpp' '*.h' 2>/dev/null)

.PHONY: help setup build demo test test-mesa25 test-blender4 bench bench-baker bench-lightcluster bench-soft fuzz addon addon-images format portable clean
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

help:
	@echo "make demo         build the programs, make three scenes, render them with and without light clusters, print where the pictures are"
	@echo "make test         build and run every test"
	@echo "make build        build into build/bin/"
	@echo "make test-mesa25  run the GPU tests on Mesa 25, unpacked privately into build/mesa25"
	@echo "make test-blender4  run the add-on's tests in Blender 4.3, as an extension; installs Debian 13's into build/blender4 (root or sudo)"
	@echo "make bench        measure the baker beside gltfpack, how packs open, how batches and hierarchies compare, and"
	@echo "                  light clusters as their paper did: the next two targets, one after the other"
	@echo "make bench-baker  the baker's part, with a plot over the size of the scene, in build/bench/bake/"
	@echo "make bench-lightcluster  make the paper's tables and figures with ours beside them, in build/bench/lightcluster/; takes"
	@echo "                  DEVICE=NAME (default: Mesa 25 if it can be downloaded) and OPTIONS='--size 1280x720 --face-size 512"
	@echo "                  --scenes atrium,cornell --repeats 5', or OPTIONS=--quick to see that it works"
	@echo "make bench-soft   print what soft shadow maps cost beside the reference's; takes DEVICE and OPTIONS as well"
	@echo "make fuzz         search for inputs that break the importer, the pack reader or the cache, SECONDS=60 each; keep what is found"
	@echo "make portable     build a chandelier-play that needs only glibc and a Vulkan loader, in build/portable/bin/"
	@echo "make addon-images  make the pictures of blender_addon/README.md again, in a Blender 3.4 under Xvfb"
	@echo "make addon        pack the Blender add-on into build/blender/chandelier.zip, with the preview's library if it is built"
	@echo "make format       clang-format every C++ file"
	@echo "make clean        remove build/"
	@echo "demo, test and bench first install the missing Debian packages of setup/packages.txt (root or sudo)."

setup:
	@setup/install.sh

$(BUILD)/build.ninja: CMakePresets.json
	cmake --preset release

# Ninja knows what is out of date, and says nothing to do in a second.
build: $(BUILD)/build.ninja
	cmake --build --preset release

# Each of these begins with the packages, then the build, in this order even under make -j.
test: setup
	@$(MAKE) --no-print-directory build
	ctest --preset release -j 2

test-mesa25: setup
	@$(MAKE) --no-print-directory build
	set -e; variables="$$(setup/mesa25.sh $(BUILD)/mesa25)"; echo "$$variables"; \
	  env $$variables $(PLAY) --list-devices | grep 'Mesa 25' || { echo "the Vulkan loader did not take Mesa 25" >&2; exit 1; }; \
	  env $$variables ctest --preset release -L gpu

test-blender4:
	@setup/install.sh setup/packages-blender4.txt
	@$(MAKE) --no-print-directory build
	set -e; variables="$$(setup/blender4.sh $(BUILD)/blender4)"; echo "$$variables"; \
	  env $$variables ctest --preset release -L blender

# Only the programs that it runs, and the scenes one after the other, the quickest first, so that a picture is there soon.
demo: setup
	@echo "demo: step 1 of $(DEMO_STEPS), most of the time: the programs ([done/all] below); then the scenes $(DEMOS)"
	@$(MAKE) --no-print-directory $(BUILD)/build.ninja
	@cmake --build --preset release --target chandelier-bake chandelier-play
	@set -e; step=1; for name in $(DEMOS); do step=$$((step + 1)); \
	  echo "demo: step $$step of $(DEMO_STEPS): the scene $$name, made, baked, and rendered twice"; \
	  $(MAKE) --no-print-directory $(BUILD)/demo/$$name/report.html; \
	done
	@echo; echo "Pictures, differences and costs of each scene, reference against light clusters:"
	@for name in $(sort $(DEMOS)); do echo "  $(CURDIR)/$(BUILD)/demo/$$name/report.html"; done
	@for name in $(sort $(DEMOS)); do ls $(CURDIR)/$(BUILD)/demo/$$name/*.png | sed 's/^/  /'; done

bench:
	@setup/install.sh setup/packages-bench.txt
	@$(MAKE) --no-print-directory build
	@$(MAKE) --no-print-directory $(BUILD)/demo/atrium.glb
	@$(MAKE) --no-print-directory bench-baker
	@$(MAKE) --no-print-directory bench-lightcluster

# Needs 8 GiB of free disk: its largest city has 20 million triangles.
bench-baker:
	$(PYTHON) tests/bench/bake_bench.py --bake $(BAKE) --out $(BUILD)/bench/bake --data $(DATA)
	$(BUILD)/bin/chandelier-pack-bench
	@scenes="$(BUILD)/demo/atrium.glb $(wildcard $(DATA)/scenes/*/*.gltf)"; $(BUILD)/bin/chandelier-batch-bench $$scenes
	$(BUILD)/bin/chandelier-bvh-bench

# On Mesa 25 where it can be had: it runs only the taken side of a branch, as GPUs do. A GPU is hidden by that, so a device
# that is named is looked for among the system's own.
bench-lightcluster:
	@setup/install.sh setup/packages-bench.txt
	@$(MAKE) --no-print-directory build
	variables="$(if $(DEVICE),,$$(setup/mesa25.sh $(BUILD)/mesa25 || true))"; env $$variables \
	  $(PYTHON) tests/bench/lightcluster/run.py --programs $(BUILD)/bin --out $(BUILD)/bench/lightcluster --data $(DATA) \
	  $(if $(DEVICE),--device "$(DEVICE)") $(OPTIONS)

# On the system's own driver first, then on Mesa 25 where it can be had; with DEVICE on that alone.
bench-soft:
	@setup/install.sh setup/packages-bench.txt
	@$(MAKE) --no-print-directory build
	set -e; soft="$(PYTHON) tests/bench/lightcluster/soft.py --programs $(BUILD)/bin --out $(BUILD)/bench/soft --data $(DATA)"; \
	  $$soft $(if $(DEVICE),--device "$(DEVICE)") $(OPTIONS); \
	  $(if $(DEVICE),true,variables="$$(setup/mesa25.sh $(BUILD)/mesa25 || true)"; test -z "$$variables" || env $$variables $$soft $(OPTIONS))

SECONDS := 60
FUZZ_TARGETS := import pack cache
CORPUS := tests/fuzz/corpus
DATA := ../shared/data

# Starts from the corpus that is kept with the tests, and from small glTFs of the test data where it is. A crash is written
# into the corpus, where `make test` replays it from then on.
fuzz:
	@setup/install.sh setup/packages-fuzz.txt
	cmake --preset fuzz
	cmake --build --preset fuzz
	@mkdir -p $(FUZZ_TARGETS:%=$(BUILD)/fuzz/found/%) $(FUZZ_TARGETS:%=$(CORPUS)/%)
	@if [ -d $(DATA) ]; then $(PYTHON) tests/fuzz/seeds.py --out $(BUILD)/fuzz/found/import $(DATA)/conformance $(DATA)/models; fi
	set -e; for target in $(FUZZ_TARGETS); do \
	  ASAN_OPTIONS=detect_leaks=0 $(BUILD)/fuzz/bin/$${target}_fuzz -max_total_time=$(SECONDS) -max_len=65536 -timeout=30 -rss_limit_mb=8192 \
	    -print_final_stats=1 -artifact_prefix=$(CORPUS)/$$target/ $(BUILD)/fuzz/found/$$target $(CORPUS)/$$target; \
	done

EXAMPLE_MODULES := examples/gltf_writer.py examples/shapes.py examples/textures.py

$(BUILD)/demo/%.glb: examples/%.py $(EXAMPLE_MODULES)
	@mkdir -p $(@D)
	$(PYTHON) $< -o $@

$(BUILD)/demo/%.chandelier: $(BUILD)/demo/%.glb $(BAKE)
	$(BAKE) $< -o $@

$(BUILD)/demo/%/report.html: $(BUILD)/demo/%.chandelier $(PLAY)
	$(PLAY) $< --compare reference,lightcluster --size $(DEMO_SIZE) --report $(@D)
	@touch $@
	@echo "demo: pictures of $*: $(CURDIR)/$(@D)/reference.png, and the others beside it"

.PRECIOUS: $(BUILD)/demo/%.glb $(BUILD)/demo/%.chandelier

addon:
	$(PYTHON) blender_addon/make_zip.py

# The pictures of blender_addon/README.md, from a Blender in a window of its own.
addon-images: build
	CHANDELIER_BUILD=$(CURDIR)/$(BUILD) CHANDELIER_BIN=$(CURDIR)/$(BUILD)/bin $(PYTHON) tests/blender/make_images.py

format:
	clang-format -i $(CPP_FILES)

portable:
	cmake --preset portable
	cmake --build --preset portable
	@ls -l $(CURDIR)/$(BUILD)/portable/bin/chandelier-play

clean:
	rm -rf $(BUILD)
