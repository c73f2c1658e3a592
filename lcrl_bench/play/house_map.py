"""The house from above, with 2 x 1 or 4 x 2 letters per tile and walls on the edges.

A wall to the east is a thin bar in a tile's last letter, a wall to the south underlines the tile;
in plain letters that is a maze of `_` and `|`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.color import blend_rgb, parse_rgb_hex
from rich.color_triplet import ColorTriplet

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.envs.text_map import ARROWS, BOTH, FREE, TAKE, tile_letters
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.play.canvas import Canvas, Style
from lcrl_bench.play.colors import Colors
from lcrl_bench.play.furniture import Place, furniture_colors
from lcrl_bench.recording import palette
from lcrl_bench.recording.palette import AGENT, BLACK, WHITE, Color
from lcrl_bench.recording.plan import ROOM_TINTS

POINTERS: Final = "▲▶▼◀"
"""The agent, facing north, east, south, west."""
BAR: Final = "\N{RIGHT ONE EIGHTH BLOCK}"
TRAIL: Final = "·"
WALL: Final[Color] = (74, 74, 80)
_EAST, _SOUTH = 1, 2
_MARK_SHARE: Final = 0.6
"""Share of a mark's colour in the floor of the tiles it marks."""
_CONTRAST: Final = 2.2
"""Factor on the distance of room tints from white where there are few colours."""


