# `make demo` and `make test` do all their own set-up: Python 3.11 or 3.12 is all that is needed.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
WORKERS ?= 2

.PHONY: demo test check setup clean

demo: setup  ## Train LC-RL on the mini benchmark and print the table.
	$(BIN)/python -m lcrl_bench.run --method lcrl --benchmark mini

test: setup  ## The whole test suite.
	$(BIN)/python -m pytest -n $(WORKERS)

check: setup  ## Lint and types.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright

setup: $(VENV)/installed

$(VENV)/installed: pyproject.toml constraints.txt scripts/bootstrap.sh
	PYTHON="$(PYTHON)" sh scripts/bootstrap.sh "$(VENV)"

clean:
	rm -rf "$(VENV)" build *.egg-info
