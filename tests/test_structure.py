"""The code's shape: imports run one way down the floors, in no circle, and files stay small."""

from __future__ import annotations

import ast
import graphlib
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

from lcrl_bench.methods.source import handed_on

REPOSITORY = Path(__file__).parents[1]

FLOORS = (
    {
        *(
            "after_import",
            "attempt",
            "drawn",
            "drawn_array",
            "documents",
            "errors",
            "forking",
            "interruption",
            "jobs",
            "lazy",
            "names",
            "panoramas",
            "registry",
            "semantics",
            "streamed",
        ),
        *("staging", "storage", "version", ""),
    },
    {"houses"},
    {"mdp", "scenes"},
    {"networks", "benchmarks"},
    {"methods"},
    {"recording", "evaluation"},
    {"envs", "board", "play"},
    {"cli", "run", "__main__"},
    {"tools"},
)
"""Rooms of the library from the ground up; a room uses its own floor and those below.

On top `tools`, a folder outside the package: it is not shipped, so nothing shipped imports it.
"""

CONTENT = ("assets", "baselines", "leaderboard", "tasks")
"""Folders reached by name (importlib.resources, a registry), never by an import statement."""

FORBIDDEN = {
    "houses": {"mujoco", "dm_control", "torch", "rerun"},
    "scenes": {"torch", "rerun"},
    "benchmarks": {"rerun"},
    "mdp": {"lcrl_bench.houses", "lcrl_bench.scenes", "mujoco", "rerun"},
    "networks": {"lcrl_bench.houses", "lcrl_bench.scenes", "mujoco", "rerun"},
    "methods": {"lcrl_bench.houses", "lcrl_bench.scenes", "mujoco", "rerun"},
    "evaluation": {"rerun"},
    "envs": {"mujoco", "dm_control", "rerun"},
    "board": {"mujoco", "dm_control", "rerun"},
    "play": {"mujoco", "dm_control", "rerun"},
}
"""What a room never imports, besides what the floors rule out."""

BASELINES_MAY_USE = {
    *("methods", "networks", "mdp", "panoramas", "errors", "names", "storage", "semantics", ""),
}
"""Rooms that a method's own code builds on: no houses, no scenes, no harness."""

MAX_LINES = 400
VAGUE = {"utils", "util", "helpers", "helper", "common", "misc", "tools", "base", "core"}


@cache
def modules() -> dict[str, Path]:
    """Every module of the distribution and of `tools` by its import name."""
    found: dict[str, Path] = {}
    for top in ("lcrl_bench", "tools", *CONTENT):
        prefix = ("lcrl_bench",) if top in CONTENT else ()
        for path in sorted((REPOSITORY / top).rglob("*.py")):
            parts = path.relative_to(REPOSITORY).with_suffix("").parts
            name = ".".join(prefix + parts).removesuffix(".__init__")
            found[name] = path
    return found


@cache
def imports(module: str) -> frozenset[str]:
    """Names of what a module imports anywhere in it, functions and type checking included."""
    path = modules()[module]
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    names: set[str] = set()
    tree = ast.parse(path.read_text("utf-8"))
    # A package that hands names on imports none of them itself: who takes a name imports it.
    later = set(handed_on(tree).values())
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module not in later:
            names.update(_imported_from(node, package))
    return frozenset(names)


def _imported_from(node: ast.ImportFrom, package: str) -> Iterator[str]:
    ancestors = package.split(".")[: len(package.split(".")) - node.level + 1]
    base = ".".join([*(ancestors if node.level else ()), *([node.module] if node.module else ())])
    lazily = lazy_names_of(base)
    targets = [lazily.get(alias.name, f"{base}.{alias.name}") for alias in node.names]
    known = [name for name in targets if name in modules()]
    yield from known
    if len(known) < len(targets):
        yield base


@cache
def lazy_names_of(package: str) -> dict[str, str]:
    path = modules().get(package)
    return {} if path is None else handed_on(ast.parse(path.read_text("utf-8")))


def room(module: str) -> str:
    """The room of a module: `"scenes"` for `lcrl_bench.scenes.grid`; `"tools"` for any tool."""
    top, *inner = module.split(".")
    return "tools" if top == "tools" else "".join(inner[:1])


def within(name: str, prefixes: Iterable[str]) -> bool:
    return any(name == prefix or name.startswith(prefix + ".") for prefix in prefixes)


def library() -> list[str]:
    return [name for name in modules() if room(name) not in CONTENT]


def test_imports_are_read_from_the_sources():
    assert "lcrl_bench.errors" in imports("lcrl_bench.cli.main")
    assert "lcrl_bench.benchmarks.task_set" in imports("lcrl_bench.methods.contract")


