"""A matplotlib figure as a file: PNG, SVG or PDF, written whole, and the same every time."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import matplotlib
from matplotlib.figure import Figure

from lcrl_bench.errors import UsageError
from lcrl_bench.recording.theme import DARK_PAPER, PAPER, Theme, darken, with_dark_style
from lcrl_bench.storage import atomic_path

SUFFIXES: Final = (".pdf", ".png", ".svg")
"""File formats a picture can have."""
DOTS_PER_INCH: Final = 160
# The same drawing gives the same file: no date, and names of SVG parts that do not change.
_RC: Final[dict[Any, Any]] = {
    "svg.hashsalt": "lcrl_bench",
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
}


def save_figure(path: Path, figure: Figure, theme: Theme = "light") -> None:
    """Write a figure, atomically.

    Args:
        path: Ends in `.png`, `.svg` or `.pdf`.
        figure: What is drawn, for white paper. `"dark"` recolours it in place.
        theme: The page it is for.

    Raises:
        UsageError: If the suffix of `path` is another one, or a theme is `"auto"` without SVG.
    """
    if path.suffix.lower() not in SUFFIXES:
        listing = ", ".join(SUFFIXES)
        raise UsageError(f"{path}: '{path.suffix}' is no picture. Valid suffixes: {listing}.")
    if theme == "auto" and path.suffix.lower() != ".svg":
        raise UsageError(
            f"{path}: only an .svg follows its reader's theme. Valid for it: light, dark."
        )
    if theme == "dark":
        darken(figure)
    # Without a date, the same drawing gives the same bytes.
    undated = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with matplotlib.rc_context(_RC), atomic_path(path) as temporary:
        figure.savefig(
            temporary,
            dpi=DOTS_PER_INCH,
            metadata=undated[path.suffix.lower()],
            facecolor=DARK_PAPER if theme == "dark" else PAPER,
        )
        if theme == "auto":
            drawn = Path(temporary)
            drawn.write_text(with_dark_style(drawn.read_text("utf-8")), "utf-8")
