"""Caches go where the user says, else to the user's cache folder, else to a temporary one."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import cache_dir


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary folder of the test's own, and no word of the user on caches."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    for name in ("LCRL_BENCH_HOME", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    (tmp_path / "home").mkdir()
    return folder


def test_the_users_word_comes_first(
    temporary: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    assert cache_dir() == tmp_path / "home" / ".cache" / "lcrl_bench"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_dir() == tmp_path / "xdg" / "lcrl_bench"
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "named"))
    assert cache_dir() == tmp_path / "named"


def test_an_empty_variable_is_no_word(
    temporary: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setenv("LCRL_BENCH_HOME", "")
    assert cache_dir() == tmp_path / "home" / ".cache" / "lcrl_bench"


@pytest.mark.parametrize("home", ["file", "nowhere"])
def test_without_a_usable_home_it_is_a_private_temporary_folder(
    home: str, temporary: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "file").write_text("a file is in the way")
    monkeypatch.setenv("HOME", {"file": str(tmp_path / "file"), "nowhere": "~"}[home])
    folder = cache_dir()
    assert folder == temporary / f"lcrl_bench-{os.getuid()}"
    assert folder.stat().st_mode & 0o777 == 0o700
    assert cache_dir() == folder


@pytest.mark.skipif(os.getuid() == 0, reason="root may write into every folder")
def test_a_home_that_cant_be_written_is_no_usable_home(temporary: Path, tmp_path: Path):
    (tmp_path / "home").chmod(0o555)
    assert cache_dir().parent == temporary


def test_a_planted_temporary_folder_is_refused(
    temporary: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("HOME", "~")
    (temporary / f"lcrl_bench-{os.getuid()}").symlink_to(tmp_path)
    with pytest.raises(EnvironmentMissingError, match="LCRL_BENCH_HOME"):
        cache_dir()
