"""`ImportedHouse`: a house from a file, with what importing it changed or could not name."""

from __future__ import annotations

from dataclasses import dataclass

from lcrl_bench.houses.house import House


@dataclass(frozen=True)
class ImportedHouse:
    """A house read from a file, and the report of reading it."""

    house: House
    """Valid: it has passed `houses.validation.validate_house`."""
    unmapped: tuple[str, ...]
    """Labels of the source that the taxonomy does not know, sorted, each once; their objects
    carry a fallback class."""
    label_coverage: float
    """Share of the source's objects, those on furniture included, whose label the taxonomy maps
    to one of the 61 classes (not by fallback); 0..1, and 1 for a house without objects."""
    notes: tuple[str, ...]
    """What was repaired, assumed or left out, a sentence each."""
