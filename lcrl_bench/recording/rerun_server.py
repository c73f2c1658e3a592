"""Rerun's own web server, on this machine and for it alone: its page, and a recording to show."""

from __future__ import annotations

import http.client
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.interruption import raise_if_stopped, stops_postponed
from lcrl_bench.recording.rerun_viewer import (
    ADDRESS,
    DATA_PORT,
    free_port,
    viewer_environment,
    viewer_program,
)

PATIENCE: Final = 300.0
"""Seconds within which the server must answer."""
_GRACE: Final = 5.0
"""Seconds it is given to end by itself: it holds nothing that could be lost."""
_PAUSE: Final = 0.05
_TIMEOUT: Final = 300.0


@dataclass(frozen=True)
class ServedFile:
    """A file of the page, as the server hands it out."""

    status: int
    kind: str
    """Its media type."""
    content: bytes


@dataclass(frozen=True)
class RerunServer:
    """A server that answers."""

    page_port: int
    data_port: int
    """Where the recording comes from."""

    def get(self, path: str) -> ServedFile:
        """Fetch a file of Rerun's page.

        Raises:
            OSError: If it can't be reached any more.
            http.client.HTTPException: If it does not speak HTTP.
        """
        connection = http.client.HTTPConnection(ADDRESS, self.page_port, timeout=_TIMEOUT)
        try:
            connection.request("GET", path)
            answer = connection.getresponse()
            kind = answer.getheader("Content-Type") or "application/octet-stream"
            return ServedFile(answer.status, kind, answer.read())
        finally:
            connection.close()


@contextmanager
def rerun_server(recording: Path | None = None) -> Iterator[RerunServer]:
    """Start it, and end it afterwards.

    Args:
        recording: A .rrd file that its page is to show.

    Raises:
        EnvironmentMissingError: If the viewer is not installed, or does not start.
    """
    server = RerunServer(page_port=free_port(0), data_port=free_port(DATA_PORT))
    words = [str(viewer_program()), "--serve-web", "--bind", ADDRESS]
    words += ["--web-viewer-port", str(server.page_port), "--port", str(server.data_port)]
    words += [] if recording is None else [str(recording)]
    environment = viewer_environment()
    process: subprocess.Popen[bytes] | None = None
    try:
        # A stop between its start and the next line would leave it running.
        with stops_postponed():
            process = subprocess.Popen(words, env=environment, stdin=subprocess.DEVNULL)
        _await(process, server)
        yield server
    finally:
        if process is not None:
            _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(_GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _await(process: subprocess.Popen[bytes], server: RerunServer) -> None:
    until = time.monotonic() + PATIENCE
    while process.poll() is None and time.monotonic() < until:
        raise_if_stopped()
        try:
            server.get("/")
        except OSError:
            time.sleep(_PAUSE)
        else:
            return
    raise EnvironmentMissingError("Rerun's server did not start; what it said is above.")
