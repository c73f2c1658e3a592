"""`ImportedHouse`: a house read from a file, with an import report."""

from __future__ import annotations

from dataclasses import dataclass

from lcrl_bench.houses.house import House


@dataclass(frozen=True)
class ImportedHouse:
    """A house read from a file, and its import report."""

    house: House
    """The house, which has passed `houses.validation.validate_house`."""
    unmapped: tuple[str, ...]
    """Distinct source labels that the taxonomy does not know, sorted; their objects get a fallback
    class."""
    label_coverage: float
    """Share of the source's objects, including those on furniture, whose label the taxonomy maps
    to one of the 61 classes (fallbacks don't count); 0..1, and 1 for a house without objects."""
    notes: tuple[str, ...]
    """What was repaired, assumed or left out, one sentence each."""
