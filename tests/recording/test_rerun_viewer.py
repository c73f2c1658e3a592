"""Which recording is opened, and how the viewer is called."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from PIL import Image

from lcrl_bench.errors import EnvironmentMissingError, InvalidFileError, UnknownNameError
from lcrl_bench.recording.index import (
    EpisodeIndex,
    RecordedEpisode,
    RecordedFile,
    check_recording,
    find_recordings,
)
from lcrl_bench.recording.palette import class_colors
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.rerun.screenshot import write_screenshot
from lcrl_bench.recording.rerun.viewer import (
    free_port,
    open_window,
    viewer_program,
    window_wanted,
)
from lcrl_bench.recording.storyboard import storyboard_of
from lcrl_bench.storage import write_json

RECORDING = b"RRF2"


def entry(task: str, *, own: bool) -> RecordedEpisode:
    files = {"recording": RecordedFile(path=f"{task}.rrd", bytes=4)} if own else {}
    words = {"command": "go to the bed", "split": "train", "kind": "nav", "house": "h"}
    return RecordedEpisode(task=task, **words, success=1.0, reached=True, failure=None, files=files)


@pytest.fixture
def run(tmp_path) -> Path:
    """A run with a recording of two episodes and one of a third."""
    folder = tmp_path / "runs" / "tiny" / "lcrl" / "seed0"
    (folder / "episodes").mkdir(parents=True)
    for name in ("config.json", "DONE"):
        (folder / name).write_text("{}")
    for name in ("recording.rrd", "episodes/h.go-to-the-sofa.rrd"):
        (folder / name).write_bytes(RECORDING)
    episodes = (
        entry("h.go-to-the-bed", own=False),
        entry("h.go-to-the-bedroom", own=False),
        entry("h.go-to-the-sofa", own=True),
    )
    index = EpisodeIndex(selections=("showcase", "first"), episodes=episodes)
    write_json(folder / "episodes" / "index.json", index.model_dump(mode="json"))
    return folder


def test_a_run_stands_for_its_recording_and_lists_its_episodes(run):
    found = find_recordings(run)
    assert found.main == run / "recording.rrd"
    assert len(found.episodes) == 3
    assert find_recordings(run.parents[2]) == found


def test_an_episode_is_named_by_its_task_or_by_a_part_that_no_other_has(run):
    found = find_recordings(run)
    assert found.episode("sofa") == run / "episodes" / "h.go-to-the-sofa.rrd"
    assert found.episode("h.go-to-the-bed") == run / "recording.rrd"
    for name in ("bed", "moon"):
        with pytest.raises(UnknownNameError, match=r"h\.go-to-the-bed"):
            found.episode(name)


def test_a_file_stands_for_itself_and_a_folder_for_its_only_recording(tmp_path):
    file = tmp_path / "ask.rrd"
    file.write_bytes(RECORDING)
    assert find_recordings(file).main == find_recordings(tmp_path).main == file
    assert find_recordings(file).episodes == ()


def test_a_run_without_a_recording_says_how_to_make_one(run):
    (run / "recording.rrd").unlink()
    with pytest.raises(InvalidFileError, match="--record showcase"):
        find_recordings(run)


def test_what_is_no_recording_is_refused(tmp_path):
    file = tmp_path / "notes.rrd"
    file.write_text("notes")
    with pytest.raises(InvalidFileError, match="not a Rerun recording"):
        check_recording(file)
    with pytest.raises(InvalidFileError, match="no such file"):
        check_recording(tmp_path / "gone.rrd")


def test_a_window_is_opened_where_there_is_a_display():
    assert not window_wanted({}, "linux")
    assert window_wanted({"DISPLAY": ":0"}, "linux")
    assert window_wanted({"WAYLAND_DISPLAY": "wayland-0"}, "linux")
    assert window_wanted({}, "darwin")


def test_a_window_answers_this_machine_only_and_counts_nothing(monkeypatch):
    became = []
    monkeypatch.setattr("os.execve", lambda *call: became.append(call))
    open_window(Path("a.rrd"))
    ((program, words, environment),) = became
    assert Path(program) == viewer_program()
    assert words[1:3] == ["--bind", "127.0.0.1"]
    assert words[-1] == "a.rrd"
    assert "CI" in environment


def test_a_port_that_is_taken_is_left_alone():
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        taken = server.getsockname()[1]
        assert free_port(taken) != taken


def test_the_viewer_takes_every_flag_it_is_called_with():
    shown = subprocess.run([viewer_program(), "--help"], capture_output=True, text=True).stdout
    served = ("--bind", "--port", "--serve-web", "--web-viewer-port")
    for flag in (*served, "--headless", "--window-size", "--hide-welcome-screen"):
        assert f"{flag} " in shown or f"{flag}\n" in shown


@pytest.fixture(scope="module")
def episode_recording(nav_episode, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "episode.rrd"
    record_episodes(path, [storyboard_of(nav_episode)])
    return path


def test_a_screenshot_shows_the_recording_and_not_the_viewer_alone(episode_recording, tmp_path):
    try:
        write_screenshot(episode_recording, tmp_path / "shot.png", size=(1200, 800))
    except EnvironmentMissingError:
        pytest.skip("no Vulkan on this machine")
    with Image.open(tmp_path / "shot.png") as picture:
        assert picture.size == (1200, 800)
        colors = picture.convert("RGB").getcolors(1 << 24) or []
    # The views' classes are drawn in their own colours; a viewer without data is grey.
    found = {color for count, color in colors if count > 50}
    assert len(found & {tuple(color) for color in class_colors().tolist()}) >= 3


@pytest.mark.parametrize(("stop", "status"), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_a_browser_is_served_a_page_until_it_is_stopped(episode_recording, tmp_path, stop, status):
    command = [sys.executable, "-m", "lcrl_bench", "view", str(episode_recording), "--web"]
    environment = {k: v for k, v in os.environ.items() if "DISPLAY" not in k}
    environment |= {"XDG_CONFIG_HOME": str(tmp_path), "XDG_DATA_HOME": str(tmp_path)}
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as viewer:
        assert viewer.stderr is not None
        said = [viewer.stderr.readline(), viewer.stderr.readline()]
        url = re.search(r"http://127\.0\.0\.1:\d+", said[1])
        assert url is not None, said
        with urllib.request.urlopen(url[0], timeout=600) as answer:
            page, rules = answer.read().decode(), answer.headers["Content-Security-Policy"]
        viewer.send_signal(stop)
        assert viewer.wait(timeout=600) == status
    assert "<canvas" in page
    # The browser is told to ask nobody else, and nothing was written about this use of the viewer.
    assert set(re.findall(r"https?://[^ ;]+", rules)) == {f"http://127.0.0.1:{data_port(said[1])}"}
    assert "default-src 'none'" in rules
    assert list(tmp_path.rglob("analytics*")) == []
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(url[0], timeout=600)


def data_port(said: str) -> str:
    """The port of the recording, out of the page's address."""
    found = re.search(r"127\.0\.0\.1%3A(\d+)%2Fproxy", said)
    assert found is not None, said
    return found[1]
