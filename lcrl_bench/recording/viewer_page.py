"""The viewer as a web page of this machine, that asks nothing of any other.

Rerun's own page looks for fonts, newer versions and examples on the network, and sends usage
statistics from within the browser. Here it is handed on with a Content-Security-Policy, so the
browser itself refuses all of that; the recording comes from Rerun's server on this machine.
"""

from __future__ import annotations

import http.client
import urllib.parse
import webbrowser
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from lcrl_bench.interruption import forget_stop, raise_if_stopped
from lcrl_bench.recording.rerun_server import RerunServer, rerun_server
from lcrl_bench.recording.rerun_viewer import ADDRESS, WEB_PORT, free_port, window_wanted


def serve_page(recording: Path, announce: Callable[[str], None]) -> None:
    """Offer a recording to browsers of this machine until Ctrl-C; opens one where it can.

    Args:
        recording: A .rrd file.
        announce: Told the page's address once it answers.

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
    """The Content-Security-Policy of the page: itself, and the recording's server."""
    return (
        "default-src 'none'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline';"
        " script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; worker-src 'self' blob:;"
        f" connect-src 'self' http://{ADDRESS}:{data_port}; base-uri 'none'; form-action 'none'"
    )


def _server(rerun: RerunServer) -> ThreadingHTTPServer:
    """Hands on the files of Rerun's page, with the policy."""

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
            """Say nothing of each file."""

    return _Server((ADDRESS, free_port(WEB_PORT)), Handler)


class _Server(ThreadingHTTPServer):
    """Ends when the command is stopped."""

    def service_actions(self) -> None:
        """Called in every round of `serve_forever`."""
        raise_if_stopped()
