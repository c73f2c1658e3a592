"""The House JSON files of a folder a command is given."""

from __future__ import annotations

from pathlib import Path

from lcrl_bench.errors import NothingSelectedError, UsageError


def house_files(folder: Path) -> list[Path]:
    """The House JSON files of a folder: at its top, or under `<id>/house.json`.

    Raises:
        UsageError: If it is no folder.
        NothingSelectedError: If it holds none.
    """
    if not folder.is_dir():
        raise UsageError(f"--houses {folder} is no folder.")
    files = sorted([*folder.glob("*.json"), *folder.glob("*/house.json")])
    if not files:
        raise NothingSelectedError(
            f"--houses {folder} holds no House JSON. Make some with `lcrl-bench house import` or "
            "`lcrl-bench house generate`."
        )
    return files
