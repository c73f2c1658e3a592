"""`measure` and `judge`: the figures of a set of houses, each with its band and verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from lcrl_bench.errors import UsageError
from lcrl_bench.houses.house import House
from tools.house_statistics.arrangement import measure_arrangement
from tools.house_statistics.belongings import measure_belongings
from tools.house_statistics.furnishing import measure_furnishing
from tools.house_statistics.navigation import measure_navigation
from tools.house_statistics.reference import Band, reference
from tools.house_statistics.structure import measure_structure
from tools.house_statistics.view import Figure, Figures, view_house

Verdict = Literal["ok", "differs", "none"]
"""Within its band, outside it, or nothing to measure."""
ROUNDING: Final = 1e-9
"""How far outside its band a figure may be."""


@dataclass(frozen=True)
class Finding:
    """A figure, its band and the verdict."""

    check: int
    name: str
    value: float | None
    low: float | None
    high: float | None
    verdict: Verdict
    note: str
    """The items out of tolerance; empty if the figure is within its band."""
    reason: str
    """Why it may differ; empty if it is within its band."""

    @property
    def band(self) -> str:
        """The band in words."""
        if self.low is not None and self.high is not None:
            both = self.low == self.high
            return f"{self.low:g}" if both else f"{self.low:g} to {self.high:g}"
        return f">= {self.low:g}" if self.low is not None else f"<= {self.high:g}"


def measure(houses: Sequence[House]) -> Figures:
    """All figures of a set of houses, by name; deterministic.

    Raises:
        UsageError: If there is no house.
    """
    if not houses:
        raise UsageError("There is no house to measure; give at least one.")
    views = [view_house(house) for house in houses]
    return {
        **measure_structure(views),
        **measure_furnishing(views),
        **measure_arrangement(views),
        **measure_navigation(views),
        **measure_belongings(views),
    }


def judge(figures: Figures) -> tuple[Finding, ...]:
    """Compare figures with their bands, in the order of the checks."""
    return tuple(_find(band, figures[band.name]) for band in reference().bands)


def _find(band: Band, figure: Figure) -> Finding:
    verdict = _verdict(band, figure.value)
    differs = verdict == "differs"
    return Finding(
        band.check,
        band.name,
        figure.value,
        band.low,
        band.high,
        verdict,
        figure.note if differs else "",
        band.reason if differs else "",
    )


def _verdict(band: Band, value: float | None) -> Verdict:
    if value is None:
        return "none"
    above = band.low is None or value >= band.low - ROUNDING
    below = band.high is None or value <= band.high + ROUNDING
    return "ok" if above and below else "differs"
