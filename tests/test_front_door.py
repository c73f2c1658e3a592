"""The front door: the script of the README, the examples of docstrings, what importing costs."""

from __future__ import annotations

import doctest
import inspect
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lcrl_bench
from lcrl_bench.drawn_array import DrawnArray
from lcrl_bench.errors import UnknownNameError, UsageError

ROOT = Path(__file__).parents[1]
NAMES = (
    *("House", "Method", "Policy", "Results", "Reward", "Scene", "Task"),
    *("evaluate", "generate_house", "import_house"),
    *("list_benchmarks", "list_methods", "load_benchmark", "run"),
)


@pytest.fixture(scope="module")
def workplace(tmp_path_factory) -> Path:
    """One folder for all: what the script has trained, the examples read back."""
    return tmp_path_factory.mktemp("front-door")


def python(program: str, folder: Path | None = None) -> str:
    found = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True
    )
    assert found.returncode == 0, found.stderr
    return found.stdout


def test_the_names_are_these():
    assert tuple(lcrl_bench.__all__) == NAMES


def test_importing_the_package_imports_nothing_heavy():
    heavy = "{'torch', 'mujoco', 'numpy', 'gymnasium', 'matplotlib', 'pydantic'}"
    assert python(f"import lcrl_bench, sys; print({heavy} & set(sys.modules))") == "set()\n"


@pytest.mark.parametrize(
    "imports", ["import gymnasium, lcrl_bench", "import lcrl_bench, gymnasium"]
)
def test_gymnasium_makes_the_environment_whichever_was_imported_first(imports):
    make = "gymnasium.make('lcrl_bench/House-v1', benchmark='mini')"
    assert "House-v1" in python(f"{imports}; print({make}.spec.id)")


def test_gymnasium_is_still_the_module_that_it_is():
    program = (
        "import lcrl_bench, gymnasium, sys; print(type(gymnasium.__loader__).__name__, end=' ')"
    )
    program += "; print(type(gymnasium.__spec__.loader).__name__, len(sys.meta_path))"
    plain = "import gymnasium, sys; print(type(gymnasium.__loader__).__name__, end=' ')"
    plain += "; print(type(gymnasium.__spec__.loader).__name__, len(sys.meta_path))"
    assert python(program) == python(plain)


@pytest.mark.timeout(900)
def test_the_script_of_the_readme_works_as_written(workplace):
    (script,) = re.findall(r"```python\n(import lcrl_bench\n.*?)```", README, re.DOTALL)
    # What a reader would look at next.
    script += """
assert (results.seeds, len(results.to_pandas())) == ((0, 1, 2), 3 * len(benchmark.tasks))
assert task.panorama(tile=4).shape == (4, 24, 32)
assert reward.map(task).shape == (1, benchmark.grids[task.house].tiles)
for shown in (results, benchmark.houses[task.house], reward.map(task), reward.plan(task)):
    assert shown._repr_html_().startswith("<")
"""
    printed = python(script, workplace)
    assert "test-house: success, %" in printed
    assert "95 % interval" in printed
    assert (workplace / "episode.rrd").stat().st_size > 100_000


README = (ROOT / "README.md").read_text("utf-8")


@pytest.mark.timeout(900)
@pytest.mark.parametrize("name", [*NAMES, "Benchmark", "Panoramas"])
def test_the_example_of_a_name_gives_what_it_shows(name, workplace, monkeypatch):
    from lcrl_bench.benchmarks import Benchmark
    from lcrl_bench.panoramas import Panoramas

    monkeypatch.chdir(workplace)
    beside = {"Benchmark": Benchmark, "Panoramas": Panoramas}
    thing = beside[name] if name in beside else getattr(lcrl_bench, name)
    example = doctest.DocTestParser().get_doctest(
        inspect.getdoc(thing) or "", {"lcrl_bench": lcrl_bench}, name, None, None
    )
    assert example.examples, f"{name} has no example"
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    failed = runner.run(example, out=said.append).failed
    assert not failed, "".join(said)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"method": "lcl"}, "Did you mean 'lcrl'"),
        ({"benchmark": "minni"}, "Did you mean 'mini'"),
        ({"optimizer": "dqnn"}, "Did you mean 'dqn'"),
        ({"settings": {"passs": 2}}, "Did you mean 'passes'"),
    ],
)
def test_a_mistyped_name_is_answered_with_the_nearest(settings, said):
    with pytest.raises(UnknownNameError, match=said):
        lcrl_bench.run(**{"method": "lcrl", "benchmark": "mini", **settings})


