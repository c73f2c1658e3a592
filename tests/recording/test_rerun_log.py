"""Recordings, read back: everything is there for every step, and equals the episode."""

from __future__ import annotations

import io
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from rerun.chunk import Chunk, RrdReader

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import Action
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import layer_titles, tile_maps
from lcrl_bench.recording.narration import ACTION_NAMES, HEADING_NAMES, plain
from lcrl_bench.recording.palette import ACTION_COLORS
from lcrl_bench.recording.rerun.log import ROOTS, record_episodes
from lcrl_bench.recording.rerun.panels import ROW, WIDE
from lcrl_bench.recording.rerun.sheets import MAPS, SHEET_INCHES, VISITS, draw_sheet
from lcrl_bench.recording.storyboard import storyboard_of

SAMPLES = ("nav_episode", "pick_episode", "policy_episode")
MAX_BYTES = 1_500_000


class Recorded:
    """A recording as rows: what was logged to a path, step by step."""

    def __init__(self, path: Path, timeline: str = "step") -> None:
        self.reader = RrdReader(path)
        self.chunks: list[Chunk] = list(self.reader.stream().to_chunks())
        self.timeline = timeline

    def paths(self) -> set[str]:
        return {chunk.entity_path for chunk in self.chunks}

    def rows(self, path: str, component: str) -> dict[int, Any]:
        """Step -> value of a component, as lists."""
        rows: dict[int, Any] = {}
        for chunk in self.chunks:
            batch = chunk.to_record_batch()
            names = batch.schema.names
            if chunk.entity_path != path or chunk.is_static or component not in names:
                continue
            if self.timeline not in names:
                continue
            steps = batch.column(self.timeline).to_pylist()
            values = batch.column(component).to_pylist()
            rows |= {s: v for s, v in zip(steps, values, strict=True) if v is not None}
        return dict(sorted(rows.items()))


@pytest.fixture(scope="session")
def recordings(
    nav_episode: Episode,
    pick_episode: Episode,
    policy_episode: Episode,
    tmp_path_factory: pytest.TempPathFactory,
) -> dict[str, Path]:
    """A recording of each sample, and one of all that have a reward."""
    folder = tmp_path_factory.mktemp("recordings")
    samples = dict(zip(SAMPLES, (nav_episode, pick_episode, policy_episode), strict=True))
    paths = {name: folder / f"{name}.rrd" for name in (*samples, "both")}
    for name, episode in samples.items():
        record_episodes(paths[name], [storyboard_of(episode)])
    record_episodes(paths["both"], [storyboard_of(nav_episode), storyboard_of(pick_episode)])
    return paths


@pytest.fixture(params=SAMPLES)
def sample(request: pytest.FixtureRequest, recordings: dict[str, Path]) -> tuple[Episode, Recorded]:
    return request.getfixturevalue(request.param), Recorded(recordings[request.param])


@pytest.fixture
def episode(sample: tuple[Episode, Recorded]) -> Episode:
    return sample[0]


@pytest.fixture
def recorded(sample: tuple[Episode, Recorded]) -> Recorded:
    return sample[1]


def test_the_house_stands_in_it_without_a_ceiling(episode: Episode, recorded: Recorded):
    paths = recorded.paths()
    for expected in ("building/wall", "bedroom/bed", "kitchen/dining_table", "kitchen/floor"):
        assert f"/world/house/{expected}" in paths
    assert not [path for path in paths if path.endswith("/ceiling")]
    stays = "/world/house/kitchen/cup" in paths
    assert stays is (episode.task.moved is None)


def test_the_agent_is_where_the_episode_says_at_every_step(episode: Episode, recorded: Recorded):
    rows = recorded.rows("/world/agent", "Transform3D:translation")
    assert list(rows) == list(range(episode.horizon + 1))
    places = np.array([value[0] for value in rows.values()])
    np.testing.assert_allclose(places[:, :2], episode.scene.grid.points[episode.tiles])


