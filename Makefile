# `make demo` and `make test` do all their own set-up: Python 3.11 to 3.14 is all that is needed. The
# first usable one on the PATH is taken; PYTHON=python3.12 names another.
PYTHON ?=
VENV ?= .venv
BIN := $(VENV)/bin
# The tests' processes: one a core, at most 8.
WORKERS ?= logical
PYTEST_FLAGS ?=

# pyright comes whole from its wheels; this keeps it from asking the network for a newer one.
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1
# Packages of other environments stay out of this one.
unexport PYTHONPATH PYTHONHOME
# One thread a process: the work is split over processes, and sums come out the same everywhere.
test: export OMP_NUM_THREADS := 1

.PHONY: help demo test check format install setup clean

help:  ## What there is to make.
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):[^#]*## */\1\t/' | expand -t 10

demo: install  ## Train LC-RL on the mini benchmark and print the table.
	$(BIN)/python -m lcrl_bench.run --method lcrl --benchmark mini

test: setup  ## The whole test suite.
	$(BIN)/python -m pytest -n $(WORKERS) --maxprocesses 8 $(PYTEST_FLAGS)

check: setup  ## Lint, format and types.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright --pythonpath $(BIN)/python

format: setup  ## Rewrite the code in the house format.
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

install:  ## The virtual environment with what the suite needs, made or brought up to date.
	@PYTHON="$(PYTHON)" sh scripts/bootstrap.sh "$(VENV)" fast

setup:  ## The same, with what tests, lint and types need.
	@PYTHON="$(PYTHON)" sh scripts/bootstrap.sh "$(VENV)" dev

clean:  ## Remove the virtual environment and everything built.
	rm -rf "$(VENV)" build dist *.egg-info .pytest_cache .ruff_cache .hypothesis
