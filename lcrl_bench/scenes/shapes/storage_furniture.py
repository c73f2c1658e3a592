"""Dressers, wardrobes, shelves and television stands."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.houses.receptacles import face_shares
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import (
    carcass,
    count_of,
    front_planes,
    fronts,
    handles,
    inset,
    knobs,
    legs,
    renamed,
    spans,
    split,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Span,
    box,
)


def drawer_dresser(size: Vector) -> list[Part]:
    """A chest of drawers on a plinth, with bar handles."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, plinth = min(0.03, 0.08 * size[2]), min(0.06, 0.1 * size[2])
    columns, rows = count_of(size[0], 0.8, 3), count_of(size[2], 0.26, 4, least=2)
    drawers = fronts(inset(x, 0.02 * size[0]), (plinth, z[1] - board), (body, face), columns, rows,
                     tints.WOOD, name="drawer")  # fmt: skip
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.WOOD),
        carcass(inset(x, 0.01 * size[0]), (y[0], body), (plinth, z[1] - board), tints.DARK_WOOD),
        box("plinth", inset(x, 0.03 * size[0]), (y[0] + 0.02 * size[1], body - 0.04 * size[1]),
            (0.0, plinth), tints.DARK_WOOD),
        *drawers,
        *handles(drawers, (face, grip), tints.BRASS),
    ]  # fmt: skip


def leggy_dresser(size: Vector) -> list[Part]:
    """A chest of drawers on tapered legs, with round knobs."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, leg = min(0.025, 0.08 * size[2]), min(0.18, 0.22 * size[2])
    columns = count_of(size[0], 0.9, 2)
    rows = count_of(size[2] - leg, 0.25, 4, least=2)
    drawers = fronts(inset(x, 0.03 * size[0]), (leg, z[1] - board), (body, face), columns, rows,
                     tints.PAINT, name="drawer")  # fmt: skip
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.LIGHT_WOOD),
        carcass(inset(x, 0.01 * size[0]), (y[0], body), (leg, z[1] - board), tints.LIGHT_WOOD),
        *legs(inset(x, 0.03 * size[0]), (y[0] + 0.03 * size[1], body), (0.0, leg),
              min(0.05, 0.1 * size[0], 0.1 * size[1]), tints.LIGHT_WOOD, taper=0.5),
        *drawers,
        *knobs(drawers, (face, grip), tints.BRASS),
    ]  # fmt: skip


def sideboard(size: Vector) -> list[Part]:
    """Doors beside a stack of drawers."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, plinth = min(0.03, 0.08 * size[2]), min(0.08, 0.12 * size[2])
    rise = (plinth, z[1] - board)
    doors = fronts(within(x, 0.02, 0.64), rise, (body, face), 2, 1, tints.WOOD, name="door")
    drawers = fronts(within(x, 0.65, 0.98), rise, (body, face), 1, 3, tints.WOOD, name="drawer")
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.DARK_WOOD),
        carcass(inset(x, 0.01 * size[0]), (y[0], body), rise, tints.DARK_WOOD),
        *legs(inset(x, 0.02 * size[0]), (y[0], body), (0.0, plinth),
              min(0.06, 0.1 * size[0], 0.15 * size[1]), tints.DARK_WOOD, taper=0.7),
        *doors,
        *drawers,
        *[renamed(part, "door-") for part in handles(doors, (face, grip), tints.STEEL,
                                                      upright=True)],
        *handles(drawers, (face, grip), tints.STEEL),
    ]  # fmt: skip


