"""A headless Chromium, driven over a pipe by the DevTools protocol: no driver, no open port.

Everything a page asks for and says on its console is kept, in every frame of it.
"""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

NAMES: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS: Final = (
    "--headless=new",
    "--remote-debugging-pipe",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-extensions",
    "--disable-sync",
    "--disable-quic",
    "--disable-dev-shm-usage",
    "--metrics-recording-only",
    # A graphics card is not needed: WebGL in software.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # Whatever asks for another machine is told that there is none.
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
LAUNCH: Final = """
import fcntl, os, sys
to, back, *words = sys.argv[1:]
spare = [fcntl.fcntl(int(each), fcntl.F_DUPFD_CLOEXEC, 10) for each in (to, back)]
os.dup2(spare[0], 3)
os.dup2(spare[1], 4)
os.execv(words[0], words)
"""
"""Becomes the browser, which speaks on the descriptors 3 and 4."""
PATIENCE: Final = 600.0
"""Seconds after which something never comes: far longer than any machine takes, however busy."""
KEYS: Final = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "ArrowDown": 40}


def find_chromium() -> str | None:
    """The browser of `LCRL_CHROMIUM` or of the PATH; None where there is none."""
    named = os.environ.get("LCRL_CHROMIUM")
    return named or next((path for name in NAMES if (path := shutil.which(name))), None)


class PageError(AssertionError):
    """A program that was run in the page failed."""


@dataclass
class Page:
    """The one page of a browser."""

    to_browser: int
    from_browser: int
    session: str = ""
    requests: list[str] = field(default_factory=list)
    """The URL of everything that was asked for."""
    complaints: list[str] = field(default_factory=list)
    """Errors and warnings of the console, uncaught exceptions, and what a policy refused."""
    _buffer: bytes = b""
    _number: int = 0
    _answers: dict[int, dict[str, Any]] = field(default_factory=dict)

    def open(self, path: Path) -> None:
        """Open a file, and wait until it is loaded."""
        self.send("Page.navigate", url=path.resolve().as_uri())
        self.wait("document.readyState === 'complete'")

    def run(self, program: str) -> Any:
        """The value of a JavaScript expression; a promise is waited for.

        Raises:
            PageError: If it throws.
        """
        found = self.send(
            "Runtime.evaluate", expression=program, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in found:
            raise PageError(found["exceptionDetails"]["exception"]["description"])
        return found["result"].get("value")

    def wait(self, condition: str, *, seconds: float = PATIENCE) -> None:
        """Wait until a JavaScript condition holds.

        Raises:
            PageError: If it does not within `seconds`.
        """
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            with suppress(PageError):
                if self.run(f"Boolean({condition})"):
                    return
            time.sleep(0.05)
        raise PageError(f"not within {seconds} s: {condition}\n" + "\n".join(self.complaints))

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press a key: one of `KEYS`, or a letter."""
        code = KEYS.get(key, ord(key[0].upper()))
        said = {"Enter": "\r", " ": " "}.get(key, key if len(key) == 1 else "")
        about = {"key": key, "windowsVirtualKeyCode": code, "modifiers": 8 if shift else 0}
        self.send(
            "Input.dispatchKeyEvent", type="keyDown", **about, **({"text": said} if said else {})
        )
        self.send("Input.dispatchKeyEvent", type="keyUp", **about)

    def resize(self, width: int, height: int, *, dark: bool = False) -> None:
        """Give the page a size in pixels, and a colour scheme."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.send("Emulation.setEmulatedMedia", features=[scheme])

    def picture(self) -> bytes:
        """What is seen, as PNG."""
        return base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"])

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command of the protocol, and wait for its answer."""
        self._number += 1
        number = self._number
        message: dict[str, Any] = {"id": number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to_browser, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while number not in self._answers:
            self._read(end)
        answer = self._answers.pop(number)
        if "error" in answer:
            raise PageError(f"{method}: {answer['error']['message']}")
        return answer.get("result", {})

    def _read(self, end: float) -> None:
        ready, _, _ = select.select([self.from_browser], [], [], max(0.0, end - time.monotonic()))
        if not ready:
            raise PageError("the browser does not answer")
        data = os.read(self.from_browser, 1 << 20)
        if not data:
            raise PageError("the browser is gone")
        *whole, self._buffer = (self._buffer + data).split(b"\0")
        for text in whole:
            message = json.loads(text)
            if "id" in message:
                self._answers[message["id"]] = message
            else:
                self._hear(message["method"], message["params"])

    def _hear(self, event: str, about: dict[str, Any]) -> None:
        if event == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])
        elif event == "Runtime.exceptionThrown":
            self.complaints.append(json.dumps(about["exceptionDetails"])[:2000])
        elif event == "Runtime.consoleAPICalled" and about["type"] in (
            "error",
            "warning",
            "assert",
        ):
            words = [str(each.get("value", each.get("description"))) for each in about["args"]]
            self.complaints.append(f"{about['type']}: {' '.join(words)}")
        elif event == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning"):
            entry = about["entry"]
            self.complaints.append(f"{entry['level']}: {entry['text']} {entry.get('url', '')}")


@contextmanager
def chromium(program: str, profile: Path) -> Iterator[Page]:
    """A browser with a profile of its own, closed at the end.

    Args:
        program: `find_chromium()`.
        profile: An empty folder for the profile.
    """
    there, to_browser = os.pipe()
    from_browser, back = os.pipe()
    flags = [*FLAGS, f"--user-data-dir={profile}"]
    if os.geteuid() == 0:
        flags.append("--no-sandbox")
    numbers = [str(there), str(back)]
    words = [sys.executable, "-c", LAUNCH, *numbers, program, *flags, "about:blank"]
    with (profile / "log").open("wb") as log:
        process = subprocess.Popen(words, pass_fds=(there, back), stdout=log, stderr=log)
    os.close(there)
    os.close(back)
    page = Page(to_browser, from_browser)
    try:
        targets = page.send("Target.getTargets")["targetInfos"]
        target = next(each["targetId"] for each in targets if each["type"] == "page")
        attached = page.send("Target.attachToTarget", targetId=target, flatten=True)
        page.session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            page.send(f"{domain}.enable")
        yield page
    finally:
        page.session = ""
        with suppress(PageError, OSError):
            page.send("Browser.close")
        process.wait(timeout=PATIENCE)
        os.close(to_browser)
        os.close(from_browser)
