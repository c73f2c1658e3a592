"""Commands killed, out of space, refused a disk or started twice: nothing is lost or wrong."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
NAMESPACE = ("unshare", "--user", "--map-root-user", "--mount")
"""Runs a command where it may mount a disk that nobody else sees, and that ends with it."""


def program(name: str, *words: object, before: tuple[str, ...] = ()) -> dict:
    threads = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
    environment = os.environ | dict.fromkeys(threads, "1") | {"LCRL_BENCH_KERNEL": "torch"}
    done = subprocess.run(
        [*before, sys.executable, str(TESTS / f"{name}_program.py"), *map(str, words)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def check_kills(folder: Path, name: str, times: int) -> None:
    found = program("kill", folder, name, times, 0)
    assert found["wrong"] == []
    assert found["same"] == times
    assert found["left"] == []
    assert found["killed"] > times / 2


@pytest.mark.parametrize("name", ["build", "evaluate"])
def test_a_killed_command_ends_in_the_same_bits_when_it_is_run_again(name, tmp_path):
    check_kills(tmp_path, name, 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["import", "build", "train", "evaluate", "reproduce"])
def test_fifty_kills_of_a_command_leave_nothing(name, tmp_path):
    check_kills(tmp_path, name, 50)


@pytest.fixture(scope="module")
def mounts() -> None:
    try:
        there = subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False)
    except OSError:
        pytest.skip("no unshare here, to mount a disk with")
    if there.returncode != 0:
        pytest.skip(f"no disk can be mounted here: {there.stderr.decode()}")


TIGHT = [
    ("build", "home", "full", "No space left on device"),
    ("build", "cache", "read-only", "Read-only file system"),
]
SLOW_TIGHT = [
    (name, disk, fault, reason)
    for name in ("import", "build", "train")
    for disk in ("home", "cache")
    for fault, reason in (
        ("full", "No space left on device"),
        ("read-only", "Read-only file system"),
    )
]


@pytest.mark.usefixtures("mounts")
@pytest.mark.parametrize(("name", "disk", "fault", "reason"), TIGHT)
def test_a_disk_that_takes_nothing_is_named_and_costs_nothing(name, disk, fault, reason, tmp_path):
    check_disk(name, disk, fault, reason, tmp_path)


@pytest.mark.slow
@pytest.mark.usefixtures("mounts")
@pytest.mark.parametrize(("name", "disk", "fault", "reason"), SLOW_TIGHT)
def test_every_command_names_a_disk_that_takes_nothing(name, disk, fault, reason, tmp_path):
    check_disk(name, disk, fault, reason, tmp_path)


def check_disk(name: str, disk: str, fault: str, reason: str, folder: Path) -> None:
    found = program("disk", folder, name, disk, fault, before=NAMESPACE)
    first, second = found["codes"]
    if first != 0:  # A cache may do without.
        # `house import` reports the error of each house.
        assert first == (1 if name == "import" else 4), found["said"]
        assert reason in found["said"]
        assert str(folder / "home") in found["said"]
    else:
        assert disk == "cache"
    assert "internal error" not in found["said"]
    assert not [name for name in found["left"] if ".partial-" in name]
    assert second == 0
    assert found["same"]


@pytest.mark.parametrize("name", ["build"])
def test_a_command_that_is_started_twice_gives_the_same_bits(name, tmp_path):
    check_twins(name, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["import", "train", "evaluate"])
def test_every_command_may_be_started_twice(name, tmp_path):
    check_twins(name, tmp_path)


def check_twins(name: str, folder: Path) -> None:
    found = program("twin", folder, name)
    for code in found["codes"]:
        assert code in (0, 4), found["said"]
    assert 0 in found["codes"]
    if 4 in found["codes"]:
        assert "is being written by process" in found["said"]
    assert found["same"]
    assert found["left"] == []
