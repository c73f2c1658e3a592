"""`lcrl-bench list`: the names there are, one line each; fast, since it imports no torch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.inventory import InventoryKind, entries
from lcrl_bench.cli.output import print_json, print_table, say, suggest

NEXT: Final[dict[InventoryKind, tuple[tuple[str, ...], str]]] = {
    "methods": (("run", "--method"), "train and evaluate it"),
    # A name may be a method's too: `show` takes the kind where it must.
    "benchmarks": (("show", "--kind", "benchmarks"), "its tasks and houses"),
    "sources": (("show", "--kind", "sources"), "what it reads"),
}
"""Kind → the command to go on with, before the name, and what it does."""


@dataclass(frozen=True)
class ListArguments:
    """List the methods, benchmarks or house sources there are.

    Examples: `lcrl-bench list methods`, `lcrl-bench list benchmarks --json`.
    """

    kind: tyro.conf.Positional[InventoryKind]
    """What to list."""
    json: bool = False
    """Print one JSON object, {kind: [{name, summary, target}]}, and nothing else on stdout."""


def main(argv: Sequence[str]) -> int:
    """Print the entries of a kind."""
    arguments = parse_arguments(ListArguments, argv, verb="list")
    found = entries(arguments.kind)
    if arguments.json:
        print_json({arguments.kind: [asdict(entry) for entry in found]})
        return 0
    print_table(("name", "summary"), [(entry.name, entry.summary) for entry in found])
    if not found:
        say(f"There are no {arguments.kind}.")
        return 0
    words, purpose = NEXT[arguments.kind]
    suggest(("lcrl-bench", *words, found[0].name), purpose)
    return 0
