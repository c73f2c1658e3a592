"""`Episode`: one rollout with everything that explains it, and its record on disk.

The record, `<name>.npz`, is authoritative: plain arrays and a JSON header, readable with NumPy
alone. A Rerun recording is a view of it, rebuilt whenever the viewer's format changes.
"""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from lcrl_bench.benchmarks.document import TaskDocument
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.documents import Document
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.houses.document import Name
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS, OBJECT_STATES, ObjectState
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.storage import write_bytes

MAX_RECORD_BYTES: Final = 64 * 1024 * 1024
"""Largest record and largest array read, in bytes; a 30-step episode takes about 0.1 MB."""

_OPTIONAL: Final = ("reward", "value", "occupancy", "expert_occupancy", "near_start", "near_end")
_REQUIRED: Final = (
    "panoramas",
    "goal",
    "states",
    "actions",
    "action_probabilities",
    "true_reward",
)


@dataclass(frozen=True, eq=False)
class Episode:
    """One rollout of the most likely policy of a learned reward (or of a learned policy).

    States and cells are laid out as in `mdp.task_batch`:
    `cell = object_state * tiles + tile`, `state = cell * 4 + heading`.
    """

    scene: Scene
    """The house it happened in."""
    views: Panoramas
    """Everything seen in the house."""
    task: Task
    panoramas: NDArray[np.int64]
    """[cell]: the panorama seen in each cell, a number in `views`."""
    goal: NDArray[np.bool_]
    """[cell]: where the goal predicate holds."""
    states: NDArray[np.int64]
    """[horizon + 1]."""
    actions: NDArray[np.int64]
    """[horizon]."""
    action_probabilities: NDArray[np.float64]
    """[horizon, action]: the policy in each visited state."""
    reward: NDArray[np.float64] | None
    """[cell]: the learned reward; None for a learned policy."""
    value: NDArray[np.float64] | None
    """[state]: V_0 of the learned reward, re-optimised; None for a learned policy."""
    true_reward: NDArray[np.float64]
    """[cell]."""
    occupancy: NDArray[np.float64] | None
    """[cell]: discounted visitation of the policy from the task's start."""
    expert_occupancy: NDArray[np.float64] | None
    """[cell]: the same of the expert."""
    success: bool
    """Whether the goal predicate holds at some step."""
    method: str
    seed: int
    benchmark: str
    """Name of the benchmark, or of another origin of the task."""
    fingerprint: str
    """Fingerprint of the benchmark; empty for a task from elsewhere."""
    near_start: NDArray[np.bool_] | None = None
    """PICK, [tile]: where the object can be taken at its place A."""
    near_end: NDArray[np.bool_] | None = None
    """PICK, [tile]: where it can be put at its place B."""

    @property
    def horizon(self) -> int:
        """H: number of actions."""
        return len(self.actions)

    @property
    def cells(self) -> NDArray[np.int64]:
        """[horizon + 1]: the cell at each step."""
        return self.states // HEADINGS

    @property
    def tiles(self) -> NDArray[np.int64]:
        """[horizon + 1]: the tile at each step."""
        return self.cells % self.scene.grid.tiles

    @property
    def headings(self) -> NDArray[np.int64]:
        """[horizon + 1]: 0..3 for north, east, south, west."""
        return self.states % HEADINGS

    @property
    def object_states(self) -> NDArray[np.int64]:
        """[horizon + 1]: where the object is at each step; all 0 for NAV."""
        return self.cells // self.scene.grid.tiles

    @property
    def done(self) -> NDArray[np.bool_]:
        """[horizon + 1]: whether the goal predicate holds at each step."""
        return self.goal[self.cells]

    @property
    def goal_known(self) -> bool:
        """Whether the goal predicate holds anywhere; False for a sentence of unknown goal."""
        return bool(self.goal.any())

    @property
    def failure(self) -> Failure | None:
        """How a PICK episode fails; None if the goal is reached or unknown, and for NAV.

        The definition is that of `evaluation.outcome.failure_shares`, for a single trajectory.
        """
        if self.success or self.task.kind == Kind.NAV or not self.goal_known:
            return None
        tile, last = int(self.tiles[-1]), int(self.object_states[-1])
        at_a = self.near_start is not None and bool(self.near_start[tile])
        at_b = self.near_end is not None and bool(self.near_end[tile])
        if not (self.object_states == ObjectState.HELD).any():
            if at_a:
                return Failure.WAITS_AT_A
            return Failure.AT_B_WITHOUT_OBJECT if at_b else Failure.ELSEWHERE
        if last == ObjectState.AT_A:
            return Failure.PUT_BACK
        return Failure.HELD_AT_B if at_b else Failure.HELD_ELSEWHERE

    @property
    def parts(self) -> tuple[ObjectState, ...]:
        """The object states of the task's kind: one for NAV, three for PICK."""
        return tuple(ObjectState)[: OBJECT_STATES if self.task.kind == Kind.PICK else 1]

    @property
    def thing(self) -> PlacedObject | None:
        """The object that PICK moves, where it is found; None for NAV."""
        moved = self.task.moved
        return None if moved is None else self.scene.house.object(moved)

    @property
    def thing_name(self) -> str:
        """The object that PICK moves, in words; empty for NAV."""
        return "" if self.thing is None else self.thing.label.replace("_", " ")

    @property
    def take_tiles(self) -> NDArray[np.bool_]:
        """[tile]: where the object of PICK can be taken at A; nowhere for NAV."""
        nowhere = np.zeros(self.scene.grid.tiles, bool)
        return nowhere if self.near_start is None else self.near_start

    @property
    def goal_tiles(self) -> NDArray[np.bool_]:
        """[tile]: the goal of NAV; for PICK, where the object can be put at B."""
        if self.task.kind == Kind.NAV:
            return self.goal
        nowhere = np.zeros(self.scene.grid.tiles, bool)
        return nowhere if self.near_end is None else self.near_end

    @cached_property
    def seen(self) -> NDArray[np.uint8]:
        """[horizon + 1, 4, row, column] class ids: the views N, E, S, W at each step."""
        return np.stack([self.views.pixels(int(seen)) for seen in self.panoramas[self.cells]])


