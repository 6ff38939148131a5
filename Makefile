# Tasks of the project. `make help` lists them.

PYTHON ?= $(firstword $(foreach name,python3.13 python3.12 python3.11 python3,\
	$(shell $(name) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $(name))))
VENV := .venv
BIN := $(VENV)/bin
SECONDS ?=
CHAPTERS ?=
MACHINE ?=
LOCK := packaging/requirements.lock
WHEELHOUSE := .cache/wheelhouse
# The same commit gives the same bytes.
EPOCH := $(shell git log -1 --format=%ct 2>/dev/null || echo 315532800)

.DEFAULT_GOAL := help
.PHONY: help demo test test-python lint kernel docs pictures fuzz mutants soak room paper dataset bench dist deb sysext lock try-package system-test clean

help: ## list the tasks
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(VENV)/.runtime ## set up, then let a simulated gel drive the pad (SECONDS=10 ends by itself, CAMERA=video is a webcam)
	@$(BIN)/neurotouch demo $(if $(SECONDS),--seconds $(SECONDS)) $(if $(filter video,$(CAMERA)),--camera uvc)

test: $(VENV)/.dev ## set up, then run all tests (real-kernel tests where QEMU is installed)
	$(BIN)/pytest -n auto --no-loadscope-reorder

test-python: ## the quick tests with the newest libraries that PYTHON=python3.14 can have, or SET=oldest
	$(PYTHON) -m tests.other_python $(or $(SET),newest)

lint: $(VENV)/.dev ## ruff, mypy --strict, import contracts, spelling, workflows, citation
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/[!c]*.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-issue-config .github/ISSUE_TEMPLATE/config.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff
	$(BIN)/zizmor --offline --quiet .github/workflows

kernel: $(VENV)/.dev ## only the tests in a real kernel under QEMU
	NEUROTOUCH_REQUIRE_KERNEL=1 $(BIN)/pytest tests/kernel

docs: $(VENV)/.dev ## build the documents as a site, without network: docs/_build/index.html
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going --nitpicky docs docs/_build

pictures: $(VENV)/.dev ## make the pictures of the documents (needs Chromium)
	$(BIN)/python -m tests.page.pictures

fuzz: $(VENV)/.dev ## feed damaged files to the program for MINUTES=30 of processor time (AREAS="recordings rigs", SEED=1, GUIDED=1 by coverage)
	@$(BIN)/python -m tests.fuzz $(AREAS) --minutes $(or $(MINUTES),30) $(if $(SEED),--seed $(SEED)) $(if $(GUIDED),--guided)

mutants: $(VENV)/.dev ## change the safety-critical modules at COUNT=300 places: a test must fail (SEED=1, MODULES=paths, RESULTS=file to go on)
	@nice $(BIN)/python -m tests.mutants $(MODULES) --count $(or $(COUNT),300) $(if $(SEED),--seed $(SEED)) \
		$(if $(RESULTS),--results $(RESULTS))

soak: $(VENV)/.dev ## let a driver play for HOURS=24 of sensor time among faults, plugs, viewers and panics (SEED=1)
	@nice $(BIN)/python -m tests.soak --hours $(or $(HOURS),24) $(if $(SEED),--seed $(SEED))

room: $(VENV)/.dev ## measure recognition under each nuisance of a real room (ONLY="bump* mains", COUNT=5, SEEDS="1 2", JSON=1)
	@nice $(BIN)/python -m tests.room $(ONLY) $(if $(COUNT),--count $(COUNT)) $(if $(SEEDS),--seeds $(SEEDS)) $(if $(JSON),--json)

paper: $(VENV)/.dev ## make tables and figures of the documents again from seeds, and say what differs (KEEP=1 replaces the committed ones)
	@nice $(BIN)/python -m neurotouch_devtools.paper $(if $(KEEP),--keep)

