"""Rerun's viewer, which ships with its package: in a window, or as a page for a browser.

The viewer is a separate program; nothing is downloaded. It listens on this machine only and sends
no usage statistics: where it believes it runs in continuous integration, it neither reads nor
writes its settings for them.

Rerun's own page fetches fonts, looks for newer versions and sends usage statistics from within the
browser. Here it is served with a Content-Security-Policy, so that the browser itself refuses all of
that; the recording comes from Rerun's server on this machine.
"""

from __future__ import annotations

import http.client
import importlib.util
import os
import socket
import subprocess
import sys
import time
import urllib.parse
import webbrowser
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.interruption import forget_stop, raise_if_stopped, stops_postponed

ADDRESS: Final = "127.0.0.1"
"""Only this machine is answered."""
WEB_PORT, DATA_PORT = 9090, 9876
"""Preferred ports of the page and of the recording."""
PATIENCE: Final = 300.0
"""Seconds within which the server must answer."""
_GRACE: Final = 5.0
"""Seconds it gets to exit by itself: it holds nothing that could be lost."""
_PAUSE: Final = 0.05
_TIMEOUT: Final = 300.0


def window_wanted(environment: Mapping[str, str] = os.environ, platform: str = "") -> bool:
    """Whether a window can be opened here: on Linux only with a display, elsewhere always."""
    linux = (platform or sys.platform).startswith("linux")
    return not linux or bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def open_window(recording: Path) -> None:
    """Replace this process by the viewer in a window: it handles Ctrl-C and SIGTERM from here on.

    Raises:
        EnvironmentMissingError: If the viewer is not installed.
    """
    words = [str(viewer_program()), "--bind", ADDRESS, "--port", "auto", str(recording)]
    sys.stdout.flush()
    sys.stderr.flush()
    raise_if_stopped()
    os.execve(words[0], words, viewer_environment())


def serve_page(recording: Path, announce: Callable[[str], None]) -> None:
    """Serve a recording to browsers on this machine until Ctrl-C, and open one where possible.

    Args:
        recording: A .rrd file.
        announce: Called with the page's address once it answers.

    Raises:
        EnvironmentMissingError: If the viewer is not installed, or does not start.
    """
    with rerun_server(recording) as rerun:
        server = _server(rerun)
        source = urllib.parse.quote(f"rerun+http://{ADDRESS}:{rerun.data_port}/proxy", safe="")
        url = f"http://{ADDRESS}:{server.server_port}?url={source}"
        announce(url)
        if window_wanted():
            webbrowser.open(url)
        with server:
            try:
                server.serve_forever()
            except KeyboardInterrupt:
                # The usual way to end it.
                forget_stop()


def policy(data_port: int) -> str:
    """The page's Content-Security-Policy: it may load from itself and the recording's server."""
    return (
        "default-src 'none'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline';"
        " script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; worker-src 'self' blob:;"
        f" connect-src 'self' http://{ADDRESS}:{data_port}; base-uri 'none'; form-action 'none'"
    )


def _server(rerun: RerunServer) -> ThreadingHTTPServer:
    """A server that passes on the files of Rerun's page, with the policy."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            try:
                file = rerun.get(urllib.parse.urlsplit(self.path).path)
            except (OSError, http.client.HTTPException):
                self.send_error(http.HTTPStatus.BAD_GATEWAY)
                return
            self.send_response(file.status)
            self.send_header("Content-Type", file.kind)
            self.send_header("Content-Length", str(len(file.content)))
            self.send_header("Content-Security-Policy", policy(rerun.data_port))
            self.send_header("Referrer-Policy", "no-referrer")
            self.end_headers()
            self.wfile.write(file.content)

        def log_message(self, format: str, *args: object) -> None:
            """Log nothing per file."""

    return _Server((ADDRESS, free_port(WEB_PORT)), Handler)


class _Server(ThreadingHTTPServer):
    """A server that ends when the command is stopped."""

    def service_actions(self) -> None:
        """Called on every iteration of `serve_forever`."""
        raise_if_stopped()


@dataclass(frozen=True)
class ServedFile:
    """A file of Rerun's page."""

    status: int
    kind: str
    """Media type."""
    content: bytes


@dataclass(frozen=True)
class RerunServer:
    """Rerun's own web server, running."""

    page_port: int
    data_port: int
    """Port the recording is served on."""

    def get(self, path: str) -> ServedFile:
        """Fetch a file of Rerun's page.

        Raises:
            OSError: If the server can no longer be reached.
            http.client.HTTPException: If its answer is not HTTP.
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
    """Start Rerun's web server for this machine alone, and stop it afterwards.

    Args:
        recording: A .rrd file for its page to show.

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
        # A stop between starting it and the next line would leave it running.
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
    raise EnvironmentMissingError("Rerun's server did not start; its output is above.")


def viewer_program() -> Path:
    """The viewer of the installed `rerun-sdk`.

    Raises:
        EnvironmentMissingError: If it is missing.
    """
    spec = importlib.util.find_spec("rerun_cli")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        for name in ("rerun", "rerun.exe"):
            if (Path(folder) / name).is_file():
                return Path(folder) / name
    raise EnvironmentMissingError("No Rerun viewer is installed: pip install rerun-sdk")


def viewer_environment(environment: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Environment of a viewer process: no usage statistics, only warnings are printed."""
    return {"RUST_LOG": "warn", **environment, "CI": "1"}


def free_port(wanted: int) -> int:
    """A free port of this machine: the one wanted, or else any."""
    for port in (wanted, 0):
        with socket.socket() as server:
            try:
                server.bind((ADDRESS, port))
            except OSError:
                continue
            return int(server.getsockname()[1])
    raise EnvironmentMissingError(f"No port of {ADDRESS} is free.")