def test_the_four_views_are_those_of_the_place_at_every_step(episode: Episode, recorded: Recorded):
    for number, name in enumerate(HEADING_NAMES):
        rows = recorded.rows(f"/views/{name}", "SegmentationImage:buffer")
        for step, seen in enumerate(episode.seen):
            view = np.array(latest(rows, step)[0], np.uint8).reshape(24, 32)
            np.testing.assert_array_equal(view, seen[number])


def test_what_is_in_sight_is_named_in_its_view(episode: Episode, recorded: Recorded):
    named = 0
    for number, name in enumerate(HEADING_NAMES):
        rows = recorded.rows(f"/views/{name}/names", "Points2D:labels")
        for step, panorama in enumerate(episode.seen):
            seen = {semantic_classes()[c].words for c in np.unique(panorama[number])}
            assert set(latest(rows, step)) <= seen
            named += len(latest(rows, step))
    assert named > episode.horizon


def latest(rows: dict[int, Any], step: int) -> Any:
    """What the viewer shows at a step: what was logged last."""
    return rows[max(at for at in rows if at <= step)]


def test_every_class_has_its_name_and_colour(recorded: Recorded):
    (chunk,) = [
        chunk for chunk in recorded.chunks if chunk.entity_path == "/views" and chunk.is_static
    ]
    (context,) = chunk.to_record_batch().column("AnnotationContext:context").to_pylist()
    named = {entry["class_id"]: entry["class_description"]["info"] for entry in context[0]}
    for entry in semantic_classes():
        red, green, blue = entry.color
        assert named[entry.id]["label"] == entry.words
        assert named[entry.id]["color"] == (red << 24 | green << 16 | blue << 8 | 255)


def test_reward_and_value_are_exact_at_every_step(episode: Episode, recorded: Recorded):
    expected = {"/along/reward/true": episode.true_reward[episode.cells]}
    if episode.reward is not None and episode.value is not None:
        expected["/along/reward/learned"] = episode.reward[episode.cells]
        expected["/along/value/learned"] = episode.value[episode.states]
    else:
        assert episode.occupancy is not None
        expected["/along/visits/here"] = episode.occupancy[episode.cells]
    for path, numbers in expected.items():
        rows = recorded.rows(path, "Scalars:scalars")
        assert list(rows) == list(range(episode.horizon + 1))
        np.testing.assert_array_equal([value[0] for value in rows.values()], numbers)


def test_the_policy_has_a_named_bar_an_action_at_every_step(episode: Episode, recorded: Recorded):
    names = recorded.rows("/policy/names", "Points2D:labels")
    assert list(names) == list(range(episode.horizon))
    bars = recorded.rows("/policy/bars", "Image:buffer")
    for step, chances in enumerate(episode.action_probabilities):
        expected = [f"{ACTION_NAMES[Action(a)]} {chances[a]:.2f}" for a in range(4)]
        assert names[step] == expected
        picture = np.array(bars[step][0], np.uint8).reshape(4, ROW, WIDE, 3)
        lengths = (picture[:, 0] == np.array(ACTION_COLORS)[:, None]).all(axis=2).sum(axis=1)
        np.testing.assert_allclose(lengths, chances * WIDE, atol=0.51)


def test_the_floor_is_painted_anew_when_the_object_changes_place(
    episode: Episode, recorded: Recorded
):
    states = episode.object_states
    changes = [0, *(np.flatnonzero(np.diff(states)) + 1).tolist()]
    keys = ("visits", "expert_visits") if episode.reward is None else ("reward", "value")
    for key in keys:
        assert list(recorded.rows(f"/world/tiles/{key}", "Mesh3D:vertex_colors")) == changes


