"""`lcrl-bench show`: everything known about one method, benchmark or house source."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.inventory import KINDS, InventoryKind, entries
from lcrl_bench.cli.output import print_json, print_text, stdout_kept_clean, suggest
from lcrl_bench.errors import UnknownNameError
from lcrl_bench.registry import Entry


@dataclass(frozen=True)
class ShowArguments:
    """Show what is known about one method, benchmark or house source.

    Examples: `lcrl-bench show lcrl`, `lcrl-bench show mini --json`.
    """

    name: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="NAME")]
    """A name that `lcrl-bench list` prints, or the folder of a benchmark."""
    kind: InventoryKind | None = None
    """Where to look it up; only needed for a name of more than one kind."""
    json: bool = False
    """Print one JSON object and nothing else on stdout."""


def main(argv: Sequence[str]) -> int:
    """Print what is known about a name."""
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
            # A folder of one's own is found by its path alone.
            words = ["--method", "lcrl", "--benchmark", arguments.name]
        suggest(["lcrl-bench", "run", *words], "train and evaluate")
    return 0


def find(name: str, kind: InventoryKind | None) -> tuple[InventoryKind, Entry]:
    """The entry of a name, looked up among methods first, then benchmarks, then sources.

    Raises:
        UnknownNameError: If there is none; suggests the nearest and lists all.
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
    # Beside the module, found without importing it.
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
"""Kind → what is known about an entry of it."""


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
