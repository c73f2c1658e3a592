"""A page of the game: the command, the views, the map, messages and a legend."""

from __future__ import annotations

from textwrap import wrap
from typing import Final

from rich.cells import cell_len

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.envs.text_map import HEADING_NAMES
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import HEADINGS, ObjectState
from lcrl_bench.play.canvas import BOLD, PLAIN, Canvas, Style
from lcrl_bench.play.colors import Colors
from lcrl_bench.play.game import Game
from lcrl_bench.play.house_map import HouseMap
from lcrl_bench.play.panorama import (
    class_letters,
    classes_in_sight,
    join_views,
    lettered,
    resized,
)
from lcrl_bench.recording.palette import BLACK, SKY, VERMILION, YELLOW, class_colors

SMALLEST: Final = (60, 20)
"""Columns and rows below which not everything fits."""
HELP: Final = "↑←→ wad  space take/put  r again  n next  v way  p auto  m map  g goal  q quit"
_ASCII: Final = str.maketrans("↑←→", "^<>")
_MAP_ROWS: Final = 12
"""Rows that the map gets before the views grow."""
_OTHER_ROWS: Final = 4
"""Rows that are neither views nor map."""
_TITLE_COLUMNS: Final = 16
"""Columns that a view needs for its name to fit."""
_WHERE: Final = {
    ObjectState.AT_A: "at A",
    ObjectState.HELD: "in your hand",
    ObjectState.AT_B: "at B",
}
_LEGEND: Final = 19
"""Columns per entry of the legend."""


