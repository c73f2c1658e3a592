"""Figures on white paper, on a dark page, or (SVG) as the reader's system prefers.

A figure is drawn for white paper. Neutral colours, and the few that need it to be read, have a dark
counterpart; colours that carry data are the same on both.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final, Literal, get_args

from matplotlib.artist import Artist
from matplotlib.collections import Collection
from matplotlib.colors import to_hex, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.text import Text

from lcrl_bench.recording.palette import BLACK, BLUE, FAINT, GREY, INK, VERMILION, WALL, hex_color

Theme = Literal["light", "dark", "auto"]
"""`"auto"` is for SVG alone: light, and dark where the reader's system prefers it."""
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
    # Of plans without colours: floors, furniture and its edges.
    "#fbfbfa": "#1e1e22",
    "#ececec": "#303036",
    "#a8a8a8": "#6b6b72",
    # Of curves: the raw one, and lines too dark for a dark page.
    "#b9cfe0": "#34506b",
    hex_color(BLUE): "#4fa8e0",
    hex_color(VERMILION): "#ec7d31",
}
"""What a colour becomes on a dark page."""


class Halo(withStroke):
    """A line of paper round what is drawn, so that it stands out on any tile."""

    def __init__(self, width: float, color: str = PAPER) -> None:
        """A halo whose outer line is `width` points wide."""
        super().__init__(linewidth=width, foreground=color)
        self.width = width
        self.color = color


def theme_of(path: Path, theme: Theme | None) -> Theme:
    """The theme asked for; None means what a reader of the file's format wants."""
    return theme or ("auto" if path.suffix.lower() == ".svg" else "light")


def darken(figure: Figure) -> None:
    """Recolour all that is on a figure for a dark page, in place."""
    figure.set_facecolor(DARK_PAPER)
    for artist in figure.findobj():
        _darken(artist)


def with_dark_style(svg: str) -> str:
    """An SVG drawing that is dark where the reader's system prefers it, and light elsewhere.

    Programs that know no style sheets show it light.
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
    """The dark counterpart of a colour, as transparent as it was; itself where it has none."""
    red, green, blue, opacity = to_rgba(color)
    dark = DARK_OF.get(to_hex((red, green, blue)))
    return color if dark is None else (*to_rgb(dark), opacity)


def _dark_rows(colors: Any) -> list[Any]:  # noqa: ANN401 - as matplotlib gives them
    return [_dark(tuple(color)) for color in colors]