class HouseMap:
    """The map of a house: laid out once, drawn anew with the agent, the task and colours."""

    def __init__(self, one: TaskSet, *, scale: int = 1) -> None:
        """Lay out the house of a task.

        Args:
            one: The task.
            scale: Rows per tile; each row has twice as many letters.
        """
        self._one, self._scale = one, scale
        self._grid = grid = one.scene.grid
        (west, south), (east, north) = grid.cells.min(axis=0), grid.cells.max(axis=0)
        self._corner = (int(west), int(north))
        self._size = (int(north - south) + 1, int(east - west) + 1)
        self._places: list[Place] = [self._place(*cell) for cell in grid.cells.tolist()]
        self._fill = furniture_colors(one.scene.house, self._empty())

    @property
    def rows(self) -> int:
        """Rows of the whole map."""
        return self._size[0] * self._scale

    @property
    def columns(self) -> int:
        """Letters per row."""
        return self._size[1] * self._scale * 2

    def draw(
        self,
        states: Sequence[int],
        *,
        colors: Colors,
        floor: NDArray[np.uint8] | None = None,
        marks: bool = True,
    ) -> Canvas:
        """Draw the map.

        Args:
            states: All states of the walk so far.
            colors: Plain letters have walls of their own.
            floor: uint8 [tile, 3], a colour per tile; None means that of the room.
            marks: Whether to show where the goal is.
        """
        sheet, plain = Canvas(self.rows, self.columns), colors == Colors.PLAIN
        for place, color in self._fill.items():
            self._block(sheet, place, "#" if plain else " ", Style(WALL, color))
        here, heading, held = self._one.place(states[-1])
        letters = tile_letters(self._one) if marks else [FREE] * self._one.tiles
        for tile, letter in enumerate(letters):
            paper = self._paper(tile, letter, colors, floor)
            shown = letter if plain or floor is not None else FREE
            self._tile(sheet, tile, shown, AGENT if tile == here else paper, plain=plain)
        if floor is None and not plain:
            self._name_rooms(sheet)
        for state in states[:-1]:
            self._mark(sheet, self._one.place(state)[0], "." if plain else TRAIL)
        if marks:
            self._draw_things(sheet, held)
        self._mark(sheet, here, (ARROWS if plain else POINTERS)[heading])
        return sheet

    def window(self, states: Sequence[int], rows: int) -> int:
        """The first row to show where not all fit: the agent is in the middle."""
        middle = self._middle(self._places[self._one.place(states[-1])[0]])[0]
        return min(max(middle - rows // 2, 0), max(self.rows - rows, 0))

    def _paper(
        self, tile: int, letter: str, colors: Colors, floor: NDArray[np.uint8] | None
    ) -> Color:
        if floor is not None:
            return ColorTriplet(*floor[tile].tolist())
        tint = self._tint(tile, colors)
        return tint if letter == FREE else blend_rgb(tint, _mark_color(letter), _MARK_SHARE)

    def _tint(self, tile: int, colors: Colors) -> ColorTriplet:
        code = ROOM_TINTS[self._one.scene.house.room(self._grid.rooms[tile]).type]
        factor = _CONTRAST if colors == Colors.INDEXED else 1.0
        return blend_rgb(ColorTriplet(*WHITE), parse_rgb_hex(code.removeprefix("#")), factor)

    def _tile(self, sheet: Canvas, tile: int, letter: str, paper: Color, *, plain: bool) -> None:
        """A tile's floor, its walls and its role in the task."""
        place = self._places[tile]
        top, left = place[0] * self._scale, place[1] * self._scale * 2
        last = (self._scale - 1, self._scale * 2 - 1)
        east, south = (int(self._grid.neighbours[tile, side]) < 0 for side in (_EAST, _SOUTH))
        for row in range(self._scale):
            under = south and row == last[0]
            style = Style(WALL, paper, underline=under)
            for column in range(self._scale * 2):
                text = "_" if under and plain else " "
                if east and column == last[1]:
                    text = "|" if plain else BAR
                sheet.write(top + row, left + column, text, style)
        if letter != FREE:
            self._mark(sheet, tile, letter)

    def _block(self, sheet: Canvas, place: Place, letter: str, style: Style) -> None:
        """A place where the agent can't stand."""
        for row in range(self._scale):
            text = letter * (self._scale * 2)
            sheet.write(place[0] * self._scale + row, place[1] * self._scale * 2, text, style)

    def _mark(self, sheet: Canvas, tile: int, letter: str) -> None:
        """A dark letter on whatever is there."""
        row, column = self._middle(self._places[tile])
        sheet.write(row, column, letter, sheet.style(row, column)._replace(ink=BLACK, bold=True))

    def _name_rooms(self, sheet: Canvas) -> None:
        """Write the use of each room into one of its rows, as far in the middle as it fits."""
        rooms = np.array(self._grid.rooms)
        for room in self._one.scene.house.rooms:
            runs = self._runs(np.flatnonzero(rooms == room.id))
            name = room.type.value
            fitting = [run for run in runs if len(run) * self._scale * 2 > len(name)]
            if not fitting:
                continue
            centre = float(np.mean([place[0] for run in runs for place in run]))
            run = min(fitting, key=lambda run: abs(run[0][0] - centre))
            row, column = self._middle(run[0])[0], run[0][1] * self._scale * 2
            column += (len(run) * self._scale * 2 - len(name)) // 2
            for k, letter in enumerate(name):
                sheet.write(row, column + k, letter, sheet.style(row, column + k))

    def _runs(self, tiles: NDArray[np.int64]) -> list[list[Place]]:
        """Adjacent tiles with no wall between, from west to east."""
        runs: list[list[Place]] = []
        for tile in sorted(tiles.tolist(), key=lambda tile: self._places[tile]):
            row, column = self._places[tile]
            joined = bool(runs) and runs[-1][-1] == (row, column - 1)
            if joined and self._joined(self._places.index((row, column - 1)), tile):
                runs[-1].append((row, column))
            else:
                runs.append([(row, column)])
        return runs

    def _joined(self, west: int, east: int) -> bool:
        return int(self._grid.neighbours[west, _EAST]) == east

    def _draw_things(self, sheet: Canvas, held: ObjectState) -> None:
        """Letters A and B where the object of PICK lies and is to lie, filled where it is now."""
        task = self._one.task
        if task.moved is None:
            return
        _, placement = task.carried()
        found = self._one.scene.house.object(task.moved)
        for letter, thing, color, there in (
            ("A", found, palette.TAKE, ObjectState.AT_A),
            ("B", placement, palette.GOAL, ObjectState.AT_B),
        ):
            at = (np.array(thing.position[:2]) - self._grid.origin) / self._grid.tile + 0.5
            column, row = np.floor(at).astype(int).tolist()
            ink, paper = (WHITE, color) if held == there else (color, WHITE)
            sheet.write(*self._middle(self._place(column, row)), letter, Style(ink, paper, True))

    def _place(self, column: int, row: int) -> Place:
        """Where a cell of the grid is on the map, in tiles from its upper left corner."""
        return self._corner[1] - row, column - self._corner[0]

    def _middle(self, place: Place) -> tuple[int, int]:
        """The row and column of the letter in the middle of a tile."""
        down, across = (self._scale - 1) // 2, self._scale - 1
        return place[0] * self._scale + down, place[1] * self._scale * 2 + across

    def _empty(self) -> dict[Place, tuple[float, float]]:
        """Where there is no tile, and the middle of it in metres."""
        (x, y), side, taken = self._grid.origin, self._grid.tile, set(self._places)
        west, north = self._corner
        return {
            (down, across): (x + (west + across) * side, y + (north - down) * side)
            for down in range(self._size[0])
            for across in range(self._size[1])
            if (down, across) not in taken
        }


def _mark_color(letter: str) -> ColorTriplet:
    take, goal = ColorTriplet(*palette.TAKE), ColorTriplet(*palette.GOAL)
    if letter == BOTH:
        return blend_rgb(take, goal)
    return take if letter == TAKE else goal
