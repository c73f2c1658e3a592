"""The player: Rerun's web viewer in a document beside the page, loaded on demand.

The viewer is part of the `rerun` program, of the very version that makes the recordings, which
serves it over HTTP: it is fetched from this machine, within a second. So the page needs no network,
no Node, and no second pin of a version.

A browser lets no page that was opened from a file fetch another file, but it loads scripts. So the
viewer's WebAssembly and each recording are also written as scripts that contain them, compressed,
as text. The player's policy lets nothing else in, and no request out.
"""

from __future__ import annotations

import base64
import gzip
import http.client
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lcrl_bench.board.page import leaderboard_file
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.recording.rerun.viewer import RerunServer, rerun_server
from lcrl_bench.storage import write_bytes

FOLDER: Final = "player"
DOCUMENT: Final = "player.html"
SCRIPT: Final = "re_viewer.js"
PROGRAM: Final = "re_viewer_bg.wasm"
ADVICE: Final = "Or build the page without it: --no-viewer."


@dataclass(frozen=True)
class Viewer:
    """The two files of Rerun's web viewer."""

    script: bytes
    """JavaScript, for a classic script element: defines `wasm_bindgen`."""
    program: bytes
    """WebAssembly."""


def web_viewer() -> Viewer:
    """The viewer of the installed rerun-sdk.

    Raises:
        EnvironmentMissingError: If there is no `rerun` program, or it does not serve the viewer.
    """
    with rerun_server() as server:
        return Viewer(_file(server, SCRIPT), _file(server, PROGRAM))


def write_player(viewer: Viewer, folder: Path) -> Path:
    """Write the player; about 18 MB, nearly all of it the viewer.

    Args:
        viewer: The viewer.
        folder: The page's folder; the player gets a folder in it.

    Returns:
        The player's document.
    """
    home = folder / FOLDER
    for name in (DOCUMENT, "player.css", "player.js", "start.js"):
        write_bytes(home / name, leaderboard_file(name).encode())
    write_bytes(home / SCRIPT, viewer.script)
    write_bytes(home / "program.js", as_script("program", viewer.program))
    return home / DOCUMENT


def as_script(name: str, data: bytes) -> bytes:
    """A script that passes bytes to the player, under a name."""
    # The archive has no time in it: the same bytes give the same script.
    packed = base64.b64encode(gzip.compress(data, 6, mtime=0)).decode()
    return f"provide({json.dumps(name)}, {json.dumps(packed)});\n".encode()


def _file(server: RerunServer, name: str) -> bytes:
    """A file that the server serves."""
    try:
        file = server.get(f"/{name}")
    except (OSError, http.client.HTTPException) as error:
        raise EnvironmentMissingError(f"rerun did not give {name}: {error}. {ADVICE}") from error
    if file.status != http.HTTPStatus.OK or not file.content:
        raise EnvironmentMissingError(f"This rerun has no {name} ({file.status}). {ADVICE}")
    return file.content
