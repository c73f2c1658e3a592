"""How methods are found, and that listing them is cheap."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from lcrl_bench.errors import DuplicateNameError, UnknownNameError, UsageError
from lcrl_bench.methods import registry
from lcrl_bench.methods.contract import Method

ONE_FILE = """
import torch
from dataclasses import dataclass
from lcrl_bench.methods.contract import Method, Reward
from lcrl_bench.methods.tensors import TensorReward

class Zero(TensorReward):
    def score(self, views, commands):
        return torch.zeros(len(commands), len(views))

@dataclass(frozen=True)
class Settings:
    scale: float = 1.0

class MyMethod(Method):
    learns = Zero
    Config = Settings
    def __init__(self, config=None):
        self.config = config or Settings()
    def fit(self, train, *, generator, device, log, checkpoint=None):
        return Zero()

class Silent(MyMethod):
    learns = None

class Unsaved(MyMethod):
    learns = Reward

NOT_A_METHOD = 3
"""


def test_listing_methods_imports_neither_torch_nor_a_method():
    code = (
        "import sys; from lcrl_bench.methods.registry import method_registry; "
        "print([entry.name for entry in method_registry()]); "
        "print(sorted({'torch', 'numpy', 'mujoco'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names, heavy = run.stdout.splitlines()
    assert "lcrl" in names
    assert heavy == "[]"


def test_every_entry_resolves_to_a_method_and_says_what_it_is():
    for entry in registry.method_registry():
        assert issubclass(registry.resolve_method(entry.name), Method)
        assert 10 <= len(entry.summary) <= 100


def test_a_misspelt_method_suggests_the_nearest():
    with pytest.raises(UnknownNameError, match="Did you mean 'lcrl'"):
        registry.resolve_method("lcr1")


def test_a_method_in_a_file_is_found(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(ONE_FILE)
    found = registry.resolve_method(f"{path}:MyMethod")
    assert issubclass(found, Method)
    assert found.__name__ == "MyMethod"


def test_what_is_wrong_with_a_file_is_said(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(ONE_FILE)
    with pytest.raises(UsageError, match=r"mine.py has no class 'Other'"):
        registry.resolve_method(f"{path}:Other")
    with pytest.raises(UsageError, match="is not a subclass of lcrl_bench"):
        registry.resolve_method(f"{path}:NOT_A_METHOD")
    for name in ("Silent", "Unsaved"):
        with pytest.raises(UsageError, match="does not say what fit returns: add `learns"):
            registry.resolve_method(f"{path}:{name}")
    with pytest.raises(UsageError, match=r"No file .*absent\.py"):
        registry.resolve_method(f"{tmp_path}/absent.py:MyMethod")


def test_another_package_joins_by_an_entry_point(monkeypatch):
    point = EntryPoint("theirs", "lcrl_bench.baselines.lcrl.method:LcRl", "lcrl_bench.methods")
    monkeypatch.setattr(registry, "entry_points", lambda group: [point])
    assert issubclass(registry.resolve_method("theirs"), Method)


def test_another_package_can_not_take_the_name_of_a_baseline(monkeypatch):
    point = EntryPoint("lcrl", "somewhere:Else", "lcrl_bench.methods")
    monkeypatch.setattr(registry, "entry_points", lambda group: [point])
    with pytest.raises(DuplicateNameError, match="'lcrl' is already registered"):
        registry.method_registry()


@pytest.mark.parametrize(
    ("method", "name"),
    [
        ("lcrl", "lcrl"),
        ("counting.py:Counting", "counting"),
        ("my_method/method.py:MyMethod", "my_method"),
        ("/somewhere/My Ideas/method.py:MyMethod", "my-ideas"),
        ("method.py:MyMethod", "method"),
    ],
)
def test_runs_are_called_as_the_method_or_its_file_or_its_folder(method, name):
    assert registry.short_name(method) == name
