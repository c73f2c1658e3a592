"""Episodes as a Rerun recording that opens ready to look at: the only module that knows Rerun.

One recording holds one or several episodes. On the timeline `step` they follow each other, the next
beginning at a round number; each has a timeline of its own beside it (`episode_1`, ...), on which it
runs from 0 and nothing else is shown. A recording is a view: the record is the episode's `.npz`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.recording.bird import heading_yaw, object_pose
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import (
    TileMap,
    goal_tiles,
    layer_titles,
    outline,
    take_tiles,
    tile_centers,
    tile_maps,
)
from lcrl_bench.recording.meshes import ColorMesh, agent_mesh, house_meshes, object_mesh
from lcrl_bench.recording.narration import (
    HEADING_NAMES,
    about,
    action_phrase,
    episode_name,
    now,
    object_phrase,
    room_name,
    thing_name,
    turning_points,
)
from lcrl_bench.recording.palette import (
    AGENT,
    BLACK,
    GOAL,
    PATH,
    TAKE,
    WHITE,
    Color,
    diverging,
    unit_interval,
)
from lcrl_bench.recording.plan import MARGIN, extent
from lcrl_bench.recording.reward_plan import HEADING_STEP, map_png
from lcrl_bench.storage import atomic_path

APPLICATION: Final = "lcrl_bench"
STEP: Final = "step"
"""The timeline on which all episodes follow each other."""
PIXELS_A_METRE: Final = 80
"""Of the maps; their overlays are in the same pixels."""
_FLOOR: Final = 0.03
"""Metres above the floor of what is painted on it: over rugs."""
_PAPER: Final[Color] = (238, 238, 234)


def record_episodes(path: Path, episodes: Sequence[Episode]) -> None:
    """Write episodes as one recording, `path`, atomically.

    Args:
        path: Ends in `.rrd`.
        episodes: At least one, in the order they are shown in.

    Raises:
        ValueError: If there is no episode.
    """
    if not episodes:
        raise ValueError("a recording needs at least one episode")
    rr.set_strict_mode(True)
    first = episodes[0]
    name = f"{first.method}-{first.benchmark}-{first.fingerprint[:12]}-seed{first.seed}"
    with atomic_path(path) as temporary:
        recording_id = f"{name}-{'+'.join(episode.task.id for episode in episodes)}"
        with rr.RecordingStream(APPLICATION, recording_id=recording_id) as rec:
            rec.set_log_time_enabled(False)
            rec.set_log_tick_enabled(False)
            rec.save(temporary, default_blueprint=layout(episodes))
            rec.send_recording_name(f"{first.method} on {first.benchmark}, seed {first.seed}")
            _log_frame(rec)
            for clock, episode in zip(clocks(rec, episodes), episodes, strict=True):
                _log_episode(clock, episode)


@dataclass(frozen=True)
class Clock:
    """Where an episode lies on the timelines of a recording."""

    rec: rr.RecordingStream
    start: int
    """Its step 0 on `STEP`."""
    own: str | None
    """The timeline of its own; None where it is the only one."""

    def at(self, step: int) -> None:
        """What is logged next happens at a step."""
        self.rec.set_time(STEP, sequence=self.start + step)
        if self.own is not None:
            self.rec.set_time(self.own, sequence=step)

    def columns(self, steps: int) -> list[rr.TimeColumn]:
        """The times of the steps 0 .. steps - 1."""
        times = [rr.TimeColumn(STEP, sequence=self.start + np.arange(steps))]
        if self.own is not None:
            times.append(rr.TimeColumn(self.own, sequence=np.arange(steps)))
        return times


def clocks(rec: rr.RecordingStream, episodes: Sequence[Episode]) -> list[Clock]:
    """One clock an episode; each begins at a multiple of ten, with a gap before it."""
    starts = [0]
    for episode in episodes:
        starts.append(10 * -(-(starts[-1] + episode.horizon + 2) // 10))
    alone = len(episodes) == 1
    return [
        Clock(rec, start, None if alone else f"episode_{number}")
        for number, start in enumerate(starts[:-1], 1)
    ]


def layout(episodes: Sequence[Episode]) -> rrb.Blueprint:
    """The views a recording opens with."""
    maps = [tile_map for tile_map in tile_maps(episodes[0])]
    shared = ["/map/plan/**", "/map/over/**"]
    seen = rrb.Horizontal(
        *(rrb.Spatial2DView(origin=f"views/{name}", name=name) for name in HEADING_NAMES),
    )
    left = rrb.Vertical(
        rrb.Spatial3DView(
            origin="world",
            name="house",
            background=_PAPER,
            line_grid=rrb.LineGrid3D(visible=False),
            eye_controls=_eye(episodes),
            overrides={
                f"world/tiles/{tile_map.key}": rrb.EntityBehavior(visible=False)
                for tile_map in maps[1:]
            },
        ),
        seen,
        row_shares=[3.4, 1],
    )
    plans = rrb.Horizontal(
        *(
            rrb.Spatial2DView(
                origin="map",
                contents=[f"/map/{tile_map.key}", *shared],
                name=tile_map.name,
                background=WHITE,
            )
            for tile_map in maps
        )
    )
    curves = rrb.Horizontal(
        *(_curve(f"along/{tile_map.key}", tile_map.name) for tile_map in maps),
        rrb.BarChartView(
            origin="policy", name="policy: 0 forward, 1 left, 2 right, 3 interact"
        ),
    )
    words = rrb.Horizontal(
        rrb.TextDocumentView(origin="now", name="now"),
        rrb.TextDocumentView(origin="about", name="about"),
        column_shares=[1, 1],
    )
    right = rrb.Vertical(
        words,
        plans,
        rrb.StateTimelineView(origin="happens", name="what happens"),
        curves,
        row_shares=[1.2, 2.6, 0.9, 1.2],
    )
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[1.1, 1]),
        rrb.TimePanel(state="collapsed", timeline=STEP, fps=3.0, play_state="playing"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
    )


def _curve(origin: str, name: str) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(origin=origin, name=f"{name} along the way")


def _eye(episodes: Sequence[Episode]) -> rrb.EyeControls3D:
    """An eye south of the houses and above, that has them all in view."""
    corners = np.array([extent(episode.compiled.house) for episode in episodes])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    middle, size = (low + high) / 2, high - low
    away = 0.62 * max(float(size[0]), float(size[1])) + 3.0
    eye = middle + np.array([0.25, -0.85]) * away
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(*eye, 1.25 * away),
        look_target=(middle[0], middle[1] - 0.06 * size[1], 0.0),
        eye_up=(0, 0, 1),
    )


def _log_frame(rec: rr.RecordingStream) -> None:
    """What holds for every episode: axes, names and colours of classes, styles of curves."""
    rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    classes = [(entry.id, entry.words, entry.color) for entry in semantic_classes()]
    rec.log("views", rr.AnnotationContext(classes), static=True)
    for key, color in (("reward", (33, 102, 172)), ("value", (33, 102, 172))):
        rec.log(
            f"along/{key}/learned",
            rr.SeriesLines(colors=color, names=f"learned {key}", widths=2),
            static=True,
        )
    rec.log(
        "along/reward/true",
        rr.SeriesLines(colors=(150, 150, 150), names="true reward", widths=1.5),
        static=True,
    )


def _log_episode(clock: Clock, episode: Episode) -> None:
    rec = clock.rec
    if clock.start:
        # Another house: nothing of the one before may stay, on the timeline they share.
        rec.reset_time()
        rec.set_time(STEP, sequence=clock.start - 1)
        for root in ("world", "map", "views", "along", "policy", "happens", "now", "about"):
            rec.log(root, rr.Clear(recursive=True))
        rec.reset_time()
    clock.at(0)
    rec.log("about", rr.TextDocument(about(episode), media_type=rr.MediaType.MARKDOWN))
    _log_house(rec, episode)
    _log_marks(rec, episode)
    for step in range(episode.horizon + 1):
        clock.at(step)
        _log_step(rec, episode, step)
    for step, words in turning_points(episode):
        clock.at(step)
        rec.log("events", rr.TextLog(words))
    _log_numbers(clock, episode)
    rec.reset_time()


def _log_house(rec: rr.RecordingStream, episode: Episode) -> None:
    for mesh in house_meshes(episode.compiled.house, without=episode.task.moved):
        rec.log(["world", "house", mesh.room or "building", mesh.label], _mesh(mesh))
    rec.log("world/agent/body", _mesh(agent_mesh()))
    if episode.task.moved is not None:
        moved = episode.compiled.house.object(episode.task.moved)
        rec.log("world/object/shape", _mesh(object_mesh(moved)))


def _mesh(mesh: ColorMesh) -> rr.Mesh3D:
    return rr.Mesh3D(
        vertex_positions=mesh.vertices,
        triangle_indices=mesh.faces,
        vertex_colors=mesh.colors,
    )


def _log_marks(rec: rr.RecordingStream, episode: Episode) -> None:
    """What stays on the floor and on the maps: borders of tiles in reach, start, places A and B."""
    grid, task = episode.compiled.grid, episode.task
    for name, tiles, color, inset in (
        ("take", take_tiles(episode), TAKE, 0.07),
        ("goal", goal_tiles(episode), GOAL, 0.03),
    ):
        if tiles.any():
            flat = outline(grid, tiles, inset)
            lifted = np.concatenate([flat, np.full((*flat.shape[:2], 1), _FLOOR + 0.02)], axis=2)
            rec.log(
                f"world/marks/{name}", rr.LineStrips3D(lifted, colors=color, radii=0.025)
            )
    if task.kind == Kind.PICK and task.moved is not None and task.placement is not None:
        found = episode.compiled.house.object(task.moved)
        rec.log(
            "world/marks/places",
            rr.Points3D(
                [(*thing.position[:2], thing.top + 0.25) for thing in (found, task.placement)],
                colors=[TAKE, GOAL],
                radii=0.06,
                labels=[f"A: {thing_name(episode)}", "B"],
                show_labels=True,
            ),
        )
    labels = _tile_labels(episode)
    rec.log(
        "map/over/tiles",
        rr.Points2D(
            _pixels(episode, tile_centers(grid)),
            radii=PIXELS_A_METRE * 0.04,
            colors=(90, 90, 90, 110),
            labels=labels,
            show_labels=False,
        ),
    )


def _tile_labels(episode: Episode) -> list[str]:
    """What hovering over a tile tells."""
    maps, titles = tile_maps(episode), layer_titles(episode)
    labels = []
    for tile in range(episode.compiled.grid.tiles):
        lines = [f"tile {tile}"]
        for tile_map in maps:
            for layer, title in enumerate(titles):
                place = f" {title}" if title else ""
                lines.append(f"{tile_map.name}{place}: {tile_map.layers[layer, tile]:.3f}")
        labels.append("\n".join(lines))
    return labels


def _log_step(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    grid, heading = episode.compiled.grid, int(episode.headings[step])
    place = grid.points[episode.tiles[step]]
    rec.log("world/agent", _pose(np.array([*place, 0.0]), heading_yaw(episode, step)))
    if episode.task.moved is not None:
        rec.log("world/object", _pose(*object_pose(episode, step)))
    layer = int(episode.object_states[step])
    if step == 0 or layer != episode.object_states[step - 1]:
        _log_maps(rec, episode, layer)
    way = grid.points[episode.tiles[: step + 1]]
    lifted = np.column_stack([way, np.full(len(way), _FLOOR + 0.03)])
    rec.log("world/path", rr.LineStrips3D([lifted], colors=PATH, radii=0.03))
    over = _pixels(episode, way)
    casing = rr.LineStrips2D(
        [over, over],
        colors=[WHITE, PATH],
        radii=[PIXELS_A_METRE * 0.07, PIXELS_A_METRE * 0.035],
        draw_order=20,
    )
    rec.log("map/over/path", casing)
    arrow = np.array(HEADING_STEP[heading]) * (1, -1) * PIXELS_A_METRE * 0.42
    rec.log(
        "map/over/agent",
        rr.Points2D(
            over[-1:], colors=[AGENT], radii=PIXELS_A_METRE * 0.2, draw_order=30
        ),
    )
    rec.log(
        "map/over/heading",
        rr.Arrows2D(
            origins=over[-1:],
            vectors=[arrow],
            colors=[BLACK],
            radii=PIXELS_A_METRE * 0.05,
            draw_order=31,
        ),
    )
    panorama = episode.panorama(int(episode.cells[step]))
    for name, view in zip(HEADING_NAMES, panorama, strict=True):
        rec.log(f"views/{name}", rr.SegmentationImage(view))
    rec.log("now", rr.TextDocument(now(episode, step), media_type=rr.MediaType.MARKDOWN))
    if step < episode.horizon:
        rec.log("policy/actions", rr.BarChart(episode.action_probabilities[step]))
    _log_happenings(rec, episode, step)


def _log_happenings(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    """Lanes of a timeline, each logged where it changes."""
    lanes = {
        "room": [room_name(episode, at) for at in (step - 1, step)],
        "action": [action_phrase(episode, at) for at in (step - 1, step)],
        "goal": ["reached" if episode.done[at] else "not yet" for at in (step - 1, step)],
    }
    if episode.task.kind == Kind.PICK:
        name = thing_name(episode)
        lanes[name] = [object_phrase(episode, at) for at in (step - 1, step)]
    for lane, (before, after) in lanes.items():
        if step == 0 or before != after:
            rec.log(["happens", lane], rr.StateChange(state=after))


def _pose(position: NDArray[np.float64], yaw: float) -> rr.Transform3D:
    turn = rr.RotationAxisAngle(axis=(0, 0, 1), radians=yaw)
    return rr.Transform3D(translation=position, rotation=turn)


def _log_maps(rec: rr.RecordingStream, episode: Episode, layer: int) -> None:
    """The maps for one place of the object, painted on the floor and over the plan."""
    for tile_map in tile_maps(episode):
        rec.log(["world", "tiles", tile_map.key], _tile_mesh(episode, tile_map, layer))
        png = map_png(episode, tile_map, layer, PIXELS_A_METRE)
        rec.log(["map", tile_map.key], rr.EncodedImage(contents=png, media_type="image/png"))


def _tile_mesh(episode: Episode, tile_map: TileMap, layer: int) -> rr.Mesh3D:
    grid = episode.compiled.grid
    half = grid.tile / 2 - 0.02
    square = np.array([(-half, -half), (half, -half), (half, half), (-half, half)])
    flat = (tile_centers(grid)[:, None] + square).reshape(-1, 2)
    colors = diverging(unit_interval(tile_map.layers[layer], tile_map.limits))
    first = 4 * np.arange(grid.tiles)[:, None, None]
    return rr.Mesh3D(
        vertex_positions=np.column_stack([flat, np.full(len(flat), _FLOOR)]),
        triangle_indices=(first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3),
        vertex_colors=np.repeat(colors, 4, axis=0),
    )


def _log_numbers(clock: Clock, episode: Episode) -> None:
    """Curves along the way, every step exact."""
    times = clock.columns(episode.horizon + 1)
    curves = {"along/reward/true": episode.true_reward[episode.cells]}
    if episode.reward is not None and episode.value is not None:
        curves["along/reward/learned"] = episode.reward[episode.cells]
        curves["along/value/learned"] = episode.value[episode.states]
    else:
        for key, visits in (
            ("visits", episode.occupancy),
            ("expert_visits", episode.expert_occupancy),
        ):
            if visits is not None:
                curves[f"along/{key}/here"] = visits[episode.cells]
    for path, numbers in curves.items():
        clock.rec.send_columns(path, indexes=times, columns=rr.Scalars.columns(scalars=numbers))


def _pixels(episode: Episode, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Metres to pixels of the maps."""
    (x0, _), (_, y1) = extent(episode.compiled.house)
    return (points - (x0 - MARGIN, y1 + MARGIN)) * (PIXELS_A_METRE, -PIXELS_A_METRE)