dataset: $(VENV)/.dev ## make the public data set, which is simulated, and compare its checksums (OUT=edition-1, SPLIT=open for a part)
	@nice $(BIN)/python -m neurotouch_devtools.dataset $(or $(OUT),edition-1) $(if $(SPLIT),--split $(SPLIT))

bench: $(VENV)/.runtime ## measure the speed of every stage on this machine
	@$(BIN)/neurotouch bench

dist: $(VENV)/.dev ## build wheel and sdist, and the wheel of the development tools, into dist/
	SOURCE_DATE_EPOCH=$(EPOCH) $(BIN)/python -m build --no-isolation
	SOURCE_DATE_EPOCH=$(EPOCH) $(BIN)/python -m build --no-isolation --wheel --outdir dist devtools

deb: $(VENV)/.dev $(WHEELHOUSE)/.complete ## build the package for the Debian this is, into dist/
	SOURCE_DATE_EPOCH=$(EPOCH) $(BIN)/python -m build --no-isolation --wheel
	SOURCE_DATE_EPOCH=$(EPOCH) packaging/build-deb.sh "$$(ls -t dist/*.whl | head -n 1)" $(WHEELHOUSE) dist

try-package: $(VENV)/.dev ## install the newest package of dist/ in a copy of this Debian, type everything that is written (needs root)
	NEUROTOUCH_DEB="$$(ls -t dist/*.deb | head -n 1)" $(BIN)/pytest -n 0 --timeout 1500 tests/packaging/test_installed.py

system-test: $(VENV)/.dev ## the newest package of dist/ in a whole Debian: install, plug, play, purge (needs root; CHAPTERS="install purge" for a part, MACHINE=container for the short form)
	NEUROTOUCH_SYSTEM_TEST=1 NEUROTOUCH_CHAPTERS="$(CHAPTERS)" NEUROTOUCH_MACHINE="$(MACHINE)" $(BIN)/pytest -n 0 --timeout 0 tests/system

sysext: $(VENV)/.dev $(WHEELHOUSE)/.complete ## build the image for systems with a read-only /usr, into dist/ (needs squashfs-tools)
	SOURCE_DATE_EPOCH=$(EPOCH) $(BIN)/python -m build --no-isolation --wheel
	SOURCE_DATE_EPOCH=$(EPOCH) PYTHON=/usr/bin/python3 packaging/sysext/build.sh "$$(ls -t dist/*.whl | head -n 1)" $(WHEELHOUSE) dist

lock: $(VENV)/.dev ## write which libraries the package carries, by hash
	$(BIN)/uv pip compile --no-config --generate-hashes --universal --python-version 3.11 --quiet \
		--extra gel --extra lsl --extra osc --no-annotate --custom-compile-command "make lock" pyproject.toml -o $(LOCK)

clean: ## remove everything that the tasks made
	rm -rf $(VENV) .cache dist build docs/_build .pytest_cache .mypy_cache .ruff_cache .hypothesis

# For Debian's own Python; the only step of the package that needs the network.
$(WHEELHOUSE)/.complete: $(LOCK)
	@echo "Downloading the libraries of the package ..."
	@rm -rf $(WHEELHOUSE)
	@/usr/bin/python3 -m pip download --quiet --disable-pip-version-check --only-binary=:all: \
		--require-hashes --no-deps --requirement $(LOCK) --dest $(WHEELHOUSE)
	@touch $@

$(VENV)/bin/python:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed (Debian: apt install python3 python3-venv)." >&2; exit 1; }
	@echo "Setting up $(VENV) with $$($(PYTHON) --version) ..."
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); echo "Python's venv module is missing (Debian: apt install python3-venv)." >&2; exit 1; }
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'

$(VENV)/.runtime: pyproject.toml | $(VENV)/bin/python
	@echo "Installing neurotouch and what it needs (about half a minute, once) ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@$(BIN)/neurotouch service --source sim:tour --compile
	@touch $@

$(VENV)/.dev: pyproject.toml | $(VENV)/.runtime
	@echo "Installing the test tools ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable . --editable ./devtools --group dev
	@touch $@
