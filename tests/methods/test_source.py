"""Which files a method and the suite consist of: edit one, and the digest is another."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from lcrl_bench.errors import UsageError
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.source import method_source, suite_files, suite_source

METHOD = """
import json
import numpy
from lcrl_bench.methods.contract import Method
from lcrl_bench.methods.tensors import TensorReward
import beside_it
class Mine(Method):
    class learns(TensorReward):
        def score(self, views, commands): ...
    def fit(self, train, *, generator, device, log, checkpoint=None):
        from late_import import something
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A method with two files that it imports, one of them late, and one that it does not."""
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("beside_it", "deeper", "late_import"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    (tmp_path / "mine.py").write_text(METHOD)
    (tmp_path / "beside_it.py").write_text("import deeper")
    (tmp_path / "deeper.py").write_text("")
    (tmp_path / "late_import.py").write_text("something = 1")
    (tmp_path / "stranger.py").write_text("")
    return tmp_path


def source(folder: Path) -> dict[str, str]:
    return method_source(resolve_method(f"{folder / 'mine.py'}:Mine"))


def test_a_method_is_its_file_and_what_that_imports(folder):
    assert set(source(folder)) == {"mine.py", "beside_it.py", "deeper.py", "late_import.py"}


@pytest.mark.parametrize("name", ["mine.py", "beside_it.py", "deeper.py", "late_import.py"])
def test_an_edit_of_any_of_them_shows_in_its_digest(name, folder):
    before = source(folder)
    with (folder / name).open("a") as file:
        file.write("# edited\n")
    after = source(folder)
    assert {key for key in before if before[key] != after[key]} == {name}


def test_an_edit_while_a_method_is_at_work_does_not_change_what_it_is(folder):
    at_work = resolve_method(f"{folder / 'mine.py'}:Mine")
    before = method_source(at_work)
    (folder / "mine.py").write_text(METHOD + "# edited")
    assert method_source(at_work) == before


def test_two_files_of_one_name_are_two_methods(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "method.py").write_text(
            METHOD.replace("import beside_it", f"# {name}").replace("late_import", "json")
        )
    classes = [resolve_method(f"{tmp_path / name / 'method.py'}:Mine") for name in ("a", "b")]
    assert method_source(classes[0]) != method_source(classes[1])


def test_a_baseline_is_its_folder_and_stays_so_under_a_method_built_on_it(tmp_path):
    own = set(method_source(resolve_method("lcrl")))
    assert own == {"lcrl_bench.baselines.lcrl", "lcrl_bench.baselines.lcrl.method"}
    (tmp_path / "built.py").write_text(
        "from lcrl_bench.baselines.lcrl.method import LcRl\nclass Built(LcRl): ...\n"
    )
    built = method_source(resolve_method(f"{tmp_path / 'built.py'}:Built"))
    assert set(built) == {"built.py", *own}


def test_the_suites_code_is_what_a_run_goes_through():
    files = suite_files(resolve_method("lcrl"))
    assert {
        "lcrl_bench.evaluation.harness",
        "lcrl_bench.mdp.kernels.maximum_entropy",
        "lcrl_bench.mdp.dqn.agents",
        "lcrl_bench.methods.network_method",
        "lcrl_bench.networks.kernels.panorama_encoder",
        "lcrl_bench.scenes.panoramas.rays",
        "lcrl_bench.storage",
    } <= set(files)
    rooms = {name.split(".")[1] for name in files if "." in name}
    assert not rooms & {"baselines", "board", "cli", "envs", "play", "recording", "tasks"}


def test_a_method_without_networks_does_not_depend_on_them(folder):
    files = suite_files(resolve_method(f"{folder / 'mine.py'}:Mine"))
    assert not [name for name in files if name.startswith("lcrl_bench.networks")]
    assert suite_source(resolve_method("lcrl")) != suite_source() == suite_source(None)


def networks(folder: Path, line: str) -> set[str]:
    """Which files of the networks a method with such an import depends on."""
    (folder / "mine.py").write_text(f"{METHOD}\n{line}\n")
    names = suite_files(resolve_method(f"{folder / 'mine.py'}:Mine"))
    return {name.partition(".networks")[2] for name in names if ".networks" in name}


def test_a_name_that_a_package_hands_on_counts_with_its_module_alone(folder):
    found = networks(folder, "from lcrl_bench.networks import Vocabulary")
    assert found == {"", ".vocabulary"}


@pytest.mark.parametrize(
    "line",
    [
        "import lcrl_bench.networks",
        "from lcrl_bench import networks",
        "from lcrl_bench.networks import *",
    ],
)
def test_a_package_taken_whole_counts_with_all_that_it_hands_on(line, folder):
    assert {"", ".vocabulary", ".policy_network", ".kernels.lanes"} <= networks(folder, line)


def test_a_class_in_no_file_is_refused():
    made = type("Made", (resolve_method("lcrl"),), {"__module__": "nowhere"})
    with pytest.raises(UsageError, match="The class Made is in no file"):
        method_source(made)
