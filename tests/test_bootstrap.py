"""`scripts/bootstrap.sh` finds a Python by itself, and installs no more than was asked for.

The script is the real one, in a copy of the checkout whose project is tiny and whose dependencies
are two empty wheels beside it, so that no network is needed.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import textwrap
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[1]
TOOLS = ("cat", "cksum", "dirname", "ls", "rm", "sh", "sleep")
PROJECT = """
[build-system]
requires = []
build-backend = "backend"
backend-path = ["."]
"""
BACKEND = """
import zipfile

def build_editable(folder, config_settings=None, metadata_directory=None):
    name = "tiny-1.0-py3-none-any.whl"
    with zipfile.ZipFile(f"{folder}/{name}", "w") as wheel:
        for path, text in FILES.items():
            wheel.writestr(f"tiny-1.0.dist-info/{path}", text)
    return name
"""
WHEEL = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
EXTRAS = "".join(
    f"Provides-Extra: {extra}\nRequires-Dist: needed-by-{extra}; extra == '{extra}'\n"
    for extra in ("fast", "dev")
)
REAL = f'exec "{sys.executable}" "$@"'
"""The body of a program that is this very interpreter."""
SHIM = "echo 'pyenv: this version is not installed' >&2; exit 127"
TOO_OLD = "echo 3.10"


def files_of(name: str, more: str = "") -> dict[str, str]:
    metadata = f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n{more}"
    return {"METADATA": metadata, "WHEEL": WHEEL, "RECORD": ""}


@dataclass(frozen=True)
class Checkout:
    """A folder with the script, and a PATH with programs of one's own choice."""

    folder: Path

    def program(self, name: str, body: str) -> None:
        path = self.folder / "bin" / name
        path.write_text(f"#!/bin/sh\n{body}\n")
        path.chmod(0o755)

    def run(self, extra: str = "dev", **variables: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["sh", "scripts/bootstrap.sh", ".venv", extra],
            cwd=self.folder,
            env={
                "PATH": str(self.folder / "bin"),
                "HOME": str(self.folder),
                "PIP_CONFIG_FILE": os.devnull,
                "PIP_NO_INDEX": "1",
                "PIP_FIND_LINKS": str(self.folder / "wheels"),
                **variables,
            },
            capture_output=True,
            text=True,
        )

    def installed(self) -> set[str]:
        names = (path.name for path in (self.folder / ".venv").rglob("needed_by_*.dist-info"))
        return {name.removeprefix("needed_by_").partition("-")[0] for name in names}


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    for name in ("bin", "scripts", "wheels"):
        (tmp_path / name).mkdir()
    for tool in TOOLS:
        (tmp_path / "bin" / tool).symlink_to(str(shutil.which(tool)))
    shutil.copy(REPOSITORY / "scripts" / "bootstrap.sh", tmp_path / "scripts")
    shutil.copy(REPOSITORY / "constraints.txt", tmp_path)
    (tmp_path / "pyproject.toml").write_text(textwrap.dedent(PROJECT))
    (tmp_path / "backend.py").write_text(f"FILES = {files_of('tiny', EXTRAS)!r}\n{BACKEND}")
    for extra in ("fast", "dev"):
        name = f"needed_by_{extra}-1.0"
        with zipfile.ZipFile(tmp_path / "wheels" / f"{name}-py3-none-any.whl", "w") as wheel:
            for path, text in files_of(f"needed-by-{extra}").items():
                wheel.writestr(f"{name}.dist-info/{path}", text)
    return Checkout(tmp_path)


def test_the_first_python_that_runs_and_is_new_enough_is_taken(checkout: Checkout):
    checkout.program("python3", TOO_OLD)
    checkout.program("python3.14", SHIM)
    checkout.program("python3.13", "echo 3.13t")
    checkout.program("python3.12", REAL)
    done = checkout.run("fast")
    assert done.returncode == 0, done.stderr
    assert checkout.installed() == {"fast"}