def test_before_and_after_are_on_one_sheet_from_the_first_step_on(
    episode: Episode, recorded: Recorded
):
    (picture,) = recorded.rows(f"/{MAPS}/sheet", "EncodedImage:blob").values()
    with Image.open(io.BytesIO(bytes(picture[0]))) as sheet:
        assert sheet.size == tuple(round(inches * 144) for inches in SHEET_INCHES[MAPS])
    (texts,) = recorded.rows(f"/{MAPS}/tiles", "Points2D:labels").values()
    tiles, maps = episode.scene.grid.tiles, tile_maps(episode)
    assert len(texts) == 2 * tiles * len(episode.parts)
    for number, tile_map in enumerate(maps):
        for layer, title in enumerate(layer_titles(episode)):
            panel = number * len(episode.parts) + layer
            text = texts[panel * tiles + 3]
            assert text.startswith(f"tile 3\n{tile_map.name}")
            assert title in text
            assert text.endswith(f": {tile_map.layers[layer, 3]:.3f}")


def test_policy_and_expert_are_beside_each_other_where_a_reward_was_learned(
    episode: Episode, recorded: Recorded
):
    pictures = recorded.rows(f"/{VISITS}/sheet", "EncodedImage:blob")
    assert list(pictures) == ([] if episode.reward is None else [0])
    if episode.reward is not None:
        (texts,) = recorded.rows(f"/{VISITS}/tiles", "Points2D:labels").values()
        sums = {text.split("\n")[1].partition(":")[0]: 0.0 for text in texts}
        for text in texts:
            name, number = text.split("\n")[1].split(": ")
            sums[name] += float(number)
        # 1 + 0.99 + ...: every step is counted, the last one too.
        whole = (1 - 0.99 ** (episode.horizon + 1)) / (1 - 0.99)
        expected = dict.fromkeys(("visits", "expert's visits"), whole)
        assert sums == pytest.approx(expected, abs=0.02)


def test_the_agent_is_on_the_panels_of_where_the_object_is(
    pick_episode: Episode, recordings: dict[str, Path]
):
    recorded = Recorded(recordings["pick_episode"])
    rows = recorded.rows(f"/{MAPS}/agent", "Points2D:positions")
    board = storyboard_of(pick_episode)
    sheet = draw_sheet(board, board.maps, SHEET_INCHES[MAPS], legend=True)
    for step, state in enumerate(pick_episode.object_states):
        place = pick_episode.scene.grid.points[pick_episode.tiles[step]]
        panels = [panel for panel in sheet.panels if panel.layer == state]
        assert [panel.tile_map.key for panel in panels] == ["reward", "value"]
        expected = [panel.pixels(place[None])[0] for panel in panels]
        np.testing.assert_allclose(rows[step], [*expected, *expected], rtol=1e-5)


def test_the_object_goes_with_the_agent_and_ends_at_its_place(
    pick_episode: Episode, recordings: dict[str, Path]
):
    recorded = Recorded(recordings["pick_episode"])
    rows = recorded.rows("/world/object", "Transform3D:translation")
    for step, shown in enumerate(storyboard_of(pick_episode).steps):
        assert shown.thing is not None
        np.testing.assert_allclose(rows[step][0], shown.thing.position, atol=1e-6)
    assert pick_episode.task.placement is not None
    np.testing.assert_allclose(rows[30][0], pick_episode.task.placement.position, atol=1e-6)
    held = int(np.flatnonzero(pick_episode.object_states == 1)[0])
    agent = recorded.rows("/world/agent", "Transform3D:translation")[held][0]
    np.testing.assert_allclose(rows[held][0][:2], agent[:2])
    assert rows[held][0][2] > 1.4


def test_words_name_the_command_the_run_and_the_action(episode: Episode, recorded: Recorded):
    (card,) = recorded.rows("/about", "TextDocument:text").values()
    for word in (episode.task.command, "seen", "seed 3", "two-rooms", episode.fingerprint[:12]):
        assert word in card[0]
    lines = recorded.rows("/now", "TextDocument:text")
    assert list(lines) == list(range(episode.horizon + 1))
    assert all(f"step **{step}**" in line[0] for step, line in lines.items())
    assert ("goal reached" in lines[episode.horizon][0]) is episode.success