def door_wardrobe(size: Vector) -> list[Part]:
    """Tall hinged doors with upright handles, a plinth and a cornice."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    cornice, plinth = min(0.06, 0.05 * size[2]), min(0.08, 0.06 * size[2])
    doors = fronts(inset(x, 0.02 * size[0]), (plinth, z[1] - cornice), (body, face),
                   count_of(size[0], 0.5, 4, least=2), 1, tints.WOOD, name="door")  # fmt: skip
    return [
        box("cornice", x, (y[0], face + 0.5 * (grip - face)), (z[1] - cornice, z[1]),
            tints.DARK_WOOD),
        carcass(inset(x, 0.012 * size[0]), (y[0], body), (plinth, z[1] - cornice),
                 tints.DARK_WOOD),
        box("plinth", inset(x, 0.02 * size[0]), (y[0], body - 0.03 * size[1]), (0.0, plinth),
            tints.DARK_WOOD),
        *doors,
        *handles(doors, (face, grip), tints.BRASS, upright=True),
    ]  # fmt: skip


def sliding_wardrobe(size: Vector) -> list[Part]:
    """Two sliding doors, one of them a mirror, between rails."""
    x, y, z = spans(size)
    body, face, rail = front_planes(size)
    edge = min(0.05, 0.06 * size[2])
    board = min(0.03, 0.05 * size[0])
    rise, inner = inset(z, edge), inset(x, board)
    middle = 0.5 * (body + face)
    return [
        carcass(inset(x, 0.2 * board), (y[0], body), inset(z, 0.2 * edge), tints.LIGHT_WOOD),
        box("side-left", (x[0], x[0] + board), (y[0], rail), z, tints.LIGHT_WOOD),
        box("side-right", (x[1] - board, x[1]), (y[0], rail), z, tints.LIGHT_WOOD),
        box("rail-top", inner, (body, rail), (z[1] - edge, z[1] - 0.1 * edge), tints.STEEL),
        box("rail-bottom", inner, (body, rail), (0.1 * edge, edge), tints.STEEL),
        box("door-rear", within(inner, 0.48, 1), (body, middle), rise, tints.PAINT),
        box("door-front", within(inner, 0, 0.52), (middle, face), rise, tints.LIGHT_WOOD),
        box("mirror", within(inner, 0.03, 0.49), (face, face + 0.3 * (rail - face)),
            within(rise, 0.02, 0.98), tints.GLASS),
    ]  # fmt: skip


def armoire(size: Vector) -> list[Part]:
    """Two panelled doors above drawers, on feet."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    cornice, foot = min(0.08, 0.06 * size[2]), min(0.1, 0.07 * size[2])
    low = foot + 0.24 * size[2]
    doors = fronts(inset(x, 0.03 * size[0]), (low, z[1] - cornice), (body, face), 2, 1,
                   tints.PAINT, name="door")  # fmt: skip
    drawers = fronts(inset(x, 0.03 * size[0]), (foot, low), (body, face),
                     count_of(size[0], 0.8, 2), 2, tints.PAINT, name="drawer")  # fmt: skip
    return [
        box("cornice", x, y, (z[1] - cornice, z[1]), tints.PAINT),
        carcass(inset(x, 0.02 * size[0]), (y[0], body), (foot, z[1] - cornice), tints.PAINT),
        *legs(inset(x, 0.02 * size[0]), (y[0], body), (0.0, foot),
              min(0.1, 0.15 * size[0], 0.15 * size[1]), tints.PAINT, taper=0.7),
        *doors,
        *drawers,
        *[renamed(part, "door-") for part in handles(doors, (face, grip), tints.IRON,
                                                      upright=True)],
        *knobs(drawers, (face, grip), tints.IRON),
    ]  # fmt: skip


def _levels(size: Vector) -> list[Span]:
    """The z spans of a shelf's boards; their upper faces match `receptacles.toml`."""
    board = min(0.03, 0.06 * size[2])
    return [(share * size[2] - board, share * size[2]) for share in face_shares("shelf")]


def bookcase(size: Vector) -> list[Part]:
    """A bookcase: sides, a back and boards."""
    x, y, _ = spans(size)
    board = min(0.025, 0.06 * size[0])
    boards, inner = _levels(size), inset(x, board)
    back = (y[0], y[0] + min(0.015, 0.06 * size[1]))
    return [
        box("side-left", (x[0], x[0] + board), y, (0.0, boards[-1][0]), tints.WOOD),
        box("side-right", (x[1] - board, x[1]), y, (0.0, boards[-1][0]), tints.WOOD),
        box("top", x, y, boards[-1], tints.WOOD),
        box("back", inner, back, (0.0, boards[-1][0]), tints.DARK_WOOD),
        *[box(f"board-{k + 1}", inner, (back[1], y[1] - 0.01 * size[1]), level, tints.WOOD)
          for k, level in enumerate(boards[:-1])],
        box("floor", inner, (back[1], y[1] - 0.02 * size[1]), within((0.0, boards[0][0]), 0, 0.2),
            tints.WOOD),
    ]  # fmt: skip


def rack_shelf(size: Vector) -> list[Part]:
    """An open rack: four steel posts and boards."""
    x, y, _ = spans(size)
    post = min(0.035, 0.08 * size[0], 0.1 * size[1])
    boards = _levels(size)
    low = within((0.0, boards[0][0]), 0.25, 0.4)
    return [
        *legs(x, y, (0.0, boards[-1][0]), post, tints.IRON),
        box("top", x, y, boards[-1], tints.LIGHT_WOOD),
        *[box(f"board-{k + 1}", inset(x, 0.3 * post), inset(y, 0.3 * post), level,
              tints.LIGHT_WOOD) for k, level in enumerate([low, *boards[:-1]])],
    ]  # fmt: skip


