"""Small drawings for the page as SVG: bars of failures, a learning curve.

Sizes are attributes, not styles: the page's policy allows no style but its own sheet.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Final

WIDTH: Final = 320
ROW: Final = 22
LABEL: Final = 150
BAR: Final = 120
HEIGHT: Final = 140
LEFT: Final = 8
TOP: Final = 18


def bars(shares: Mapping[str, float | None], *, title: str) -> str:
    """Horizontal bars of shares in per cent, each with its name and figure."""
    rows = []
    for place, (name, share) in enumerate(shares.items()):
        y = place * ROW
        length = BAR * (share or 0.0) / 100
        figure = "–" if share is None else f"{share:.1f}"
        rows.append(
            f'<text x="0" y="{y + 15}">{escape(name)}</text>'
            f'<rect class="rail" x="{LABEL}" y="{y + 5}" width="{BAR}" height="12" rx="2"/>'
            f'<rect class="bar" x="{LABEL}" y="{y + 5}" width="{length:.1f}" height="12" rx="2"/>'
            f'<text x="{LABEL + BAR + 6}" y="{y + 15}">{figure}</text>'
        )
    return _svg(title, len(shares) * ROW, "".join(rows))


def curves(lines: Sequence[Sequence[tuple[float, float]]], *, title: str) -> str:
    """Lines over one another, each a list of (x, y), with the ends of both axes written."""
    points = [point for line in lines for point in line]
    if not points:
        return "<p>No loss was logged.</p>"
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
        f'<text x="{WIDTH - LEFT}" y="{HEIGHT - 4}" text-anchor="end">step {last:g}</text>'
        f'<line class="axis" x1="{LEFT}" x2="{WIDTH - LEFT}" y1="{floor}" y2="{floor}"/>'
    )
    return _svg(title, HEIGHT, drawn + words)


def _svg(title: str, height: int, content: str) -> str:
    label = escape(title)
    return f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{label}">{content}</svg>'
