"""The House JSON files of a folder given to a command."""

from __future__ import annotations

from pathlib import Path

from lcrl_bench.errors import NothingSelectedError, UsageError


def house_files(folder: Path) -> list[Path]:
    """The House JSON files of a folder: at its top, or under `<id>/house.json`.

    Raises:
        UsageError: If it is not a folder.
        NothingSelectedError: If it has none.
    """
    if not folder.is_dir():
        raise UsageError(f"--houses {folder} is not a folder.")
    files = sorted([*folder.glob("*.json"), *folder.glob("*/house.json")])
    if not files:
        raise NothingSelectedError(
            f"--houses {folder} has no House JSON. Make some with `lcrl-bench house import` or "
            "`lcrl-bench house generate`."
        )
    return files
