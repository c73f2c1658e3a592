"""`lcrl-bench house`: turn any house into House JSON, MJCF and a picture."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.fan_out import HOUSES_PER_WORKER, FanOut, command_of, do_jobs, say_part
from lcrl_bench.cli.house_jobs import generate_house_job, import_house_job
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, suggest
from lcrl_bench.errors import ExitCode, InvalidFileError, LcrlError, UsageError
from lcrl_bench.interruption import resumable
from lcrl_bench.jobs.job import Job, forget

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
    """House files, or folders of them (*.json); a bad one is reported with the reason, and the
    others are still imported."""
    out: Path
    """Folder to write to."""
    source: str | None = None
    """Source of the files (see `lcrl-bench list sources`); detected by default."""
    json: Json = False
    """Print only a JSON object on stdout."""
    fan_out: FanOut = field(default_factory=FanOut)


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
    fan_out: FanOut = field(default_factory=FanOut)


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

    files = [file for path in flags.files for file in _files(path)]
    rows: dict[str, dict[str, Any]] = {}
    jobs, taken = [], set()
    for path in files:
        # Names first: of two houses with one name, the first is imported, whichever is faster.
        try:
            name = import_house(path, source=flags.source).house.id
            if name in taken:
                reason = f"another house of this call is also called '{name}'"
                raise InvalidFileError(path, reason, fix="Rename the file.")
        except LcrlError as error:
            rows[str(path)] = _failed(str(path), error)
            continue
        taken.add(name)
        jobs.append(import_house_job(path, flags.source, name, flags.out))
    return _write_all(jobs, rows, [str(path) for path in files], flags, ["import", *argv])


def _files(path: Path) -> list[Path]:
    """A file, or all JSON files of a folder."""
    return sorted(path.glob("*.json")) if path.is_dir() else [path]


def _generate(argv: Sequence[str]) -> int:
    flags = parse_arguments(GenerateFlags, argv, verb="house generate")
    from lcrl_bench.houses.procedural import house_id

    if flags.count < 1:
        raise UsageError(f"--count must be at least 1, found {flags.count}.")
    seeds = [seed + k for seed in flags.seeds for k in range(flags.count)]
    if doubled := [seed for seed, count in Counter(seeds).items() if count > 1]:
        raise UsageError(f"--seeds and --count name seed {doubled[0]} twice.")
    jobs = [generate_house_job(seed, flags.rooms, house_id(seed), flags.out) for seed in seeds]
    return _write_all(jobs, {}, [job.name for job in jobs], flags, ["generate", *argv])


def _write_all(
    jobs: Sequence[Job],
    rows: dict[str, dict[str, Any]],
    order: Sequence[str],
    flags: ImportFlags | GenerateFlags,
    words: Sequence[str],
) -> int:
    """Make, check and write every house; report the ones that fail and continue."""
    command = command_of("house", *words)
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        done = do_jobs(jobs, flags.fan_out, label="houses", share=HOUSES_PER_WORKER)
        if done.part is not None:
            return say_part(done, command)
        rows |= done.values()
        rows |= {key: _failed(key, error) for key, error in done.failed.items()}
        forget(jobs)
    return _report([rows[origin] for origin in order], flags)


def _failed(origin: str, error: object) -> dict[str, Any]:
    empty: dict[str, Any] = dict.fromkeys(
        ("source", "rooms", "objects", "tiles", "reachable", "classes", "label_coverage")
    )
    unwritten = {"unmapped": [], "notes": [], "house": None, "mjcf": None}
    return {"id": Path(origin).stem, **empty, **unwritten, "errors": [str(error)]}


def _report(rows: Sequence[dict[str, Any]], flags: ImportFlags | GenerateFlags) -> int:
    failed = [row for row in rows if row["errors"]]
    if flags.json:
        print_json({"houses": list(rows)})
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
        build = ["lcrl-bench", "benchmark", "build", "--houses", str(flags.out)]
        suggest([*build, "--out", "BENCHMARK", "--name", "mine"], "make a benchmark of them")
    return ExitCode.RED if failed else ExitCode.DONE


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