class _Header(Document):
    format: Literal["lcrl-episode"] = "lcrl-episode"
    version: Literal[1] = 1
    task: TaskDocument
    success: bool
    method: Annotated[str, Field(max_length=200)]
    seed: int
    benchmark: Annotated[str, Field(max_length=200)]
    fingerprint: Annotated[str, Field(pattern="^([0-9a-f]{64})?$")]
    house: Name
    state_layout: str = "state = (object_state * tiles + tile) * 4 + heading"


def write_episode(folder: Path, name: str, episode: Episode) -> Path:
    """Write the record of an episode as `<folder>/<name>.npz`, atomically.

    Returns:
        The file.
    """
    path = folder / f"{name}.npz"
    write_bytes(path, episode_record(episode))
    return path


def episode_record(episode: Episode) -> bytes:
    """The record of an episode: the content of an `.npz` file.

    Besides the fields of `Episode` it holds what was seen (`seen`, uint8 [horizon + 1, 4, row,
    column] class ids), where the agent stood (`positions`, [horizon + 1, 2] metres), the grid's
    standing points (`points`, [tile, 2] metres) and a JSON string (`header`).
    """
    header = _Header(
        task=TaskDocument.model_validate(episode.task.to_json()),
        success=episode.success,
        method=episode.method,
        seed=episode.seed,
        benchmark=episode.benchmark,
        fingerprint=episode.fingerprint,
        house=episode.scene.house.id,
    )
    arrays = {key: np.asarray(getattr(episode, key)) for key in _REQUIRED}
    optional = {key: getattr(episode, key) for key in _OPTIONAL}
    arrays |= {key: np.asarray(value) for key, value in optional.items() if value is not None}
    points = episode.scene.grid.points
    file = io.BytesIO()
    np.savez_compressed(
        file,
        allow_pickle=False,
        header=np.array(header.model_dump_json()),
        seen=episode.seen,
        positions=points[episode.tiles],
        points=points,
        **arrays,
    )
    return file.getvalue()


def read_episode(path: Path, tasks: TaskSet) -> Episode:
    """Read a record back, to look at it again.

    Args:
        path: What `write_episode` wrote.
        tasks: Some task set of the house it happened in.

    Raises:
        InvalidFileError: If the file is no such record, or belongs to another house or grid.
    """
    header, arrays = _load(path)
    house = tasks.scene.house.id
    if header.house != house:
        reason = f"it happened in house '{header.house}', not in '{house}'"
        raise InvalidFileError(path, reason, fix="Give task sets of the house it names.")
    fields: dict[str, Any] = {key: arrays.get(key) for key in (*_REQUIRED, *_OPTIONAL)}
    episode = Episode(
        scene=tasks.scene,
        views=tasks.views,
        task=header.task.to_task(),
        success=header.success,
        method=header.method,
        seed=header.seed,
        benchmark=header.benchmark,
        fingerprint=header.fingerprint,
        **fields,
    )
    _check(path, episode)
    return episode


def _load(path: Path) -> tuple[_Header, dict[str, NDArray[Any]]]:
    fix = "Record the episode again."
    try:
        if path.stat().st_size > MAX_RECORD_BYTES:
            raise InvalidFileError(path, f"larger than {MAX_RECORD_BYTES >> 20} MB", fix=fix)
        with zipfile.ZipFile(path) as archive:
            if max(entry.file_size for entry in archive.infolist()) > MAX_RECORD_BYTES:
                raise InvalidFileError(path, "holds an array that is too large", fix=fix)
        with np.load(path, allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
        header = _Header.model_validate(json.loads(str(arrays["header"])))
    except FileNotFoundError as error:
        raise InvalidFileError(path, "no such file", fix="Check the path.") from error
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, ValidationError) as error:
        raise InvalidFileError(path, f"not an episode's record: {error}", fix=fix) from error
    if missing := [key for key in _REQUIRED if key not in arrays]:
        raise InvalidFileError(path, f"it lacks {', '.join(missing)}", fix=fix)
    return header, arrays


def _check(path: Path, episode: Episode) -> None:
    """Refuse arrays that do not fit each other or the grid."""
    cells = len(episode.parts) * episode.scene.grid.tiles
    steps = episode.actions.size
    expected: dict[str, tuple[int, ...]] = {
        "panoramas": (cells,),
        "goal": (cells,),
        "states": (steps + 1,),
        "actions": (steps,),
        "action_probabilities": (steps, ACTIONS),
        "reward": (cells,),
        "value": (cells * HEADINGS,),
        "true_reward": (cells,),
        "occupancy": (cells,),
        "expert_occupancy": (cells,),
        "near_start": (episode.scene.grid.tiles,),
        "near_end": (episode.scene.grid.tiles,),
    }
    for key, shape in expected.items():
        found = getattr(episode, key)
        if found is not None and found.shape != shape:
            reason = f"'{key}' has shape {found.shape}, expected {shape}"
            raise InvalidFileError(path, reason, fix="Is the benchmark the one it was made with?")
    limits = {
        "states": cells * HEADINGS,
        "actions": ACTIONS,
        "panoramas": len(episode.views),
    }
    for key, limit in limits.items():
        values = getattr(episode, key)
        if values.size and not 0 <= values.min() <= values.max() < limit:
            raise InvalidFileError(path, f"'{key}' leaves 0..{limit - 1}", where=key)
