"""The content of a benchmark folder, verified at once and parsed on first use.

The fingerprint covers parsed content. For files as `write_benchmark` leaves them, it follows from
their JSON without validating a single house: a command that looks at one house of a thousand
parses one. What is parsed later must still have the digest that was verified.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from pydantic_core import from_json

from lcrl_bench.benchmarks.benchmark import content_fingerprint
from lcrl_bench.errors import IntegrityError, LcrlError
from lcrl_bench.houses.document import json_digest
from lcrl_bench.semantics import Semantics
from lcrl_bench.storage import MAX_HOUSE_BYTES, canonical_json, read_bytes, sha256_of

REBUILD = "Build the benchmark again, or fetch it again."


@dataclass(frozen=True)
class HouseFacts:
    """What is known of a house before it is parsed."""

    house: str
    """Digest of the house."""
    grid: str
    """Digest of its grid."""
    rooms: frozenset[str]
    """Ids of its rooms."""
    objects: frozenset[str]
    """Ids of its objects."""
    tiles: int


@dataclass(frozen=True)
class FolderContent:
    """The content of a benchmark folder before it is parsed."""

    houses: Mapping[str, HouseFacts]
    grids: Mapping[str, bytes]
    """Each grid's file without spaces: canonical JSON, if it is as `write_benchmark` leaves it."""
    tasks: bytes
    """`tasks.json`."""

    def fingerprint(self, semantics: Semantics, vocabulary: Sequence[str]) -> str:
        """The benchmark's, if every file is as `write_benchmark` leaves it; else no benchmark's."""
        digests = {name: each.house for name, each in self.houses.items()}
        tasks = canonical_json(from_json(self.tasks)["tasks"])
        return content_fingerprint(semantics, digests, self.grids, tasks, vocabulary)


def house_file(folder: Path, house: str) -> Path:
    """Where a benchmark folder keeps a house."""
    return folder / "houses" / f"{house}.json"


def grid_file(folder: Path, house: str) -> Path:
    """Where a benchmark folder keeps the grid of a house."""
    return folder / "grids" / f"{house}.json"


def read_content(folder: Path, houses: Sequence[str]) -> FolderContent | None:
    """Read a benchmark folder without validating it.

    Args:
        folder: The folder.
        houses: Ids of its houses.

    Returns:
        None if a file is missing, or is not of the right form: validating it tells why.
    """
    facts, grids = {}, {}
    try:
        for name in houses:
            house = from_json(read_bytes(house_file(folder, name), max_bytes=MAX_HOUSE_BYTES))
            grid = read_bytes(grid_file(folder, name))
            # Only a rare string would change; the digest of what is parsed tells.
            grids[name] = grid.strip().replace(b", ", b",").replace(b'": ', b'":')
            facts[name] = HouseFacts(
                json_digest(house),
                sha256_of(grids[name]),
                frozenset(room["id"] for room in house["rooms"]),
                frozenset(thing["id"] for thing in house["objects"]),
                len(from_json(grid)["cells"]),
            )
        return FolderContent(facts, grids, read_bytes(folder / "tasks.json"))
    except (LcrlError, ValueError, TypeError, LookupError):
        return None


_Value = TypeVar("_Value")


class LazyMapping(Mapping[str, _Value], Generic[_Value]):
    """Values that are read from a file each, on first use, and kept."""

    def __init__(
        self,
        files: Mapping[str, Path],
        digests: Mapping[str, str],
        read: Callable[[Path], _Value],
        digest: Callable[[_Value], str],
    ) -> None:
        """Store the arguments; nothing is read yet.

        Args:
            files: The file of each value.
            digests: What `digest` must give of each.
            read: Reads a value.
            digest: SHA-256 of a value.
        """
        self._files, self._digests = files, digests
        self._read, self._digest = read, digest
        self._kept: dict[str, _Value] = {}

    def __getitem__(self, name: str) -> _Value:
        """The value.

        Raises:
            KeyError: If there is none.
            InvalidFileError: If its file is missing or invalid.
            IntegrityError: If its file has changed, or never held a valid value in full.
        """
        if name not in self._kept:
            path, expected = self._files[name], self._digests[name]
            value = self._read(path)
            found = self._digest(value)
            if found != expected:
                raise IntegrityError(path, expected, found, fix=REBUILD)
            self._kept[name] = value
        return self._kept[name]

    def __iter__(self) -> Iterator[str]:
        """The names, in order."""
        return iter(self._files)

    def __len__(self) -> int:
        """Number of values."""
        return len(self._files)

    def __repr__(self) -> str:
        """The names."""
        return f"LazyMapping({', '.join(self._files)})"

    def __contains__(self, name: object) -> bool:
        """Whether there is such a value; reads nothing."""
        return name in self._files