def test_a_name_that_a_package_hands_on_is_imported_from_its_module():
    (taken,) = ast.parse("from lcrl_bench.mdp import soft_q_iteration").body
    assert isinstance(taken, ast.ImportFrom)
    assert list(_imported_from(taken, "lcrl_bench.methods")) == ["lcrl_bench.mdp.planning"]
    assert imports("lcrl_bench.mdp") == {"__future__", "typing", "lcrl_bench.lazy"}


def test_every_room_has_a_floor():
    known = set().union(*FLOORS)
    assert sorted({room(name) for name in library()} - known) == []


def test_no_import_goes_up_the_floors():
    level = {name: number for number, floor in enumerate(FLOORS) for name in floor}
    upward = [
        f"{module} imports {name}"
        for module in library()
        for name in imports(module)
        if name in modules() and room(name) in level and level[room(name)] > level[room(module)]
    ]
    assert upward == []


def test_nothing_that_ships_imports_a_tool():
    found = [
        f"{module} imports {name}"
        for module in modules()
        if room(module) != "tools"
        for name in imports(module)
        if within(name, ["tools"])
    ]
    assert found == []
    assert any(within(name, ["tools"]) for name in imports("tools.speed.measurement"))


def test_modules_import_each_other_in_no_circle():
    graph = {name: [n for n in imports(name) if n in modules() and n != name] for name in modules()}
    graphlib.TopologicalSorter(graph).prepare()


def test_rooms_import_each_other_in_no_circle():
    graph: dict[str, set[str]] = {}
    for module in library():
        uses = {room(name) for name in imports(module) if name in modules()}
        graph.setdefault(room(module), set()).update(uses - {room(module), ""})
    graphlib.TopologicalSorter(graph).prepare()


def test_a_circle_would_be_found():
    with pytest.raises(graphlib.CycleError):
        graphlib.TopologicalSorter({"a": {"b"}, "b": {"a"}}).prepare()


def test_the_library_reaches_its_content_by_name_only():
    content = [f"lcrl_bench.{folder}" for folder in CONTENT] + list(CONTENT)
    reaching = [
        f"{module} imports {name}"
        for module in library()
        for name in imports(module)
        if within(name, content)
    ]
    assert reaching == []


@pytest.mark.parametrize("place", sorted(FORBIDDEN))
def test_a_room_does_without_what_is_not_its_business(place: str):
    found = [
        f"{module} imports {name}"
        for module in library()
        if room(module) == place
        for name in imports(module)
        if within(name, FORBIDDEN[place])
    ]
    assert found == []


def test_only_one_folder_knows_rerun():
    home = "lcrl_bench.recording.rerun"
    knowing = {name for name in library() if any(within(n, ["rerun"]) for n in imports(name))}
    assert knowing
    assert sorted(name for name in knowing if not within(name, [home])) == []


def test_a_baseline_uses_the_library_and_no_other_baseline():
    wrong = []
    for module in modules():
        parts = module.split(".")
        if room(module) != "baselines" or len(parts) < 3:
            continue
        own = ".".join(parts[:3])
        for name in imports(module):
            other = within(name, ["lcrl_bench"]) and room(name) not in BASELINES_MAY_USE
            if other and not within(name, [own]):
                wrong.append(f"{module} imports {name}")
    assert wrong == []


def sources() -> list[Path]:
    folders = ("lcrl_bench", "tools", *CONTENT, "tests", "scripts")
    return [path for top in folders for path in sorted((REPOSITORY / top).rglob("*.py"))]


def test_no_file_is_longer_than_a_person_reads():
    lengths = {str(p.relative_to(REPOSITORY)): len(p.read_text().splitlines()) for p in sources()}
    assert {path: lines for path, lines in lengths.items() if lines > MAX_LINES} == {}


def test_no_module_has_a_vague_name():
    assert [str(path) for path in sources() if path.stem in VAGUE] == []


def test_test_files_have_names_of_their_own():
    names = [path.name for path in (REPOSITORY / "tests").rglob("test_*.py")]
    assert sorted({name for name in names if names.count(name) > 1}) == []


def test_no_test_has_a_deadline_that_a_busy_machine_misses():
    deadline = re.compile(
        r"(?:timeout\(|timeout=|join\(|monotonic\(\) \+ |perf_counter\(\) \+ )(\d+)"
    )
    short = [
        f"{file.name}: {found[0]}"
        for file in sorted((REPOSITORY / "tests").rglob("*.py"))
        for found in deadline.finditer(file.read_text("utf-8"))
        if int(found[1]) < 600
    ]
    assert short == []
    timed = re.compile(r"assert .*(?:perf_counter|monotonic|process_time)\(\) - ")
    for file in sorted((REPOSITORY / "tests").rglob("*.py")):
        assert timed.search(file.read_text("utf-8")) is None, file.name
