"""Measures how much cameras at different heights and pitches show of the tasks of some houses.

Tasks are drawn as for a benchmark, but none is dropped for lack of visibility: what is measured is
for how many of them vision is enough. Eye height moves the ball around the cameras, which collides,
and tile size decides where one can stand, so both may change the tasks; pitch does not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.projections import MIN_SUCCESS, Projection, success_by_sight
from lcrl_bench.benchmarks.sampling import draw_tasks
from lcrl_bench.benchmarks.task import Kind, Tasks
from lcrl_bench.benchmarks.task_set import TaskSet, stack_tasks
from lcrl_bench.benchmarks.visibility import MIN_PIXELS
from lcrl_bench.errors import NothingSelectedError
from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import House
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.semantics import Semantics


@dataclass(frozen=True)
class Optics:
    """Measurements of one variant of the semantics, over all houses.

    Means over no tasks are None.
    """

    semantics: Semantics
    houses: int
    tiles: float
    """Mean number of tiles per house."""
    tasks: Mapping[Kind, int]
    optimal_length: Mapping[Kind, float | None]
    """Mean length of the shortest solution, in actions."""
    solved: Mapping[Kind, Mapping[Projection, float | None]]
    """Share of tasks solved by the optimal policy of the projected reward."""
    pixels: Mapping[ObjectState, float | None]
    """Pixels of the moved object at A and at B: mean over the tiles within reach of it."""
    seen_from_some: Mapping[ObjectState, float | None]
    """Share of PICK tasks whose object is seen at A and at B from some tile within reach."""
    seen_from_all: Mapping[ObjectState, float | None]
    """Likewise, from all tiles within reach."""
    unique_views: float
    """Distinct views stored per panorama, out of its four."""


Key = TypeVar("Key")

PLACES = (ObjectState.AT_A, ObjectState.AT_B)


def measure_optics(
    houses: Sequence[House],
    variants: Sequence[Semantics],
    *,
    nav: int = 20,
    pick: int = 20,
    seed: int = 0,
    renderer: str = "rays",
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[Optics, ...]:
    """Measure each variant over all houses.

    Args:
        houses: At least one; each draws its own tasks, the same for variants with the same grid.
        variants: Semantics to compare, at least one.
        nav: NAV tasks drawn per house, at most.
        pick: PICK tasks drawn per house, at most.
        seed: Seed for drawing tasks.
        renderer: `"auto"`, `"gl"` or `"rays"`.
        progress: Called with each house when it is done.

    Returns:
        One per variant, in order.

    Raises:
        NothingSelectedError: If there is no house or no variant, or a variant finds no task.
    """
    if not houses or not variants:
        raise NothingSelectedError("Give at least one house and one variant of the semantics.")
    tallies = [_Tally() for _ in variants]
    streams = np.random.default_rng(seed).integers(2**63, size=len(houses))
    for house, stream in zip(houses, streams, strict=True):
        drawn: dict[Semantics, Benchmark] = {}
        for semantics, tally in zip(variants, tallies, strict=True):
            # Pitch is the one constant that affects neither the grid nor the tasks.
            level = replace(semantics, pitch=0.0)
            if level not in drawn:
                rng = np.random.default_rng(stream)
                drawn[level] = _draw(house, level, nav=nav, pick=pick, rng=rng)
            trial = replace(drawn[level], semantics=semantics)
            scene = trial.scene(house.id, renderer=renderer)
            arrangements = arrangements_of(trial.tasks)
            views = scene.panoramas(arrangements)
            tally.add(scene, views, stack_tasks(scene, trial.tasks, views, arrangements))
        progress(house.id)
    for semantics, tally in zip(variants, tallies, strict=True):
        if not any(tally.lengths.values()):
            raise NothingSelectedError(f"The {len(houses)} houses yield no task under {semantics}.")
    return tuple(t.optics(semantics) for semantics, t in zip(variants, tallies, strict=True))


def _draw(
    house: House, semantics: Semantics, *, nav: int, pick: int, rng: np.random.Generator
) -> Benchmark:
    scene = Scene(house, semantics)
    tasks = draw_tasks(scene, nav=nav, pick=pick, rng=rng)
    return Benchmark("optics", semantics, {house.id: house}, {house.id: scene.grid}, Tasks(tasks))


def _of_kinds() -> dict[Kind, list[float]]:
    return {kind: [] for kind in Kind}


def _of_places() -> dict[ObjectState, list[float]]:
    return {place: [] for place in PLACES}


@dataclass
class _Tally:
    """Values to be averaged, one per task or per house."""

    tiles: list[int] = field(default_factory=list)
    views: int = 0
    panoramas: int = 0
    lengths: dict[Kind, list[float]] = field(default_factory=_of_kinds)
    solved: dict[tuple[Kind, Projection], list[float]] = field(default_factory=dict)
    pixels: dict[ObjectState, list[float]] = field(default_factory=_of_places)
    some: dict[ObjectState, list[float]] = field(default_factory=_of_places)
    every: dict[ObjectState, list[float]] = field(default_factory=_of_places)

    def add(self, scene: Scene, views: Panoramas, sets: Sequence[TaskSet]) -> None:
        """Add the measurements of a house and of its tasks, if it has any."""
        self.tiles.append(scene.grid.tiles)
        self.views += len(views.views)
        self.panoramas += len(views)
        for tasks in sets:
            self.lengths[tasks.kind] += [task.proof.optimal_length for task in tasks.tasks]
            for projection in Projection:
                solved = (success_by_sight(tasks, projection) >= MIN_SUCCESS).tolist()
                self.solved.setdefault((tasks.kind, projection), []).extend(solved)
            if tasks.kind == Kind.PICK:
                for place, pixels in _pixels_in_reach(tasks):
                    self.pixels[place].append(float(pixels.mean()))
                    self.some[place].append(float((pixels >= MIN_PIXELS).any()))
                    self.every[place].append(float((pixels >= MIN_PIXELS).all()))

    def optics(self, semantics: Semantics) -> Optics:
        """The means of what was added."""
        return Optics(
            semantics=semantics,
            houses=len(self.tiles),
            tiles=float(np.mean(self.tiles)),
            tasks={kind: len(found) for kind, found in self.lengths.items()},
            optimal_length=_means(self.lengths),
            solved={
                kind: {how: _mean(self.solved.get((kind, how), ())) for how in Projection}
                for kind in Kind
            },
            pixels=_means(self.pixels),
            seen_from_some=_means(self.some),
            seen_from_all=_means(self.every),
            unique_views=self.views / self.panoramas,
        )


def _pixels_in_reach(tasks: TaskSet) -> Iterator[tuple[ObjectState, np.ndarray]]:
    """For each PICK task and place: the pixels of its object from each tile within reach of it.

    The object is the only one of its class in the house, so all pixels of the class are its own.
    """
    pixels = tasks.views.class_counts().numpy()
    scene = tasks.scene
    for task, row in zip(tasks.tasks, tasks.panoramas.numpy(), strict=True):
        moved, placement = task.carried()
        thing = scene.house.object(moved)
        for place, where in zip(PLACES, (thing, placement), strict=True):
            panoramas = row.reshape(-1, scene.grid.tiles)[place]
            yield place, pixels[panoramas[scene.reach(where)], class_id(thing.label)]


def _mean(values: Iterable[float]) -> float | None:
    found = list(values)
    return float(np.mean(found)) if found else None


def _means(values: Mapping[Key, Iterable[float]]) -> dict[Key, float | None]:
    return {key: _mean(found) for key, found in values.items()}