def words_of(recorded: Recorded) -> list[str]:
    """Every text that the viewer draws."""
    words: list[str] = []
    for chunk in recorded.chunks:
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if name.split(":")[-1] in ("text", "labels", "state", "values", "name", "names"):
                rows = [row for row in batch.column(name).to_pylist() if row]
                words += [word for row in rows for word in row if isinstance(word, str)]
    return words


def test_every_word_is_in_letters_the_viewer_can_draw(pick_episode: Episode, tmp_path: Path):
    task = replace(pick_episode.task, command="move the \u676f to the bed \u2718")
    odd = replace(pick_episode, task=task, method="\U0001f600")
    record_episodes(tmp_path / "odd.rrd", [storyboard_of(odd), storyboard_of(pick_episode)])
    words = words_of(Recorded(tmp_path / "odd.rrd"))
    assert len(words) > 100
    assert any("move the ? to the bed ?" in word for word in words)
    assert [word for word in words if plain(word) != word] == []


def test_the_only_timeline_is_the_step(recorded: Recorded):
    timelines = {name for chunk in recorded.chunks for name in chunk.timeline_names}
    assert timelines == {"step"}


def test_it_is_one_small_recording_that_opens_with_its_layout(
    episode: Episode, recorded: Recorded, recordings: dict[str, Path]
):
    (store,) = recorded.reader.recordings()
    (layout,) = recorded.reader.blueprints()
    assert store.application_id == layout.application_id == "lcrl_bench"
    assert recordings["nav_episode"].stat().st_size < MAX_BYTES
    assert recordings["pick_episode"].stat().st_size < MAX_BYTES


def test_several_episodes_have_a_timeline_each_and_one_together(
    nav_episode: Episode, pick_episode: Episode, recordings: dict[str, Path]
):
    together = Recorded(recordings["both"])
    steps = list(together.rows("/world/agent", "Transform3D:translation"))
    assert steps == [*range(31), *range(40, 71)]
    for number, episode in enumerate((nav_episode, pick_episode), 1):
        alone = Recorded(recordings["both"], f"episode_{number}")
        rows = alone.rows("/world/agent", "Transform3D:translation")
        assert list(rows) == list(range(31))
        (card,) = alone.rows("/about", "TextDocument:text").values()
        assert card[0].startswith(f"Episode {number} of 2; the other is in the menu of timelines.")
        places = np.array([value[0][:2] for value in rows.values()])
        np.testing.assert_allclose(places, episode.scene.grid.points[episode.tiles])


def test_an_episode_is_cleared_away_before_the_next(recordings: dict[str, Path]):
    cleared = Recorded(recordings["both"])
    for root in ROOTS:
        assert list(cleared.rows(f"/{root}", "Clear:is_recursive")) == [39]


def test_the_viewer_finds_no_fault_with_it(recordings: dict[str, Path]):
    files = [str(path) for path in recordings.values()]
    command = [sys.executable, "-m", "rerun", "rrd", "verify", *files]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "without error" in done.stdout + done.stderr


def test_a_failure_leaves_the_old_recording_as_it_was(
    nav_episode: Episode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    path = tmp_path / "one.rrd"
    path.write_bytes(b"old")

    def fail(*_: object, **__: object) -> None:
        raise RuntimeError("no more paper")

    monkeypatch.setattr("lcrl_bench.recording.rerun.sheets.draw_sheet", fail)
    with pytest.raises(RuntimeError, match="no more paper"):
        record_episodes(path, [storyboard_of(nav_episode)])
    assert path.read_bytes() == b"old"
    assert [file.name for file in tmp_path.iterdir()] == ["one.rrd"]


def test_a_recording_needs_an_episode(tmp_path: Path):
    with pytest.raises(ValueError, match="at least one episode"):
        record_episodes(tmp_path / "none.rrd", [])
