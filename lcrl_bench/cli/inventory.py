"""`lcrl-bench list` and `lcrl-bench show`: methods, benchmarks and house sources.

The registries are imported when needed, and none of them imports torch or MuJoCo.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import (
    print_json,
    print_table,
    print_text,
    say,
    stdout_kept_clean,
    suggest,
)
from lcrl_bench.errors import ExitCode, UnknownNameError
from lcrl_bench.registry import Entry
from lcrl_bench.storage import read_json

InventoryKind = Literal["methods", "benchmarks", "sources"]

KINDS: Final[tuple[InventoryKind, ...]] = ("methods", "benchmarks", "sources")
NEXT: Final[dict[InventoryKind, tuple[tuple[str, ...], str]]] = {
    "methods": (("run", "--method"), "train and evaluate it"),
    # A method may have the same name, so `show` is given the kind.
    "benchmarks": (("show", "--kind", "benchmarks"), "its tasks and houses"),
    "sources": (("show", "--kind", "sources"), "what it reads"),
}
"""Kind → the command to continue with, up to the name, and what it does."""


@dataclass(frozen=True)
class ListArguments:
    """List methods, benchmarks or house sources.

    Examples: `lcrl-bench list methods`, `lcrl-bench list benchmarks --json`.
    """

    kind: tyro.conf.Positional[InventoryKind]
    """What to list."""
    json: bool = False
    """Print only a JSON object on stdout: {kind: [{name, summary, target}]}."""


@dataclass(frozen=True)
class ShowArguments:
    """Show everything known about a method, benchmark or house source.

    Examples: `lcrl-bench show lcrl`, `lcrl-bench show mini --json`.
    """

    name: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="NAME")]
    """A name printed by `lcrl-bench list`, or the folder of a benchmark."""
    kind: InventoryKind | None = None
    """Kind of the name; only needed if it is ambiguous."""
    json: bool = False
    """Print only a JSON object on stdout."""


def run_list(argv: Sequence[str]) -> int:
    """Print the entries of a kind."""
    arguments = parse_arguments(ListArguments, argv, verb="list")
    found = entries(arguments.kind)
    if arguments.json:
        print_json({arguments.kind: [asdict(entry) for entry in found]})
        return ExitCode.DONE
    print_table(("name", "summary"), [(entry.name, entry.summary) for entry in found])
    if not found:
        say(f"There are no {arguments.kind}.")
        return ExitCode.DONE
    words, purpose = NEXT[arguments.kind]
    suggest(("lcrl-bench", *words, found[0].name), purpose)
    return ExitCode.DONE


def run_show(argv: Sequence[str]) -> int:
    """Print everything known about a name."""
    arguments = parse_arguments(ShowArguments, argv, verb="show")
    with stdout_kept_clean(arguments.json):
        kind, entry = find(arguments.name, arguments.kind)
        facts = {"kind": kind.removesuffix("s"), **FACTS[kind](entry)}
    if arguments.json:
        print_json(facts)
    else:
        _print_facts(facts)
    if kind != "sources":
        words = ["--method", entry.name]
        if kind == "benchmarks":
            # A benchmark that is not shipped is found by its path only.
            words = ["--method", "lcrl", "--benchmark", arguments.name]
        suggest(["lcrl-bench", "run", *words], "train and evaluate")
    return ExitCode.DONE


def entries(kind: InventoryKind) -> tuple[Entry, ...]:
    """All entries of a kind, sorted by name; the target of a benchmark is its folder."""
    return {"methods": _methods, "benchmarks": _benchmarks, "sources": _sources}[kind]()


def _methods() -> tuple[Entry, ...]:
    from lcrl_bench.methods.registry import method_registry

    return tuple(method_registry())


def _sources() -> tuple[Entry, ...]:
    from lcrl_bench.houses.sources import house_sources

    return tuple(house_sources())


def _benchmarks() -> tuple[Entry, ...]:
    from lcrl_bench.benchmarks.catalogue import benchmark_folder, list_benchmarks

    found = []
    for name in list_benchmarks():
        folder = benchmark_folder(name)
        head = read_json(folder / "benchmark.json")
        summary = f"{len(head['houses'])} houses, fingerprint {head['fingerprint'][:12]}"
        found.append(Entry(name, str(folder), summary))
    return tuple(found)


def find(name: str, kind: InventoryKind | None) -> tuple[InventoryKind, Entry]:
    """Look a name up among methods first, then benchmarks, then sources.

    Raises:
        UnknownNameError: If nothing has that name; suggests the nearest and lists all.
    """
    if (Path(name) / "benchmark.json").is_file():
        return "benchmarks", Entry(Path(name).resolve().name, name, "a benchmark folder")
    kinds = KINDS if kind is None else (kind,)
    known: dict[str, tuple[InventoryKind, Entry]] = {}
    for each in reversed(kinds):
        known.update({entry.name: (each, entry) for entry in entries(each)})
    if name not in known:
        raise UnknownNameError(" or ".join(k.removesuffix("s") for k in kinds), name, known)
    return known[name]


def _method_facts(entry: Entry) -> dict[str, Any]:
    return {**_entry_facts(entry), "readme": _readme(entry.target)}


def _readme(target: str) -> str:
    # Next to the module, found without importing it.
    package = target.partition(":")[0].rpartition(".")[0]
    spec = importlib.util.find_spec(package) if package else None
    folders = list(spec.submodule_search_locations or ()) if spec else []
    files = [path for folder in folders if (path := Path(folder) / "README.md").is_file()]
    return files[0].read_text("utf-8") if files else ""


def _entry_facts(entry: Entry) -> dict[str, Any]:
    return {"name": entry.name, "summary": entry.summary, "code": entry.target}


def _benchmark_facts(entry: Entry) -> dict[str, Any]:
    from lcrl_bench.benchmarks.description import describe_benchmark
    from lcrl_bench.benchmarks.document import read_benchmark

    benchmark = read_benchmark(Path(entry.target))
    semantics = asdict(benchmark.semantics)
    return {**describe_benchmark(benchmark), "folder": entry.target, "semantics": semantics}


FACTS: Final[dict[InventoryKind, Callable[[Entry], dict[str, Any]]]] = {
    "methods": _method_facts,
    "benchmarks": _benchmark_facts,
    "sources": _entry_facts,
}
"""Kind → the facts about an entry."""


def _print_facts(facts: dict[str, Any]) -> None:
    shown = {key: value for key, value in facts.items() if key not in ("readme", "kind")}
    width = max(map(len, shown))
    for key, value in shown.items():
        print_text(f"{key.replace('_', ' '):{width}}  {_short(value)}")
    if facts.get("readme"):
        print_text(f"\n{facts['readme'].rstrip()}")


def _short(value: object) -> str:
    if isinstance(value, list):
        return " ".join(map(str, value))
    if isinstance(value, dict):
        return ", ".join(f"{key} {_short(item)}" for key, item in value.items())
    return str(value)
