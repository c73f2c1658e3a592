"""The viewer as a web page of this machine, that asks nothing of any other.

Rerun's own page looks for fonts, newer versions and examples on the network, and sends usage
statistics from within the browser. Here it is handed on with a Content-Security-Policy, so the
browser itself refuses all of that; the recording comes from Rerun's server on this machine.
"""

from __future__ import annotations

import http.client
import subprocess
import time
import urllib.parse
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.recording.rerun_viewer import (
    ADDRESS,
    DATA_PORT,
    WEB_PORT,
    free_port,
    viewer_environment,
    viewer_program,
    window_wanted,
)

PATIENCE: Final = 30.0
"""Seconds within which Rerun's server must answer."""
_PAUSE: Final = 0.05
_TIMEOUT: Final = 10.0


def serve_page(recording: Path, announce: Callable[[str], None]) -> None:
    """Offer a recording to browsers of this machine until Ctrl-C; opens one where it can.

    Args:
        recording: A .rrd file.
        announce: Told the page's address once it answers.

    Raises:
        EnvironmentMissingError: If the viewer is not installed, or does not start.
    """
    with _rerun_server(recording) as (inner, data):
        server = _server(inner, data)
        source = urllib.parse.quote(f"rerun+http://{ADDRESS}:{data}/proxy", safe="")
        url = f"http://{ADDRESS}:{server.server_port}?url={source}"
        announce(url)
        if window_wanted():
            webbrowser.open(url)
        with server:
            try:
                server.serve_forever()
            except KeyboardInterrupt:
                # The usual way to end it.
                return


def policy(data_port: int) -> str:
    """The Content-Security-Policy of the page: itself, and the recording's server."""
    return (
        "default-src 'none'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline';"
        " script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; worker-src 'self' blob:;"
        f" connect-src 'self' http://{ADDRESS}:{data_port}; base-uri 'none'; form-action 'none'"
    )


@contextmanager
def _rerun_server(recording: Path) -> Iterator[tuple[int, int]]:
    """Rerun serving its page and a recording: the ports of the two."""
    inner, data = free_port(0), free_port(DATA_PORT)
    words = [str(viewer_program()), "--serve-web", "--bind", ADDRESS]
    words += ["--web-viewer-port", str(inner), "--port", str(data), str(recording)]
    environment = viewer_environment()
    with subprocess.Popen(words, env=environment, stdin=subprocess.DEVNULL) as process:
        try:
            _await(process, inner)
            yield inner, data
        finally:
            process.terminate()


def _await(process: subprocess.Popen[bytes], port: int) -> None:
    until = time.monotonic() + PATIENCE
    while process.poll() is None and time.monotonic() < until:
        try:
            _get(port, "/")
        except OSError:
            time.sleep(_PAUSE)
        else:
            return
    raise EnvironmentMissingError("Rerun's server did not start; what it said is above.")


def _get(port: int, path: str) -> tuple[int, str, bytes]:
    """Status, content type and content of a file of Rerun's page."""
    connection = http.client.HTTPConnection(ADDRESS, port, timeout=_TIMEOUT)
    try:
        connection.request("GET", path)
        answer = connection.getresponse()
        kind = answer.getheader("Content-Type") or "application/octet-stream"
        return answer.status, kind, answer.read()
    finally:
        connection.close()


def _server(inner: int, data: int) -> ThreadingHTTPServer:
    """Hands on the files of Rerun's page, with the policy."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            try:
                status, kind, content = _get(inner, urllib.parse.urlsplit(self.path).path)
            except (OSError, http.client.HTTPException):
                self.send_error(http.HTTPStatus.BAD_GATEWAY)
                return
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(content)))
            self.send_header("Content-Security-Policy", policy(data))
            self.send_header("Referrer-Policy", "no-referrer")
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, format: str, *args: object) -> None:
            """Say nothing of each file."""

    return ThreadingHTTPServer((ADDRESS, free_port(WEB_PORT)), Handler)