def cabinet_shelf(size: Vector) -> list[Part]:
    """Open boards above a cupboard with doors."""
    x, y, _ = spans(size)
    body, face, grip = front_planes(size)
    board = min(0.03, 0.06 * size[0])
    boards, inner = _levels(size), inset(x, board)
    doors = fronts(inset(x, 0.01 * size[0]), (0.02 * size[2], boards[0][0]), (body, face),
                   2, 1, tints.PAINT, name="door")  # fmt: skip
    upper = (boards[0][1], boards[-1][0])
    return [
        box("case", inset(x, 0.1 * board), (y[0], body), (0.0, boards[0][0]), tints.PAINT),
        box("counter", x, y, boards[0], tints.WOOD),
        *doors,
        *handles(doors, (face, grip), tints.IRON, upright=True),
        box("side-left", (x[0], x[0] + board), (y[0], face), upper, tints.PAINT),
        box("side-right", (x[1] - board, x[1]), (y[0], face), upper, tints.PAINT),
        box("back", inner, (y[0], y[0] + 0.06 * size[1]), upper, tints.PAINT),
        box("top", x, y, boards[-1], tints.WOOD),
        *[box(f"board-{k + 1}", inner, (y[0] + 0.06 * size[1], face), level, tints.PAINT)
          for k, level in enumerate(boards[1:-1])],
    ]  # fmt: skip


def media_tv_stand(size: Vector) -> list[Part]:
    """A low board: doors at the ends and an open bay for players in the middle."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, foot = min(0.03, 0.1 * size[2]), min(0.08, 0.15 * size[2])
    rise = (foot, z[1] - board)
    left, right = within(x, 0.01, 0.33), within(x, 0.67, 0.99)
    doors = [
        *fronts(left, rise, (body, face), 1, 1, tints.LIGHT_WOOD, name="door-left"),
        *fronts(right, rise, (body, face), 1, 1, tints.LIGHT_WOOD, name="door-right"),
    ]
    middle = within(x, 0.33, 0.67)
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.WOOD),
        box("case-left", left, (y[0], body), rise, tints.WOOD),
        box("case-right", right, (y[0], body), rise, tints.WOOD),
        box("bay-floor", middle, (y[0] + 0.05 * size[1], face), within(rise, 0, 0.1), tints.WOOD),
        box("bay-shelf", middle, (y[0] + 0.05 * size[1], body), within(rise, 0.5, 0.58),
            tints.WOOD),
        box("bay-back", middle, (y[0], y[0] + 0.05 * size[1]), rise, tints.DARK_WOOD),
        *doors,
        *knobs(doors, (face, grip), tints.IRON),
        *legs(inset(x, 0.04 * size[0]), (y[0] + 0.05 * size[1], body), (0.0, foot),
              min(0.05, 0.08 * size[0], 0.12 * size[1]), tints.WOOD, taper=0.6),
    ]  # fmt: skip


def drawer_tv_stand(size: Vector) -> list[Part]:
    """A low chest of wide drawers below an open slot."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, plinth = min(0.03, 0.1 * size[2]), min(0.05, 0.1 * size[2])
    low = plinth + 0.55 * size[2]
    drawers = fronts(inset(x, 0.01 * size[0]), (plinth, low), (body, face),
                     count_of(size[0], 0.7, 3), 1, tints.DARK_WOOD, name="drawer")  # fmt: skip
    posts = [within(x, 0.01, 0.04), within(x, 0.485, 0.515), within(x, 0.96, 0.99)]
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.DARK_WOOD),
        carcass(inset(x, 0.005 * size[0]), (y[0], body), (plinth, low), tints.DARK_WOOD),
        box("plinth", inset(x, 0.03 * size[0]), (y[0], body - 0.05 * size[1]), (0.0, plinth),
            tints.IRON),
        *[box(f"post-{k + 1}", span, (y[0] + 0.02 * size[1], body), (low, z[1] - board),
              tints.DARK_WOOD) for k, span in enumerate(posts)],
        *drawers,
        *handles(drawers, (face, grip), tints.STEEL),
    ]  # fmt: skip


def open_tv_stand(size: Vector) -> list[Part]:
    """A metal frame with a top and two open shelves."""
    x, y, z = spans(size)
    post, board = min(0.03, 0.06 * size[0], 0.1 * size[1]), min(0.03, 0.1 * size[2])
    shelves = split((0.08 * size[2], 0.72 * size[2]), 2, 0.64 * size[2] - 2 * board)
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.WOOD),
        *legs(inset(x, 0.1 * post), inset(y, 0.1 * post), (0.0, z[1] - board), post, tints.IRON),
        *[box(f"shelf-{k + 1}", inset(x, 0.4 * post), inset(y, 0.4 * post), level, tints.WOOD)
          for k, level in enumerate(shelves)],
    ]  # fmt: skip
