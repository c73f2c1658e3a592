"""`python -m tools.optics`: measures which camera pose shows enough to solve the tasks."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.benchmark_build import house_files
from lcrl_bench.cli.output import print_json, print_table, stdout_kept_clean
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

if TYPE_CHECKING:
    # At run time these would import torch before a mistyped flag is named.
    from lcrl_bench.houses.house import House
    from tools.optics.measurement import Optics

PROGRAM: Final = "python -m tools.optics"


@dataclass(frozen=True)
class OpticsFlags:
    """Measure how much cameras at different heights and pitches show of the tasks of some houses.

    Every combination of the given values is measured. Prints for each: tiles per house; tasks; the
    share of them solved by the optimal policy of the true reward projected onto what is seen
    (averaged over the cells that look alike, averaged over the states an episode can be in, and
    paid only where the goal is certain); pixels of the moved object at A and B from the tiles
    within reach; the share of PICK tasks whose object is seen at B from some and from all of those
    tiles; distinct views stored per panorama.
    """

    houses: Path | None = None
    """Folder of House JSON files."""
    seeds: tuple[int, ...] = ()
    """Generate houses from these seeds instead."""
    eye_height: tuple[float, ...] = (DEFAULT_SEMANTICS.eye_height,)
    """Metres above the floor."""
    pitch: tuple[float, ...] = (DEFAULT_SEMANTICS.pitch,)
    """Radians; negative looks down."""
    tile: tuple[float, ...] = (DEFAULT_SEMANTICS.tile,)
    """Tile side in metres."""
    agent_height: tuple[float, ...] = (DEFAULT_SEMANTICS.agent_height,)
    """Height of the agent's body in metres."""
    nav: int = 20
    """NAV tasks drawn per house, at most."""
    pick: int = 20
    """PICK tasks drawn per house, at most."""
    seed: int = 0
    """Seed for drawing tasks."""
    renderer: str = "rays"
    """auto, gl or rays."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the command."""
    flags = parse_arguments(OpticsFlags, argv, program=PROGRAM)
    from tools.optics.measurement import measure_optics

    variants = _variants(flags)
    with stdout_kept_clean(flags.json):
        houses = _houses(flags)
        with counting("houses", len(houses)) as advance:
            found = measure_optics(
                houses,
                variants,
                nav=flags.nav,
                pick=flags.pick,
                seed=flags.seed,
                renderer=flags.renderer,
                progress=advance,
            )
    if flags.json:
        print_json({"variants": [_row(one) for one in found]})
    else:
        _print(found)
    return ExitCode.DONE


def _variants(flags: OpticsFlags) -> list[Semantics]:
    _check(flags)
    grid = itertools.product(flags.tile, flags.agent_height, flags.eye_height, flags.pitch)
    return [
        replace(DEFAULT_SEMANTICS, tile=tile, agent_height=body, eye_height=eye, pitch=pitch)
        for tile, body, eye, pitch in grid
    ]


def _check(flags: OpticsFlags) -> None:
    for name in ("tile", "agent_height", "eye_height"):
        for value in getattr(flags, name):
            if not 0.1 <= value <= 2.5:
                flag = name.replace("_", "-")
                raise UsageError(f"--{flag} {value:g}: give metres between 0.1 and 2.5.")
    for pitch in flags.pitch:
        if not -1.5 <= pitch <= 1.5:
            raise UsageError(f"--pitch {pitch:g}: give radians between -1.5 (down) and 1.5 (up).")


def _houses(flags: OpticsFlags) -> list[House]:
    from lcrl_bench.houses.document import read_house
    from lcrl_bench.houses.procedural import generate_house

    if (flags.houses is None) == (not flags.seeds):
        raise UsageError("Give either --houses DIR or --seeds NUMBER ..., and not both.")
    if flags.houses is not None:
        return [read_house(file) for file in house_files(flags.houses)]
    return [generate_house(seed) for seed in flags.seeds]


def _row(found: Optics) -> dict[str, Any]:
    """All measurements of a variant, as plain values."""
    from lcrl_bench.benchmarks.dynamics import ObjectState

    names = {ObjectState.AT_A: "a", ObjectState.AT_B: "b"}
    semantics = found.semantics
    return {
        "eye_height": semantics.eye_height,
        "pitch": semantics.pitch,
        "tile": semantics.tile,
        "agent_height": semantics.agent_height,
        "houses": found.houses,
        "tiles": found.tiles,
        "unique_views": found.unique_views,
        "tasks": {kind.value: count for kind, count in found.tasks.items()},
        "optimal_length": {kind.value: mean for kind, mean in found.optimal_length.items()},
        "solved": {
            kind.value: {how.value: share for how, share in shares.items()}
            for kind, shares in found.solved.items()
        },
        "pixels": {names[place]: mean for place, mean in found.pixels.items()},
        "seen_from_some": {names[place]: share for place, share in found.seen_from_some.items()},
        "seen_from_all": {names[place]: share for place, share in found.seen_from_all.items()},
    }


def _print(found: Sequence[Optics]) -> None:
    columns = ("tile", "body", "eye", "pitch", "tiles", "nav", "pick", "length")
    shares = ("nav solved", "cells", "episode", "certain", "px A", "px B", "B some", "B all")
    rows = [_cells(_row(one)) for one in found]
    title = f"{found[0].houses} houses; solved and seen in % of the tasks"
    names = (*columns, *shares, "views")
    print_table(names, rows, title=title, right=names)


def _cells(row: dict[str, Any]) -> list[str]:
    def percent(share: float | None) -> str:
        return "-" if share is None else f"{100 * share:.1f}"

    def number(mean: float | None) -> str:
        return "-" if mean is None else f"{mean:.1f}"

    pick = row["solved"]["pick"]
    return [
        *(f"{row[name]:g}" for name in ("tile", "agent_height", "eye_height", "pitch")),
        number(row["tiles"]),
        str(row["tasks"]["nav"]),
        str(row["tasks"]["pick"]),
        number(row["optimal_length"]["pick"]),
        percent(row["solved"]["nav"]["episode"]),
        *(percent(pick[how]) for how in ("cells", "episode", "certain")),
        number(row["pixels"]["a"]),
        number(row["pixels"]["b"]),
        percent(row["seen_from_some"]["b"]),
        percent(row["seen_from_all"]["b"]),
        f"{row['unique_views']:.2f}",
    ]
