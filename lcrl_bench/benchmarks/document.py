"""A benchmark as a folder: `benchmark.json`, `tasks.json`, `houses/*.json`, `grids/*.json`.

pydantic models are the schema; what they can't express (that a task names an existing house, a
tile of its grid, an object of the house) is checked afterwards.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from lcrl_bench.benchmarks.benchmark import Benchmark, grid_to_json, vocabulary_of
from lcrl_bench.benchmarks.folder import (
    REBUILD,
    LazyMapping,
    grid_file,
    house_file,
    read_content,
)
from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task, Tasks
from lcrl_bench.documents import Document
from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.houses.document import (
    Name,
    ObjectDocument,
    house_digest,
    read_house,
    write_house,
)
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.semantics import Semantics
from lcrl_bench.storage import atomic_folder, canonical_json, read_json, sha256_of, write_json


class BenchmarkDocument(Document):
    """`benchmark.json`."""

    format: Literal["lcrl-benchmark"] = "lcrl-benchmark"
    version: Literal[1] = 1
    name: Name
    fingerprint: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    semantics: Semantics
    houses: Annotated[list[Name], Field(min_length=1, max_length=10_000)]


class GridDocument(Document):
    """`grids/<house>.json`."""

    tile: Annotated[float, Field(gt=0.05, le=5)]
    origin: tuple[float, float]
    cells: Annotated[list[tuple[int, int]], Field(min_length=1, max_length=100_000)]
    points: list[tuple[float, float]]
    neighbours: list[tuple[int, int, int, int]]
    rooms: list[Name]


class ProofDocument(Document):
    """A task's proof."""

    optimal_length: Annotated[int, Field(ge=0)]
    value: float
    random_success: Annotated[float, Field(ge=0, le=1)]


class TaskDocument(Document):
    """A row of `tasks.json`."""

    id: Annotated[str, Field(max_length=200)]
    kind: Kind
    split: Split
    house: Name
    command: Annotated[str, Field(min_length=1, max_length=200)]
    target: Annotated[str, Field(max_length=80)]
    start_tile: Annotated[int, Field(ge=0)]
    start_heading: Annotated[int, Field(ge=0, lt=HEADINGS)]
    proof: ProofDocument
    moved: Name | None = None
    placement: ObjectDocument | None = None

    def to_task(self) -> Task:
        """The task of this row."""
        placed = PlacedObject(**vars(self.placement)) if self.placement else None
        return Task(**{**vars(self), "proof": Proof(**vars(self.proof)), "placement": placed})


class TasksDocument(Document):
    """`tasks.json`."""

    tasks: Annotated[list[TaskDocument], Field(max_length=1_000_000)]


def write_benchmark(folder: Path, benchmark: Benchmark) -> None:
    """Write a benchmark as a folder; an existing folder is replaced atomically."""
    with atomic_folder(folder) as fresh:
        _write_files(fresh, benchmark)


def _write_files(folder: Path, benchmark: Benchmark) -> None:
    for name, house in benchmark.houses.items():
        write_house(house_file(folder, name), house)
        grid = grid_to_json(benchmark.grids[name])
        write_json(grid_file(folder, name), grid, indent=None)
    write_json(folder / "tasks.json", {"tasks": [task.to_json() for task in benchmark.tasks]})
    head = BenchmarkDocument(
        name=benchmark.name,
        fingerprint=benchmark.fingerprint,
        semantics=benchmark.semantics,
        houses=sorted(benchmark.houses),
    )
    write_json(folder / "benchmark.json", head.model_dump(mode="json"))


def read_benchmark(folder: Path, *, verify: bool = True) -> Benchmark:
    """Read a benchmark folder.

    If its content matches the recorded fingerprint, houses and grids are parsed on first use.

    Args:
        folder: Holds `benchmark.json`.
        verify: Whether to compare the content with the recorded fingerprint.

    Raises:
        InvalidFileError: If a file is missing or invalid.
        IntegrityError: If the content does not match the recorded fingerprint.
    """
    head: BenchmarkDocument = _parse(BenchmarkDocument, folder / "benchmark.json")
    if verify:
        with _uncollected():
            benchmark = _lazy_benchmark(folder, head)
        if benchmark is not None:
            return benchmark
    # Something is not as it was written: parsing everything tells what.
    houses = {name: read_house(house_file(folder, name)) for name in head.houses}
    grids = {name: _read_grid(grid_file(folder, name), _rooms(houses[name])) for name in houses}
    objects = {name: frozenset(thing.id for thing in houses[name].objects) for name in houses}
    tiles = {name: grid.tiles for name, grid in grids.items()}
    rows = _parse(TasksDocument, folder / "tasks.json")
    tasks = _checked_tasks(folder, rows, objects, tiles)
    benchmark = Benchmark(
        head.name, head.semantics, houses, grids, tasks, _views(folder, head.houses)
    )
    if verify and benchmark.fingerprint != head.fingerprint:
        where = folder / "benchmark.json"
        raise IntegrityError(where, head.fingerprint, benchmark.fingerprint, fix=REBUILD)
    return benchmark


