"""`Storyboard`: everything that is shown of an episode, in words, colours and shapes.

It is made once per episode; pictures and recordings only draw it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.floor import Floor, episode_floor
from lcrl_bench.recording.maps import TileMap, every_map, tile_maps, whole_visits
from lcrl_bench.recording.meshes import ColorMesh, agent_mesh, house_meshes, object_mesh
from lcrl_bench.recording.narration import (
    Mark,
    about,
    action_phrase,
    episode_title,
    lanes,
    marks,
    now,
    run_title,
)

CARRIED: Final = 1.45
"""Height in metres of the underside of a carried object: above the agent's head."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where something stands, and which way it faces."""

    position: NDArray[np.float64]
    """[3] metres."""
    yaw: float
    """Rotation about z: radians, counter-clockwise from north."""


@dataclass(frozen=True, eq=False)
class Step:
    """One step of an episode."""

    agent: Pose
    """Where the agent stands, on the floor."""
    thing: Pose | None
    """The centre of the object that PICK moves: at A, above the agent, or at B; None for NAV."""
    action: str
    """What the agent does: `"take the cup"`; `"end"` at the last step."""
    now: str
    """What happens, in Markdown."""
    lanes: dict[str, str]
    """Room, action, goal and object in a word or two each."""


@dataclass(frozen=True, eq=False)
class Storyboard:
    """An episode, and everything that is shown of it."""

    episode: Episode
    """The numbers: states, actions, and what was seen."""
    title: str
    """Title of a picture: command, method and outcome."""
    run: str
    """Title of a recording: method, benchmark and seed."""
    about: str
    """A card in Markdown: the command, facts about the task, and its origin."""
    marks: tuple[Mark, ...]
    """The legend of what is drawn on maps."""
    steps: tuple[Step, ...]
    """[horizon + 1]."""
    points: NDArray[np.float64]
    """[horizon + 1, 2] metres: the agent's path."""
    maps: tuple[TileMap, ...]
    """What explains the episode: a reward and its value, or the visits of a policy."""
    visits: tuple[TileMap, ...]
    """Of a learned reward: where policy and expert go, over all places of the object."""
    painted: tuple[TileMap, ...]
    """Every map in layers per place of the object: `maps`, and visits if not among them."""
    floor: Floor
    scenery: tuple[ColorMesh, ...]
    """The house without its ceiling and the moved object."""
    agent: ColorMesh
    """In its own frame: feet at the origin, facing +y."""
    thing: ColorMesh | None
    """The object that PICK moves, in its own frame; None for NAV."""


def storyboard_of(episode: Episode) -> Storyboard:
    """Everything that is shown of an episode."""
    points = episode.scene.grid.points[episode.tiles]
    agent = [
        Pose(np.array([*point, 0.0]), -float(heading) * np.pi / 2)
        for point, heading in zip(points, episode.headings, strict=True)
    ]
    steps = tuple(
        Step(
            agent=pose,
            thing=_thing_pose(episode, int(episode.object_states[step]), pose),
            action=action_phrase(episode, step),
            now=now(episode, step),
            lanes=lanes(episode, step),
        )
        for step, pose in enumerate(agent)
    )
    return Storyboard(
        episode=episode,
        title=episode_title(episode),
        run=run_title(episode),
        about=about(episode),
        marks=marks(episode),
        steps=steps,
        points=points,
        maps=tile_maps(episode),
        visits=() if episode.reward is None else whole_visits(episode),
        painted=every_map(episode),
        floor=episode_floor(episode),
        scenery=house_meshes(episode.scene, without=episode.task.moved, keep=episode.task.target),
        agent=agent_mesh(),
        thing=None if episode.thing is None else object_mesh(episode.thing),
    )


def _thing_pose(episode: Episode, state: int, agent: Pose) -> Pose | None:
    """Where the object that PICK moves is while in a state."""
    found, placed = episode.thing, episode.task.placement
    if found is None or placed is None:
        return None
    if state == ObjectState.HELD:
        x, y, _ = agent.position
        return Pose(np.array([x, y, CARRIED + found.size[2] / 2]), agent.yaw)
    at = found if state == ObjectState.AT_A else placed
    return Pose(np.array(at.position), at.yaw)
