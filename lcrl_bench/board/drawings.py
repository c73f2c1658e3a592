"""Small drawings for the page as SVG: an interval, bars, learning curves.

Sizes are attributes, not styles: the page's policy allows no style but its own sheet.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Final

WIDTH: Final = 320
ROW: Final = 24
LABEL: Final = 150
BAR: Final = 120
HEIGHT: Final = 150
LEFT: Final = 4
TOP: Final = 20
SPAN: Final = 76
"""Width of an interval's drawing: 0 to 100 per cent, with room for the dot at either end."""


def whisker(mean: float, low: float | None, high: float | None) -> str:
    """A dot on a line from 0 to 100 per cent, over its interval."""

    def at(value: float) -> str:
        return f"{3 + (SPAN - 6) * min(max(value, 0), 100) / 100:.1f}"

    interval = ""
    if low is not None and high is not None:
        interval = f'<line class="interval" x1="{at(low)}" x2="{at(high)}" y1="5" y2="5"/>'
    return (
        f'<svg class="whisker" viewBox="0 0 {SPAN} 10" width="{SPAN}" height="10" '
        f'aria-hidden="true"><line class="rail" x1="3" x2="{SPAN - 3}" y1="5" y2="5"/>'
        f'{interval}<circle cx="{at(mean)}" cy="5" r="2.6"/></svg>'
    )


def bars(shares: Mapping[str, float | None], *, title: str) -> str:
    """Horizontal bars of shares in per cent, each with its name and figure."""
    rows = []
    for place, (name, share) in enumerate(shares.items()):
        y = place * ROW
        length = BAR * (share or 0.0) / 100
        figure = "–" if share is None else f"{share:.1f}"
        rows.append(
            f'<text x="0" y="{y + 16}">{escape(name)}</text>'
            f'<rect class="rail" x="{LABEL}" y="{y + 7}" width="{BAR}" height="10" rx="5"/>'
            f'<rect class="bar" x="{LABEL}" y="{y + 7}" width="{length:.1f}" height="10" rx="5"/>'
            f'<text class="figure" x="{WIDTH}" y="{y + 16}">{figure}</text>'
        )
    return _svg(title, len(shares) * ROW, "".join(rows))


def curves(lines: Sequence[Sequence[tuple[float, float]]], *, title: str) -> str:
    """Lines over one another, each a list of (x, y), with the ends of both axes written."""
    points = [point for line in lines for point in line]
    if not points:
        return '<p class="quiet">No loss was logged.</p>'
    low, high = min(y for _, y in points), max(y for _, y in points)
    last = max(x for x, _ in points) or 1
    span = (high - low) or 1.0

    def place(x: float, y: float) -> str:
        across = LEFT + (WIDTH - 2 * LEFT) * x / last
        down = TOP + (HEIGHT - 2 * TOP) * (high - y) / span
        return f"{across:.1f},{down:.1f}"

    drawn = "".join(
        f'<polyline points="{" ".join(place(x, y) for x, y in line)}"/>' for line in lines
    )
    floor = HEIGHT - TOP
    words = (
        f'<text x="{LEFT}" y="12">{high:.4g}</text>'
        f'<text x="{LEFT}" y="{HEIGHT - 4}">{low:.4g} at the lowest</text>'
        f'<text class="figure" x="{WIDTH - LEFT}" y="{HEIGHT - 4}">step {last:,.0f}</text>'
        f'<line class="rail" x1="{LEFT}" x2="{WIDTH - LEFT}" y1="{floor}" y2="{floor}"/>'
    )
    return _svg(title, HEIGHT, words + drawn)


def _svg(title: str, height: int, content: str) -> str:
    label = escape(title)
    return f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{label}">{content}</svg>'