def test_a_python_that_makes_no_environment_is_passed_over(checkout: Checkout):
    checkout.program("python3", f'case "$1" in -c) {REAL} ;; *) exit 1 ;; esac')
    checkout.program("python3.11", REAL)
    done = checkout.run("fast")
    assert done.returncode == 0, done.stderr


def test_a_demo_then_tests_upgrade_and_neither_is_installed_twice(checkout: Checkout):
    checkout.program("python3", REAL)
    assert checkout.run("fast").returncode == 0
    assert checkout.installed() == {"fast"}
    assert "Installing" in checkout.run("dev").stderr
    assert checkout.installed() == {"fast", "dev"}
    for extra in ("fast", "dev"):
        again = checkout.run(extra)
        assert (again.returncode, again.stderr) == (0, "")
    # Without what it was made with, too: an environment needs its own interpreter only.
    checkout.program("python3", SHIM)
    assert checkout.run("fast").stderr == ""
    checkout.folder.joinpath("constraints.txt").write_text("")
    assert "Installing" in checkout.run("fast").stderr


def test_an_environment_of_an_unsupported_python_is_made_again(checkout: Checkout):
    checkout.program("python3", REAL)
    assert checkout.run("fast").returncode == 0
    python = checkout.folder / ".venv" / "bin" / "python"
    python.unlink()
    python.write_text(f"#!/bin/sh\n{TOO_OLD}\n")
    python.chmod(0o755)
    done = checkout.run("fast")
    assert done.returncode == 0, done.stderr
    assert python.is_symlink()


def refuse_without_any(checkout: Checkout) -> dict[str, str]:
    return {}


def refuse_an_old_one(checkout: Checkout) -> dict[str, str]:
    checkout.program("python3", TOO_OLD)
    return {}


def refuse_what_is_named(checkout: Checkout) -> dict[str, str]:
    checkout.program("python3", REAL)
    checkout.program("mine", TOO_OLD)
    return {"PYTHON": "mine"}


def refuse_one_without_venv(checkout: Checkout) -> dict[str, str]:
    checkout.program("python3", f'case "$1" in -c) {REAL} ;; *) exit 1 ;; esac')
    return {}


@pytest.mark.parametrize(
    ("arrange", "said"),
    [
        (refuse_without_any, "needs Python 3.11 to 3.14; install one"),
        (refuse_an_old_one, "found python3 is 3.10: install one"),
        (refuse_what_is_named, "found mine is 3.10"),
        (refuse_one_without_venv, "apt-get install python3-venv"),
    ],
)
def test_one_line_says_what_to_do_where_no_python_will_do(
    checkout: Checkout, arrange: Callable[[Checkout], dict[str, str]], said: str
):
    done = checkout.run("fast", **arrange(checkout))
    assert done.returncode == 4
    (line,) = done.stderr.splitlines()
    assert said in line
    assert "make PYTHON=/path/to/python" in line
    assert not (checkout.folder / ".venv").exists()


def test_a_folder_that_is_no_environment_is_left_as_it_is(checkout: Checkout):
    checkout.program("python3", REAL)
    precious = checkout.folder / ".venv" / "thesis.tex"
    precious.parent.mkdir()
    precious.write_text("mine")
    done = checkout.run("fast")
    assert done.returncode == 4
    assert "no virtual environment" in done.stderr
    assert precious.read_text() == "mine"


def test_an_installation_that_failed_is_tried_again(checkout: Checkout):
    checkout.program("python3", REAL)
    (wheel,) = (checkout.folder / "wheels").glob("needed_by_fast*")
    aside = wheel.rename(checkout.folder / wheel.name)
    failed = checkout.run("fast")
    assert failed.returncode == 4
    assert "goes on where it stopped" in failed.stderr
    aside.rename(wheel)
    assert checkout.run("fast").returncode == 0
    assert checkout.installed() == {"fast"}
