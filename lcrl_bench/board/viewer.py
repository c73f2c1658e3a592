"""Rerun's viewer for the web, of the very version that makes the recordings.

It is part of the `rerun` program, which hands it out over HTTP: it is asked on this machine, within
a second. So the page needs no network, no Node, and no second pin of a version.
"""

from __future__ import annotations

import http.client
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, Final

from lcrl_bench.errors import EnvironmentMissingError

SCRIPT: Final = "re_viewer.js"
PROGRAM: Final = "re_viewer_bg.wasm"
HOST: Final = "127.0.0.1"
PATIENCE_S: Final = 30
MAX_BYTES: Final = 256 * 1024 * 1024
ADVICE: Final = "Or build the page without it: --no-viewer."


@dataclass(frozen=True)
class Viewer:
    """The viewer's two files."""

    version: str
    script: bytes
    """JavaScript, for a classic script element: defines `wasm_bindgen`."""
    program: bytes
    """WebAssembly."""


def web_viewer() -> Viewer:
    """The viewer of the installed rerun-sdk.

    Raises:
        EnvironmentMissingError: If there is no `rerun` program, or it does not hand it out.
    """
    with _server() as port:
        script, program = (_file(port, name) for name in (SCRIPT, PROGRAM))
    return Viewer(metadata.version("rerun-sdk"), script, program)


def rerun_program() -> str:
    """The `rerun` program of this environment, or else the PATH's.

    Raises:
        EnvironmentMissingError: If there is none.
    """
    beside = Path(sys.executable).with_name("rerun")
    found = str(beside) if beside.exists() else shutil.which("rerun")
    if found is None:
        raise EnvironmentMissingError(f"No program 'rerun': pip install rerun-sdk. {ADVICE}")
    return found


@contextmanager
def _server() -> Iterator[int]:
    """A `rerun` that hands out its viewer, to this machine alone; its port."""
    program = rerun_program()
    port, other = _free_ports(2)
    with tempfile.TemporaryDirectory() as home:
        # A home of its own, in which nothing is counted or sent.
        told: dict[str, Any] = {
            "env": {**os.environ, "HOME": home, "XDG_CONFIG_HOME": home, "XDG_DATA_HOME": home},
            "stdout": subprocess.DEVNULL,
            "stderr": subprocess.DEVNULL,
        }
        subprocess.run([program, "analytics", "disable"], check=False, timeout=PATIENCE_S, **told)
        ports = ["--web-viewer-port", str(port), "--port", str(other)]
        process = subprocess.Popen([program, "--serve-web", "--bind", HOST, *ports], **told)
        try:
            _await(port, process)
            yield port
        finally:
            process.terminate()
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _file(port: int, name: str) -> bytes:
    """A file as the server hands it out."""
    connection = http.client.HTTPConnection(HOST, port, timeout=PATIENCE_S)
    try:
        connection.request("GET", f"/{name}")
        answer = connection.getresponse()
        data = answer.read(MAX_BYTES)
    except (OSError, http.client.HTTPException) as error:
        raise EnvironmentMissingError(f"rerun did not give {name}: {error}. {ADVICE}") from error
    finally:
        connection.close()
    if answer.status != http.HTTPStatus.OK or not data:
        raise EnvironmentMissingError(f"This rerun has no {name} ({answer.status}). {ADVICE}")
    return data


def _free_ports(count: int) -> list[int]:
    sockets = [socket.create_server((HOST, 0)) for _ in range(count)]
    try:
        return [each.getsockname()[1] for each in sockets]
    finally:
        for each in sockets:
            each.close()


def _await(port: int, process: subprocess.Popen[Any]) -> None:
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end and process.poll() is None:
        try:
            socket.create_connection((HOST, port), timeout=1).close()
        except OSError:
            time.sleep(0.05)
        else:
            return
    raise EnvironmentMissingError(f"rerun did not start to serve its viewer. {ADVICE}")