class Page:
    """Draws a game; keeps the layout of the last house."""

    def __init__(self, colors: Colors) -> None:
        """Take what the terminal can show."""
        self._colors = colors
        self._map: tuple[tuple[TaskSet, int, int], HouseMap] | None = None

    def lines(self, game: Game, columns: int, rows: int) -> list[str]:
        """The page for a terminal of this size."""
        canvas = Canvas(rows, columns)
        self._title(canvas, game)
        top = self._views(canvas, game)
        space = rows - top - 1
        house = self._house(game, columns, space)
        sheet = house.draw(
            game.walk.states,
            colors=self._colors,
            floor=None if game.layer is None else game.layer.colors[_map_layer(game)],
            marks=game.marks,
        )
        first = house.window(game.walk.states, space)
        canvas.paste(sheet, top, 0, first=first, rows=space)
        self._panel(canvas, game, top, house.columns + 3, space)
        small = columns < SMALLEST[0] or rows < SMALLEST[1]
        text = f"{columns} x {rows} is small: 80 x 24 shows everything" if small else HELP
        canvas.write(rows - 1, 0, text.translate(_ASCII) if self._plain else text)
        return canvas.lines(self._colors)

    @property
    def _plain(self) -> bool:
        return self._colors == Colors.PLAIN

    def _title(self, canvas: Canvas, game: Game) -> None:
        walk, task = game.walk, game.walk.played.task
        canvas.write(0, 0, task.command, BOLD)
        count = len(game.playlist)
        place = f"{task.house}, {task.split.value}, {game.number % count + 1} of {count}"
        left = canvas.columns - len(place)
        if left > cell_len(task.command) + 2:
            canvas.write(0, left, place)
        words = [f"step {walk.steps} of {walk.horizon}", f"in the {walk.room}", _facing(game)]
        if walk.object_state is not None:
            words.append(f"the {walk.object_name} is {_WHERE[walk.object_state]}")
        canvas.write(1, 0, ", ".join(words))

    def _views(self, canvas: Canvas, game: Game) -> int:
        """The four views and their names; returns the row below."""
        walk = game.walk
        _, heading, _ = walk.played.place(walk.state)
        picture = join_views(walk.played.panorama(walk.state), heading)
        rows, columns = _fit(picture.shape[0], picture.shape[1], canvas.rows, canvas.columns)
        left = (canvas.columns - columns) // 2
        if self._plain:
            for k, line in enumerate(lettered(resized(picture, rows, columns))):
                canvas.write(2 + k, left, line)
        else:
            small = resized(picture, 2 * rows, columns)
            canvas.picture(2, left, class_colors()[small])
        self._name_views(canvas, 2 + rows, left, columns, heading)
        return 3 + rows

    def _name_views(self, canvas: Canvas, row: int, left: int, columns: int, heading: int) -> None:
        names = (("left", 1, -1), ("right", 3, 1), ("behind", 0, 2), ("behind", 4, 2))
        quarter = columns // HEADINGS
        for name, place, turn in names if quarter >= _TITLE_COLUMNS else ():
            text = name if place in (0, 4) else f"{name}: {_compass(heading + turn)}"
            middle = left + round((place - 0.5) * quarter) + quarter // 2
            start = {0: left, 4: left + columns - len(text)}.get(place, middle - len(text) // 2)
            canvas.write(row, start, text)
        text = f"ahead: {_compass(heading)}"
        start = left + columns // 2 - quarter // 2
        framed = f"[{text:^{quarter - 2}}]" if self._plain else f"{text:^{quarter}}"
        canvas.write(row, start, framed, Style(BLACK, YELLOW, bold=True))

    def _panel(self, canvas: Canvas, game: Game, top: int, left: int, rows: int) -> None:
        """Messages, then the legend of what is in sight."""
        row, width = top, max(canvas.columns - left, 1)
        for text, style in _messages(game):
            for line in wrap(text, width, break_long_words=False, break_on_hyphens=False):
                if row < top + rows:
                    canvas.write(row, left, line, style)
                row += 1
        self._legend(canvas, game, row + 1, left, top + rows)

    def _legend(self, canvas: Canvas, game: Game, top: int, left: int, bottom: int) -> None:
        rows, columns = bottom - top, max((canvas.columns - left) // _LEGEND, 1)
        classes, colors = semantic_classes(), class_colors()
        seen = classes_in_sight(game.walk.played.panorama(game.walk.state))
        for k, (number, _) in enumerate(seen[: max(rows, 0) * columns]):
            row, column = top + k % rows, left + k // rows * _LEGEND
            red, green, blue = colors[number].tolist()
            mark = f"{class_letters()[number]} " if self._plain else "  "
            canvas.write(row, column, mark, Style(paper=(red, green, blue)))
            canvas.write(row, column + 3, classes[number].words[: _LEGEND - 4])

    def _house(self, game: Game, columns: int, rows: int) -> HouseMap:
        """The map, as large as it fits beside the legend."""
        one = game.walk.played
        key = (one, columns, rows)
        if self._map is None or self._map[0] != key:
            large = HouseMap(one, scale=2)
            fits = large.rows <= rows and large.columns + 2 * _LEGEND <= columns
            self._map = (key, large if fits else HouseMap(one))
        return self._map[1]


def _messages(game: Game) -> list[tuple[str, Style]]:
    """Messages, most urgent first."""
    walk = game.walk
    lines: list[tuple[str, Style]] = []
    if walk.over:
        lines.append((_ending(game), Style(SKY if walk.reached else VERMILION, bold=True)))
    elif not walk.goal_known:
        lines.append(('success can\'t be checked: use "go to X" or "move X to Y"', PLAIN))
    elif walk.steps == 0:
        lines.append((_shortest_way(game), PLAIN))
    if game.message and not (walk.over and walk.reached):
        lines.append((game.message, BOLD))
    elif walk.in_reach and not walk.over:
        lines.append((f"space: {walk.in_reach}", BOLD))
    advice = None if game.guide is None else game.guide.advice(walk)
    if game.guide is not None and advice is not None:
        mode = "walks" if game.autoplay else "says"
        lines.append((f"{game.guide.name} {mode}: {walk.phrase(advice)}", PLAIN))
    if game.layer is not None:
        low, high = game.layer.limits
        lines.append((f"map: {game.layer.name}, red {low:.3g} to blue {high:.3g}", PLAIN))
    return lines


def _shortest_way(game: Game) -> str:
    if game.shortest < 0:
        return "no way leads there in time"
    return f"the shortest way takes {game.shortest} steps"


def _ending(game: Game) -> str:
    walk = game.walk
    if walk.reached:
        best = (
            "the shortest way"
            if walk.steps == game.shortest
            else f"the shortest way takes {game.shortest}"
        )
        return f"goal reached in {walk.steps} steps, {best}"
    shortest = f"; the shortest way takes {game.shortest}" if game.shortest >= 0 else ""
    return f"no steps left{shortest}: r again, n next task"


def _fit(rows: int, columns: int, page_rows: int, page_columns: int) -> tuple[int, int]:
    """Rows and columns of the views: as large as leaves room for a map."""
    most = max(page_rows - _OTHER_ROWS - _MAP_ROWS, 4)
    width = min(page_columns // HEADINGS * HEADINGS, columns)
    height = round(rows / 2 * width / columns)
    if height > most:
        height = most
        width = min(width, round(most * 2 * columns / rows) // HEADINGS * HEADINGS)
    return height, width


def _map_layer(game: Game) -> int:
    """The layer of a map for the object's current state."""
    held = game.walk.object_state
    return 0 if held is None else int(held)


def _facing(game: Game) -> str:
    return f"facing {HEADING_NAMES[game.walk.played.place(game.walk.state)[1]]}"


def _compass(heading: int) -> str:
    return HEADING_NAMES[heading % HEADINGS]