@contextmanager
def _uncollected() -> Iterator[None]:
    """Pause the cyclic garbage collector: what is parsed has no cycles.

    It would look at all that was parsed before, again and again: with a thousand houses, for half
    as long as parsing takes.
    """
    paused = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if paused:
            gc.enable()


def _lazy_benchmark(folder: Path, head: BenchmarkDocument) -> Benchmark | None:
    """The benchmark, parsed on first use; None if its content does not match its fingerprint."""
    content = read_content(folder, head.houses)
    if content is None:
        return None
    facts = content.houses
    try:
        rows = TasksDocument.model_validate_json(content.tasks)
    except ValidationError:
        return None
    tasks = _checked_tasks(
        folder,
        rows,
        {name: each.objects for name, each in facts.items()},
        {name: each.tiles for name, each in facts.items()},
    )
    if content.fingerprint(head.semantics, vocabulary_of(tasks)) != head.fingerprint:
        return None
    houses = LazyMapping(
        {name: house_file(folder, name) for name in facts},
        {name: each.house for name, each in facts.items()},
        read_house,
        house_digest,
    )
    grids = LazyMapping(
        {name: grid_file(folder, name) for name in facts},
        {name: each.grid for name, each in facts.items()},
        partial(_read_lazy_grid, {name: each.rooms for name, each in facts.items()}),
        _grid_digest,
    )
    views = _views(folder, head.houses)
    benchmark = Benchmark(head.name, head.semantics, houses, grids, tasks, views)
    return benchmark.known_as(head.fingerprint)


def _views(folder: Path, houses: Sequence[str]) -> dict[str, Path]:
    return {name: path for name in houses if (path := view_file(folder, name)).is_file()}


def _rooms(house: House) -> frozenset[str]:
    return frozenset(room.id for room in house.rooms)


def view_file(folder: Path, house: str) -> Path:
    """Where a benchmark folder keeps the frozen views of a house, if it ships them."""
    return folder / "views" / f"{house}.npz"


def _parse(model: type[Any], path: Path) -> Any:  # noqa: ANN401 - an instance of `model`
    try:
        return model.model_validate(read_json(path))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InvalidFileError(path, first["msg"], where=where, fix=REBUILD) from error


def _read_grid(path: Path, rooms: frozenset[str]) -> Grid:
    row: GridDocument = _parse(GridDocument, path)
    tiles = len(row.cells)
    neighbours = np.array(row.neighbours, np.int64).reshape(-1, HEADINGS)
    if {len(row.points), len(neighbours), len(row.rooms)} != {tiles}:
        raise InvalidFileError(path, "its lists differ in length", fix=REBUILD)
    if neighbours.min() < -1 or neighbours.max() >= tiles or not rooms.issuperset(row.rooms):
        raise InvalidFileError(path, "it names a tile or a room that is not there", fix=REBUILD)
    return Grid(
        tile=row.tile,
        origin=row.origin,
        cells=np.array(row.cells, np.int64),
        points=np.array(row.points, np.float64),
        neighbours=neighbours,
        rooms=tuple(row.rooms),
    )


def _read_lazy_grid(rooms: Mapping[str, frozenset[str]], path: Path) -> Grid:
    return _read_grid(path, rooms[path.stem])


def _grid_digest(grid: Grid) -> str:
    return sha256_of(canonical_json(grid_to_json(grid)))


def _checked_tasks(
    folder: Path,
    rows: TasksDocument,
    objects: Mapping[str, frozenset[str]],
    tiles: Mapping[str, int],
) -> Tasks:
    """The tasks of all rows, each of which must refer to what is there.

    Args:
        folder: For messages.
        rows: The rows.
        objects: Ids of the objects of each house.
        tiles: Number of tiles of each house.
    """
    path = folder / "tasks.json"
    for row in rows.tasks:
        where = f"task '{row.id}'"
        if row.house not in objects:
            raise InvalidFileError(path, f"no house '{row.house}'", where=where, fix=REBUILD)
        if row.start_tile >= tiles[row.house]:
            raise InvalidFileError(path, f"no tile {row.start_tile}", where=where, fix=REBUILD)
        there = row.moved in objects[row.house] and row.placement is not None
        if row.kind == Kind.PICK and not there:
            reason = f"it moves '{row.moved}', which is not in its house, or nowhere"
            raise InvalidFileError(path, reason, where=where, fix=REBUILD)
    return Tasks(row.to_task() for row in rows.tasks)