@pytest.mark.parametrize(("seeds", "said"), [([], "no seed"), ([1, 0, 1], "1 is repeated")])
def test_seeds_are_each_one_run(seeds, said):
    with pytest.raises(UsageError, match=said):
        lcrl_bench.run("lcrl", "mini", seeds=seeds)


def test_seeds_may_be_an_array(workplace, monkeypatch):
    monkeypatch.chdir(workplace)
    quick = {"passes": 1, "least_steps": 1}
    seeds = np.arange(2)
    results = lcrl_bench.run("lcrl", "mini", seeds=seeds, settings=quick, progress=False)
    assert results.seeds == (0, 1)


def test_tasks_are_found_by_split():
    tasks = lcrl_bench.load_benchmark("mini").tasks
    assert sum(len(tasks[name]) for name in ("train", "test-task", "test-house")) == len(tasks)
    assert {task.split for task in tasks["test-house"]} == {"test-house"}
    with pytest.raises(UnknownNameError, match="test-task"):
        _ = tasks["test"]


def test_a_task_sees_what_its_environment_shows():
    benchmark = lcrl_bench.load_benchmark("mini")
    task = next(task for task in benchmark.tasks if task.kind == "pick")
    one = task.single()
    for object_state in range(3):
        cell = object_state * one.tiles + 4
        seen = task.panorama(tile=4, object_state=object_state)
        assert np.array_equal(seen, one.panorama(cell * 4))
    with pytest.raises(UsageError, match="its tiles are 0 to"):
        task.panorama(tile=10_000)
    with pytest.raises(UsageError, match="object states 0 to 2"):
        task.panorama(object_state=3)


def test_a_task_of_no_benchmark_says_where_to_take_it_from():
    from dataclasses import replace

    task = replace(lcrl_bench.load_benchmark("mini").tasks[0], home=None)
    with pytest.raises(UsageError, match="was not loaded with a benchmark"):
        task.panorama()


def test_the_home_of_a_task_is_not_part_of_it():
    from lcrl_bench.benchmarks import benchmark_folder, read_benchmark

    loaded, read = lcrl_bench.load_benchmark("mini"), read_benchmark(benchmark_folder("mini"))
    assert loaded.tasks == read.tasks
    assert loaded.fingerprint == read.fingerprint


def test_a_part_of_a_drawn_array_is_numbers_only():
    whole = DrawnArray(np.arange(6).reshape(2, 3), "subject")
    assert whole.subject == "subject"
    for part in (whole[0], whole + 1, whole.copy()):
        assert part.subject is None
        assert part._repr_html_() is None


def test_a_class_and_an_instance_are_run_as_their_name_is(workplace, monkeypatch):
    from lcrl_bench.methods import resolve_method

    monkeypatch.chdir(workplace)
    lcrl = resolve_method("lcrl")
    short = {"passes": 1, "least_steps": 1}
    named = lcrl_bench.run("lcrl", "mini", settings=short, progress=False)
    instance = lcrl(lcrl.Config(passes=1, least_steps=1))
    for method, settings in ((lcrl, short), (instance, None)):
        again = lcrl_bench.run(method, "mini", settings=settings, progress=False)
        assert again.method == "lcrl"
        assert np.array_equal(again.values["success"], named.values["success"])
    assert len(list(Path("runs/mini").glob("lcrl-*"))) == 1


def test_what_is_returned_is_shown_in_a_line(workplace, monkeypatch):
    monkeypatch.chdir(workplace)
    benchmark = lcrl_bench.load_benchmark("mini")
    assert repr(benchmark).startswith("Benchmark(mini: 12 houses, 237 tasks, fingerprint ")
    assert repr(lcrl_bench.generate_house(0)) == "House(procedural-0: 6 rooms, 72 objects)"
    quick = {"passes": 1, "least_steps": 1}
    results = lcrl_bench.run("lcrl", benchmark, settings=quick, progress=False)
    assert repr(results) == "Results(lcrl: seeds 0; 237 tasks)"
