"""Packages hand on the names of their modules, and import nothing until one is used."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

from lcrl_bench.methods.source import handed_on

PACKAGES = (
    "lcrl_bench",
    "lcrl_bench.benchmarks",
    "lcrl_bench.evaluation",
    "lcrl_bench.houses",
    "lcrl_bench.mdp",
    "lcrl_bench.mdp.dqn",
    "lcrl_bench.methods",
    "lcrl_bench.networks",
    "lcrl_bench.recording",
    "lcrl_bench.scenes",
)


@pytest.mark.parametrize("package", PACKAGES)
def test_importing_a_package_imports_neither_torch_nor_numba(package):
    program = f"import {package}, sys; sys.exit(bool({{'torch', 'numba'}} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


@pytest.mark.parametrize("package", PACKAGES)
def test_a_type_checker_sees_the_names_that_are_there(package):
    module = importlib.import_module(package)
    assert module.__file__
    seen = handed_on(ast.parse(Path(module.__file__).read_text("utf-8")))
    assert sorted(seen) == module.__all__
    for name, home in seen.items():
        assert getattr(module, name) is getattr(importlib.import_module(home), name)
    assert set(module.__all__) <= set(dir(module))


@pytest.mark.parametrize("package", PACKAGES)
def test_no_name_is_that_of_a_module_of_its_package(package):
    module = importlib.import_module(package)
    modules = {found.name for found in pkgutil.iter_modules(module.__path__)}
    # The module `lcrl_bench.run` is for `python -m`; see the test below.
    allowed = {"run"} if package == "lcrl_bench" else set()
    assert not modules & set(module.__all__) - allowed


def test_importing_the_module_named_run_leaves_a_function_to_call():
    program = "import lcrl_bench.run, lcrl_bench; lcrl_bench.run('nothing', seeds=[])"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "UsageError: There is no seed to run" in found.stderr


@pytest.mark.parametrize("package", PACKAGES)
def test_an_unknown_name_is_an_attribute_error(package):
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'solve_it'"):
        _ = importlib.import_module(package).solve_it
