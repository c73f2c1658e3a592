"""Opening a recording with the viewer that Rerun's package brings along: nothing is downloaded.

The viewer is a program of its own. It listens on this machine only, and counts nothing: where it
believes to be in a continuous integration it neither reads nor writes its settings for that.
"""

from __future__ import annotations

import importlib.util
import os
import socket
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError, InvalidFileError
from lcrl_bench.interruption import raise_if_stopped

ADDRESS: Final = "127.0.0.1"
"""Nobody but this machine is answered."""
WEB_PORT, DATA_PORT = 9090, 9876
"""Where the page and the recording are offered, if these ports are free."""
_MAGIC: Final = b"RRF"


def check_recording(path: Path) -> Path:
    """Refuse what is no recording, and return what is.

    Raises:
        InvalidFileError: If there is no such file, or it is none of Rerun's.
    """
    if not path.is_file():
        raise InvalidFileError(path, "no such file", fix="Name a .rrd file or the folder of a run.")
    with path.open("rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise InvalidFileError(path, "no Rerun recording", fix="Name a .rrd file.")
    return path


def window_wanted(environment: Mapping[str, str] = os.environ, platform: str = "") -> bool:
    """Whether a window can be opened here: on Linux only with a display, elsewhere always."""
    linux = (platform or sys.platform).startswith("linux")
    return not linux or bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def open_window(recording: Path) -> None:
    """Become the viewer in a window of its own: Ctrl-C and SIGTERM are its own from here on.

    Raises:
        EnvironmentMissingError: If the viewer is not installed.
    """
    words = [str(viewer_program()), "--bind", ADDRESS, "--port", "auto", str(recording)]
    sys.stdout.flush()
    sys.stderr.flush()
    raise_if_stopped()
    os.execve(words[0], words, viewer_environment())


def viewer_program() -> Path:
    """The viewer of the installed `rerun-sdk`.

    Raises:
        EnvironmentMissingError: If it is not there.
    """
    spec = importlib.util.find_spec("rerun_cli")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        for name in ("rerun", "rerun.exe"):
            if (Path(folder) / name).is_file():
                return Path(folder) / name
    raise EnvironmentMissingError("No Rerun viewer is installed: pip install rerun-sdk")


def viewer_environment(environment: Mapping[str, str] = os.environ) -> dict[str, str]:
    """The environment a viewer is started in: no usage statistics, and no talk but warnings."""
    return {"RUST_LOG": "warn", **environment, "CI": "1"}


def free_port(wanted: int) -> int:
    """A port of this machine that nobody listens on: the one wanted, or else any."""
    for port in (wanted, 0):
        with socket.socket() as server:
            try:
                server.bind((ADDRESS, port))
            except OSError:
                continue
            return int(server.getsockname()[1])
    raise EnvironmentMissingError(f"No port of {ADDRESS} is free.")
