"""The player: Rerun's viewer in a document of its own beside the page, loaded when it is asked for.

A browser lets no page that was opened from a file fetch another file, but it loads scripts. So the
viewer's program and each recording are also written as scripts that hand over their content,
compressed, as text. The player's policy lets nothing else in, and no request out.
"""

from __future__ import annotations

import base64
import gzip
import json
from importlib import resources
from pathlib import Path
from string import Template
from typing import Final

from lcrl_bench.board.viewer import SCRIPT, Viewer
from lcrl_bench.storage import write_bytes

FOLDER: Final = "player"
DOCUMENT: Final = "player.html"
PROGRAM: Final = "program.js"


def write_player(viewer: Viewer, folder: Path) -> Path:
    """Write the player; about 18 MB, nearly all of it the viewer.

    Args:
        viewer: The viewer.
        folder: Where the page is; the player gets a folder in it.

    Returns:
        The player's document.
    """
    home = folder / FOLDER
    document = Template(_template(DOCUMENT)).substitute(viewer=SCRIPT, program=PROGRAM)
    write_bytes(home / DOCUMENT, document.encode())
    write_bytes(home / "player.css", _template("player.css").encode())
    write_bytes(home / "player.js", _template("player.js").encode())
    write_bytes(home / "start.js", _template("start.js").encode())
    write_bytes(home / SCRIPT, viewer.script)
    write_bytes(home / PROGRAM, handing_over("program", viewer.program))
    return home / DOCUMENT


def handing_over(name: str, data: bytes) -> bytes:
    """A script that hands some bytes over to the player, under a name."""
    # The time is left out of the archive: the same bytes give the same script.
    packed = base64.b64encode(gzip.compress(data, 6, mtime=0)).decode()
    return f"handOver({json.dumps(name)}, {json.dumps(packed)});\n".encode()


def _template(name: str) -> str:
    return resources.files("lcrl_bench.leaderboard").joinpath(name).read_text("utf-8")
