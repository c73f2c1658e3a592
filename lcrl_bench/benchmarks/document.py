"""A benchmark as a folder: `benchmark.json`, `tasks.json`, `houses/*.json`, `grids/*.json`.

pydantic models are the schema; what they can't express (that a task names an existing house, a
tile of its grid, an object of the house) is checked afterwards.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from lcrl_bench.benchmarks.benchmark import Benchmark, grid_to_json
from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task, Tasks
from lcrl_bench.documents import Document
from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.houses.document import Name, ObjectDocument, read_house, write_house
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.semantics import Semantics
from lcrl_bench.storage import atomic_folder, read_json, write_json

REBUILD = "Build the benchmark again, or fetch it again."


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
        placed = PlacedObject(**dict(self.placement)) if self.placement else None
        return Task(**{**dict(self), "proof": Proof(**dict(self.proof)), "placement": placed})


class TasksDocument(Document):
    """`tasks.json`."""

    tasks: Annotated[list[TaskDocument], Field(max_length=1_000_000)]


def write_benchmark(folder: Path, benchmark: Benchmark) -> None:
    """Write a benchmark as a folder; an existing folder is replaced atomically."""
    with atomic_folder(folder) as fresh:
        _write_files(fresh, benchmark)


def _write_files(folder: Path, benchmark: Benchmark) -> None:
    for name, house in benchmark.houses.items():
        write_house(folder / "houses" / f"{name}.json", house)
        grid = grid_to_json(benchmark.grids[name])
        write_json(folder / "grids" / f"{name}.json", grid, indent=None)
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

    Args:
        folder: Holds `benchmark.json`.
        verify: Whether to compare the content with the recorded fingerprint.

    Raises:
        InvalidFileError: If a file is missing or invalid.
        IntegrityError: If the content does not match the recorded fingerprint.
    """
    head = _parse(BenchmarkDocument, folder / "benchmark.json")
    houses = {name: read_house(folder / "houses" / f"{name}.json") for name in head.houses}
    grids = {name: _read_grid(folder / "grids" / f"{name}.json", houses[name]) for name in houses}
    rows = _parse(TasksDocument, folder / "tasks.json")
    tasks = tuple(row.to_task() for row in rows.tasks)
    for task in tasks:
        _check_task(folder / "tasks.json", task, houses, grids)
    views = {name: path for name in houses if (path := view_file(folder, name)).is_file()}
    benchmark = Benchmark(head.name, head.semantics, houses, grids, Tasks(tasks), views)
    if verify and benchmark.fingerprint != head.fingerprint:
        where = folder / "benchmark.json"
        raise IntegrityError(where, head.fingerprint, benchmark.fingerprint, fix=REBUILD)
    return benchmark


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


def _read_grid(path: Path, house: House) -> Grid:
    row: GridDocument = _parse(GridDocument, path)
    tiles = len(row.cells)
    rooms = {room.id for room in house.rooms}
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


def _check_task(path: Path, task: Task, houses: dict[str, House], grids: dict[str, Grid]) -> None:
    where = f"task '{task.id}'"
    if task.house not in houses:
        raise InvalidFileError(path, f"no house '{task.house}'", where=where, fix=REBUILD)
    if task.start_tile >= grids[task.house].tiles:
        raise InvalidFileError(path, f"no tile {task.start_tile}", where=where, fix=REBUILD)
    things = {thing.id for thing in houses[task.house].objects}
    if task.kind == Kind.PICK and (task.moved not in things or task.placement is None):
        reason = f"it moves '{task.moved}', which is not in its house, or nowhere"
        raise InvalidFileError(path, reason, where=where, fix=REBUILD)
