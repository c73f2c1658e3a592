"""House sources by name, and house files recognised by content.

Other packages add a source through the entry-point group `lcrl_bench.house_sources`, whose values
are importers: a function from a path to an `ImportedHouse`.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.registry import Registry
from lcrl_bench.storage import MAX_HOUSE_BYTES, read_json

Importer = Callable[[Path], ImportedHouse]

PROCEDURAL = "procedural"
"""The one source that generates houses from a seed instead of reading files."""

ENTRY_POINTS = "lcrl_bench.house_sources"
"""Entry-point group through which other packages add sources."""

FORMATS = {
    "lcrl": "House JSON of this suite (a key 'format' that is 'lcrl-house')",
    "procthor": "ProcTHOR / AI2-THOR house JSON, schema 1.0.0 ('rooms', 'walls' and 'objects')",
}
"""Source → how its files are recognised."""


def house_sources() -> Registry[Any]:
    """The registry of house sources: `"procedural"` is a generator, all others are importers."""
    sources: Registry[Any] = Registry("house source")
    sources.register(
        PROCEDURAL,
        "lcrl_bench.houses.procedural:generate_house",
        summary="houses generated from a seed",
    )
    sources.register(
        "procthor",
        "lcrl_bench.houses.procthor:import_procthor",
        summary="ProcTHOR / AI2-THOR house JSON, schema 1.0.0",
    )
    sources.register(
        "lcrl",
        "lcrl_bench.houses.document:import_lcrl",
        summary="House JSON, this suite's own format",
    )
    for entry in entry_points(group=ENTRY_POINTS):
        sources.register(entry.name, entry.value, summary=f"from the package {_package(entry)}")
    return sources


def _package(entry: Any) -> str:  # noqa: ANN401 - importlib.metadata.EntryPoint has no typed dist
    return entry.dist.name if entry.dist is not None else "unknown"


def detect_source(path: Path) -> str:
    """Detect a file's format by its content, and return the name of its source.

    Raises:
        InvalidFileError: If the file can't be read or its format is unknown; lists the formats.
    """
    path = Path(path)
    value = read_json(path, max_bytes=MAX_HOUSE_BYTES)
    keys = set(value) if isinstance(value, dict) else set()
    if "format" in keys and isinstance(value["format"], str) and value["format"] == "lcrl-house":
        return "lcrl"
    if {"rooms", "walls"} <= keys and keys & {"objects", "doors", "proceduralParameters"}:
        return "procthor"
    known = "; ".join(FORMATS.values())
    found = f"an object with the keys {sorted(keys)[:8]}" if keys else f"a {_kind(value)}"
    reason = f"not a house in a known format: it holds {found[:200]}"
    raise InvalidFileError(path, reason, fix=f"Known formats: {known}.")


def _kind(value: object) -> str:
    names = {dict: "empty object", list: "list", str: "string", type(None): "null"}
    return names.get(type(value), "number or truth value")


def import_house(path: str | Path, *, source: str | None = None) -> ImportedHouse:
    """Read a house file of any known format.

    Args:
        path: The file.
        source: Name of the source to read it as; None to recognise it by its content.

    Raises:
        InvalidFileError: If the file is not a house in a known format, or is a broken one.
        UnknownNameError: If there is no source called so.
        UsageError: If the source makes houses and reads no files.

    Example:
        >>> from pathlib import Path
        >>> from lcrl_bench.houses import write_house
        >>> write_house(Path("house.json"), lcrl_bench.generate_house(7))
        >>> imported = lcrl_bench.import_house("house.json")
        >>> imported.house.id, imported.label_coverage
        ('procedural-7', 1.0)
    """
    path = Path(path)
    name = source if source is not None else detect_source(path)
    if name == PROCEDURAL:
        raise UsageError(f"The source '{name}' generates houses; it can't read {path}.")
    importer: Importer = house_sources().get(name)
    return importer(path)
