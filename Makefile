# Tasks of the project. `make help` lists them.

PYTHON ?= $(firstword $(foreach name,python3.13 python3.12 python3.11 python3,\
	$(shell $(name) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $(name))))
VENV := .venv
BIN := $(VENV)/bin
SECONDS ?=

.DEFAULT_GOAL := help
.PHONY: help demo test lint kernel bench dist clean

help: ## list the tasks
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-8s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(VENV)/.runtime ## set up, then let a simulated gel drive the pad (SECONDS=10 ends by itself)
	@$(BIN)/neurotouch demo $(if $(SECONDS),--seconds $(SECONDS))

test: $(VENV)/.dev ## set up, then run all tests (real-kernel tests where QEMU is installed)
	$(BIN)/pytest

lint: $(VENV)/.dev ## ruff, mypy --strict, import contracts, spelling
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell

kernel: $(VENV)/.dev ## only the tests in a real kernel under QEMU
	NEUROTOUCH_REQUIRE_KERNEL=1 $(BIN)/pytest tests/kernel

bench: $(VENV)/.runtime ## measure the speed of every stage on this machine
	@$(BIN)/neurotouch bench

dist: $(VENV)/.dev ## build wheel and sdist into dist/
	$(BIN)/python -m build

clean: ## remove everything that the tasks made
	rm -rf $(VENV) .cache dist build .pytest_cache .mypy_cache .ruff_cache .hypothesis

$(VENV)/bin/python:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed (Debian: apt install python3 python3-venv)." >&2; exit 1; }
	@echo "Setting up $(VENV) with $$($(PYTHON) --version) ..."
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); echo "Python's venv module is missing (Debian: apt install python3-venv)." >&2; exit 1; }
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'

$(VENV)/.runtime: pyproject.toml | $(VENV)/bin/python
	@echo "Installing neurotouch and what it needs (about half a minute, once) ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/.dev: pyproject.toml | $(VENV)/.runtime
	@echo "Installing the test tools ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable . --group dev
	@touch $@
