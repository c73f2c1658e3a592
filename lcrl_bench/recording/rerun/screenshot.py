"""A screenshot of the viewer with a recording open, taken without a window.

The viewer's own `--screenshot-to` draws before a recording is loaded, so a headless viewer is
started and asked for a picture once everything is there. Rerun calls this interface experimental;
the suite is pinned to one minor version of it.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Final, TypeVar

from rerun.experimental import ViewerClient

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.interruption import raise_if_stopped, stops_postponed
from lcrl_bench.recording.rerun.viewer import (
    ADDRESS,
    DATA_PORT,
    free_port,
    viewer_environment,
    viewer_program,
)
from lcrl_bench.storage import write_bytes

SIZE: Final = (1600, 1000)
"""Columns and rows of a screenshot."""
PATIENCE: Final = 300.0
"""Seconds within which a recording must be loaded."""
_SETTLED: Final = 1.5
"""Seconds the views take to draw what was loaded."""
_PAUSE: Final = 0.1
"""Seconds between two requests."""
_Answer = TypeVar("_Answer")


def write_screenshot(recording: Path, picture: Path, *, size: tuple[int, int] = SIZE) -> None:
    """Take a screenshot at the last step of a recording's first timeline.

    Args:
        recording: A .rrd file.
        picture: The .png to write.
        size: Columns and rows.

    Raises:
        EnvironmentMissingError: If the viewer is not installed, or has nothing to draw with.
    """
    port = free_port(DATA_PORT)
    words = [str(viewer_program()), "--headless", "--hide-welcome-screen", "--bind", ADDRESS]
    words += ["--port", str(port), "--window-size", f"{size[0]}x{size[1]}", str(recording)]
    with tempfile.TemporaryFile() as log:
        viewer: subprocess.Popen[bytes] | None = None
        try:
            with stops_postponed():
                viewer = subprocess.Popen(
                    words,
                    env=viewer_environment(),
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=log,
                )
            png = _ask(viewer, f"rerun+http://{ADDRESS}:{port}/proxy")
        finally:
            if viewer is not None:
                viewer.terminate()
                viewer.wait()
        if not png:
            raise EnvironmentMissingError(
                f"The viewer drew no picture: {_last_line(log)}. It needs Vulkan; a"
                " software driver is enough (Debian, Ubuntu: mesa-vulkan-drivers)."
            )
    write_bytes(picture, png)


def _ask(viewer: subprocess.Popen[bytes], url: str) -> bytes:
    """The picture as PNG; empty if the viewer ended or took too long."""
    until = time.monotonic() + PATIENCE
    while viewer.poll() is None and time.monotonic() < until:
        raise_if_stopped()
        if _try(lambda: _to_the_end(ViewerClient.connect(url))):
            return _settled(viewer, url, until)
        time.sleep(_PAUSE)
    return b""


def _settled(viewer: subprocess.Popen[bytes], url: str, until: float) -> bytes:
    """The picture once it no longer changes: on a busy machine views are drawn more slowly."""
    before = b""
    while viewer.poll() is None and time.monotonic() < until:
        raise_if_stopped()
        time.sleep(_SETTLED)
        png = _try(ViewerClient.connect(url).take_screenshot) or b""
        if png and png == before:
            break
        before = png
    return before


def _to_the_end(client: ViewerClient) -> bool:
    """Go to the last step once everything is loaded; return whether it is."""
    state = client.get_state()
    if state.loading or not state.recordings:
        return False
    recording = state.recordings[0]
    ends = {timeline.name: timeline.end for timeline in recording.timelines}
    end = ends.get(recording.current_timeline or "")
    if end is None:
        return False
    client.set_time(sequence=end, play_state="paused")
    return True


def _try(question: Callable[[], _Answer]) -> _Answer | None:
    """An answer; None while the viewer does not respond."""
    try:
        return question()
    except (ConnectionError, RuntimeError, ValueError):
        return None


def _last_line(log: IO[bytes]) -> str:
    log.seek(0)
    lines = log.read().decode("utf-8", "replace").strip().splitlines()
    return lines[-1] if lines else "it printed nothing"
