"""Rerun's viewer for the web, of the very version that makes the recordings.

It is part of the `rerun` program, which hands it out over HTTP: it is asked on this machine, within
a second. So the page needs no network, no Node, and no second pin of a version.
"""

from __future__ import annotations

import http.client
from dataclasses import dataclass
from importlib import metadata
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.recording.rerun.viewer import RerunServer, rerun_server

SCRIPT: Final = "re_viewer.js"
PROGRAM: Final = "re_viewer_bg.wasm"
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
    with rerun_server() as server:
        script, program = (_file(server, name) for name in (SCRIPT, PROGRAM))
    return Viewer(metadata.version("rerun-sdk"), script, program)


def _file(server: RerunServer, name: str) -> bytes:
    """A file as the server hands it out."""
    try:
        file = server.get(f"/{name}")
    except (OSError, http.client.HTTPException) as error:
        raise EnvironmentMissingError(f"rerun did not give {name}: {error}. {ADVICE}") from error
    if file.status != http.HTTPStatus.OK or not file.content:
        raise EnvironmentMissingError(f"This rerun has no {name} ({file.status}). {ADVICE}")
    return file.content
