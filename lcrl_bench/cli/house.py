"""`lcrl-bench house`: turn any house into House JSON, MJCF and a picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, suggest
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, InvalidFileError, LcrlError, UsageError
from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.storage import writing

HELP = """usage: lcrl-bench house import|generate|show [FLAGS]

  import    read house files of any known format (ProcTHOR, House JSON)
  generate  generate houses from seeds
  show      draw a house and list its contents

The first two write OUT/<id>/house.json (House JSON), OUT/<id>/scene/scene.xml (MJCF) and
OUT/<id>/plan.png.
`lcrl-bench house import --help` shows the flags."""

Json = Annotated[bool, tyro.conf.FlagCreatePairsOff]


@dataclass(frozen=True)
class ImportFlags:
    """Read house files of any known format, check them, and write House JSON, MJCF and a plan."""

    files: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """House files; a bad one is reported with the reason, and the others are still imported."""
    out: Path
    """Folder to write to."""
    source: str | None = None
    """Source of the files (see `lcrl-bench list sources`); detected by default."""
    json: Json = False
    """Print only a JSON object on stdout."""


@dataclass(frozen=True)
class GenerateFlags:
    """Generate houses from seeds."""

    out: Path
    """Folder to write to."""
    seeds: tuple[int, ...] = (0,)
    """One house per seed."""
    count: int = 1
    """Houses per seed, from consecutive seeds: `--seeds 100 --count 76` makes 100 to 175."""
    rooms: int | None = None
    """Number of rooms; drawn from the seed by default."""
    json: Json = False
    """Print only a JSON object on stdout."""


@dataclass(frozen=True)
class ShowFlags:
    """Draw a house from above and list its contents."""

    file: Annotated[Path, tyro.conf.Positional]
    """A house file of any known format."""
    out: Path = Path("house.png")
    """The picture: .png or .svg."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    verbs = {
        "import": _import,
        "generate": _generate,
        "show": _show,
    }
    moved = {"statistics": "python -m tools.house_statistics"}
    return run_verb(argv, verbs, kind="house verb", help_text=HELP, moved=moved)


def _import(argv: Sequence[str]) -> int:
    flags = parse_arguments(ImportFlags, argv, verb="house import")
    from lcrl_bench.houses.sources import import_house

    def read(path: Path) -> Callable[[], ImportedHouse]:
        return lambda: import_house(path, source=flags.source)

    return _write_all({str(path): read(path) for path in flags.files}, flags.out, flags.json)


def _generate(argv: Sequence[str]) -> int:
    flags = parse_arguments(GenerateFlags, argv, verb="house generate")
    from lcrl_bench.houses.procedural import generate_house

    def make(seed: int) -> Callable[[], ImportedHouse]:
        return lambda: ImportedHouse(generate_house(seed, rooms=flags.rooms), (), 1.0, ())

    if flags.count < 1:
        raise UsageError(f"--count must be at least 1, found {flags.count}.")
    seeds = [seed + k for seed in flags.seeds for k in range(flags.count)]
    return _write_all({f"seed {seed}": make(seed) for seed in seeds}, flags.out, flags.json)


def _write_all(makers: dict[str, Callable[[], ImportedHouse]], out: Path, json: bool) -> int:
    """Make, check and write every house; report the ones that fail and continue."""
    rows: list[dict[str, Any]] = []
    with stdout_kept_clean(json), counting("houses", len(makers)) as advance:
        for origin, make in makers.items():
            rows.append(_write_one(origin, make, out, {row["id"] for row in rows}))
            advance(origin)
    failed = [row for row in rows if row["errors"]]
    if json:
        print_json({"houses": rows})
        return ExitCode.RED if failed else ExitCode.DONE
    columns = ("id", "source", "rooms", "objects", "tiles", "reachable", "classes")
    good = [row for row in rows if not row["errors"]]
    cells = [[*(row[column] for column in columns), f"{row['label_coverage']:.0%}"] for row in good]
    print_table((*columns, "labels known"), cells, right=(*columns[2:], "labels known"))
    for row in good:
        for note in row["notes"]:
            say(f"{row['id']}: {note}")
    for row in failed:
        for error in row["errors"]:
            say(f"error: {error}", style="bold red")
    if good:
        build = ["lcrl-bench", "benchmark", "build", "--houses", str(out)]
        suggest([*build, "--out", "BENCHMARK", "--name", "mine"], "make a benchmark of them")
    return ExitCode.RED if failed else ExitCode.DONE


def _write_one(
    origin: str, make: Callable[[], ImportedHouse], out: Path, taken: set[str]
) -> dict[str, Any]:
    from lcrl_bench.recording.pictures import house_picture
    from lcrl_bench.scenes.report import write_house_folder

    try:
        imported = make()
        if imported.house.id in taken:
            reason = f"another house of this call is also called '{imported.house.id}'"
            raise InvalidFileError(origin, reason, fix="Rename the file.")
        # On a full disk, the mesh writer doesn't name its file.
        with writing(out / imported.house.id):
            row, grid = write_house_folder(imported, out / imported.house.id)
        house_picture(out / imported.house.id / "plan.png", imported.house, grid)
        return row
    except LcrlError as error:
        empty: dict[str, Any] = dict.fromkeys(
            ("source", "rooms", "objects", "tiles", "reachable", "classes", "label_coverage")
        )
        unwritten = {"unmapped": [], "notes": [], "house": None, "mjcf": None}
        return {"id": Path(origin).stem, **empty, **unwritten, "errors": [str(error)]}


def _show(argv: Sequence[str]) -> int:
    flags = parse_arguments(ShowFlags, argv, verb="house show")
    from lcrl_bench.houses.sources import import_house
    from lcrl_bench.recording.pictures import house_picture
    from lcrl_bench.scenes.walkable import build_grid
    from lcrl_bench.semantics import DEFAULT_SEMANTICS

    house = import_house(flags.file).house
    grid = build_grid(house, DEFAULT_SEMANTICS)
    house_picture(flags.out, house, grid)
    rows = [
        (
            room.id,
            room.type.value,
            sum(thing.room == room.id for thing in house.objects),
            grid.rooms.count(room.id),
        )
        for room in house.rooms
    ]
    print_table(
        ("room", "type", "objects", "tiles"), rows, title=house.id, right=("objects", "tiles")
    )
    say(f"picture: {flags.out}")
    return ExitCode.DONE
