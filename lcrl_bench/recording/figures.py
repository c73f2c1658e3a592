"""Matplotlib figures as files: PNG, SVG or PDF, for a light page or a dark one.

Files are written whole, and the same drawing gives the same bytes. A figure is drawn for white
paper. Neutral colours, and the few others that need it to stay legible, have a dark counterpart;
colours that carry data are the same on both.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, Final, Literal, get_args

import matplotlib
from matplotlib.artist import Artist
from matplotlib.collections import Collection
from matplotlib.colors import to_hex, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.text import Text

from lcrl_bench.errors import UsageError
from lcrl_bench.recording.palette import BLACK, BLUE, FAINT, GREY, INK, VERMILION, WALL, hex_color
from lcrl_bench.storage import write_bytes

SUFFIXES: Final = (".pdf", ".png", ".svg")
"""File formats of a picture."""
DOTS_PER_INCH: Final = 160
Theme = Literal["light", "dark", "auto"]
"""`"auto"` is for SVG only: light, or dark if the reader's system prefers that."""
THEMES: Final[tuple[Theme, ...]] = get_args(Theme)
PAPER: Final = "#ffffff"
DARK_PAPER: Final = "#17171b"
DARK_OF: Final[dict[str, str]] = {
    PAPER: DARK_PAPER,
    "#000000": "#e9e9e6",
    INK: "#e9e9e6",
    hex_color(BLACK): "#f4f4f1",
    GREY: "#9b9ba2",
    FAINT: "#3b3b41",
    WALL: "#b4b4ba",
    # Plans without colours: floors, furniture and its edges.
    "#fbfbfa": "#1e1e22",
    "#ececec": "#303036",
    "#a8a8a8": "#6b6b72",
    # Curves: the raw one, and lines too dark for a dark page.
    "#b9cfe0": "#34506b",
    hex_color(BLUE): "#4fa8e0",
    hex_color(VERMILION): "#ec7d31",
}
"""What a colour becomes on a dark page."""
# Names of SVG parts that do not change.
_RC: Final[dict[Any, Any]] = {
    "svg.hashsalt": "lcrl_bench",
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
}


class Halo(withStroke):
    """An outline in the colour of paper, so that what is drawn stands out on any tile."""

    def __init__(self, width: float, color: str = PAPER) -> None:
        """A halo whose stroke is `width` points wide."""
        super().__init__(linewidth=width, foreground=color)
        self.width = width
        self.color = color


def save_figure(path: Path, figure: Figure, theme: Theme | None = None) -> None:
    """Write a figure, atomically.

    Args:
        path: Ends in `.png`, `.svg` or `.pdf`.
        figure: What is drawn, for white paper. `"dark"` recolours it in place.
        theme: The page it is for; None lets an SVG follow its reader, and is light otherwise.

    Raises:
        UsageError: If `path` has another suffix, or a theme is `"auto"` without SVG.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        listing = ", ".join(SUFFIXES)
        raise UsageError(f"{path}: '{path.suffix}' is not a picture. Valid suffixes: {listing}.")
    if theme == "auto" and suffix != ".svg":
        raise UsageError(
            f"{path}: only an .svg follows its reader's theme. Valid here: light, dark."
        )
    write_bytes(path, figure_file(figure, suffix, theme))


def figure_file(figure: Figure, suffix: str = ".png", theme: Theme | None = None) -> bytes:
    """The content of a figure's file; arguments as for `save_figure`."""
    theme = theme or ("auto" if suffix == ".svg" else "light")
    if theme == "dark":
        figure.set_facecolor(DARK_PAPER)
        for artist in figure.findobj():
            _darken(artist)
    # Without a date, the same drawing gives the same bytes.
    undated = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    file = io.BytesIO()
    with matplotlib.rc_context(_RC):
        figure.savefig(
            file,
            format=suffix[1:],
            dpi=DOTS_PER_INCH,
            metadata=undated[suffix],
            facecolor=DARK_PAPER if theme == "dark" else PAPER,
        )
    if theme == "auto":
        return with_dark_style(file.getvalue().decode()).encode()
    return file.getvalue()


def with_dark_style(svg: str) -> str:
    """Make an SVG drawing dark where the reader's system prefers it.

    Programs without style sheets show it light.
    """
    rules = [f"text {{ fill: {DARK_OF['#000000']} }}"]
    for light, dark in DARK_OF.items():
        rules += [
            f'[style*="{use}: {light}"] {{ {use}: {dark} !important }}'
            for use in ("fill", "stroke")
        ]
    style = "@media (prefers-color-scheme: dark) {\n  " + "\n  ".join(rules) + "\n}"
    head, defs, rest = svg.partition("<defs>")
    if not defs:
        raise ValueError("the drawing has no place for a style sheet")
    return f'{head}<defs>\n  <style type="text/css">{style}</style>\n </defs>\n <defs>{rest}'


def _darken(artist: Artist) -> None:
    for effect in artist.get_path_effects() or ():
        if isinstance(effect, Halo):
            effect.__init__(effect.width, _dark(effect.color))
    if isinstance(artist, Text):
        artist.set_color(_dark(artist.get_color()))
        if (box := artist.get_bbox_patch()) is not None:
            _darken(box)
    elif isinstance(artist, Line2D):
        artist.set_color(_dark(artist.get_color()))
        artist.set_markerfacecolor(_dark(artist.get_markerfacecolor()))
        artist.set_markeredgecolor(_dark(artist.get_markeredgecolor()))
    elif isinstance(artist, Patch):
        artist.set_facecolor(_dark(artist.get_facecolor()))
        artist.set_edgecolor(_dark(artist.get_edgecolor()))
    elif isinstance(artist, Collection):
        artist.set_facecolor(_dark_rows(artist.get_facecolor()))
        artist.set_edgecolor(_dark_rows(artist.get_edgecolor()))


def _dark(color: Any) -> Any:  # noqa: ANN401 - whatever matplotlib takes for a colour
    """The dark counterpart of a colour, with the same opacity; itself if it has none."""
    red, green, blue, opacity = to_rgba(color)
    dark = DARK_OF.get(to_hex((red, green, blue)))
    return color if dark is None else (*to_rgb(dark), opacity)


def _dark_rows(colors: Any) -> list[Any]:  # noqa: ANN401 - as matplotlib gives them
    return [_dark(tuple(color)) for color in colors]
