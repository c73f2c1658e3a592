"""`lcrl-bench benchmark gallery`: a sheet of a benchmark's houses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import say
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, UnknownNameError


@dataclass(frozen=True)
class GalleryFlags:
    """Draw houses of a benchmark from above, and as an agent in them sees them."""

    benchmark: Annotated[str, tyro.conf.Positional]
    """A shipped benchmark's name, or a folder."""
    houses: tuple[str, ...] = ()
    """Which houses; none means the first dozen."""
    out: Path = Path("gallery.png")
    """The picture: .png, .svg or .pdf."""
    theme: Literal["light", "dark"] = "light"
    """The page it is for."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(GalleryFlags, argv, verb="benchmark gallery")
    import numpy as np

    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.benchmarks.observation import arrangements_of
    from lcrl_bench.recording.gallery import Exhibit, gallery_picture, most_telling

    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    for name in flags.houses:
        if name not in benchmark.houses:
            raise UnknownNameError("house", name, benchmark.houses)
    names = flags.houses or tuple(sorted(benchmark.houses))[:12]
    exhibits = []
    with counting("houses", len(names)) as advance:
        for name in names:
            # The first panoramas are those of the house as found, one per tile.
            arrangements = arrangements_of(benchmark.select(house=name))
            views = benchmark.scene(name).panoramas(arrangements)
            seen = np.stack([views.pixels(k) for k in range(benchmark.grids[name].tiles)])
            exhibits.append(Exhibit(benchmark.houses[name], seen[most_telling(seen)]))
            advance(name)
    gallery_picture(flags.out, exhibits, flags.theme)
    say(f"picture: {flags.out}")
    return ExitCode.DONE
