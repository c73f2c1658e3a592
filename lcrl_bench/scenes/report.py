"""Writes a house as a folder, with a report to read before using it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.scenes.export import export_scene
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics


def write_house_folder(
    imported: ImportedHouse, folder: Path, semantics: Semantics = DEFAULT_SEMANTICS
) -> tuple[dict[str, Any], Grid]:
    """Write `house.json` and `scene/scene.xml`, and report on the house.

    Nothing is written until the grid and the scene have been built, so an unusable house leaves no
    partial folder behind.

    Args:
        imported: The house and its import report.
        folder: Where to write; created if missing.
        semantics: Size of tiles and agent.

    Returns:
        The row of `lcrl-bench house import --json`, and the grid.

    Raises:
        LcrlError: If no agent can stand in the house, or the scene does not compile.
    """
    house = imported.house
    grid = build_grid(house, semantics)
    scene = export_scene(house, folder / "scene", semantics)
    write_house(folder / "house.json", house)
    row = {
        "id": house.id,
        "source": house.source,
        "rooms": len(house.rooms),
        "objects": len(house.objects),
        "tiles": grid.report.tiles_free,
        "reachable": grid.report.tiles_reachable,
        "rooms_missed": list(grid.report.rooms_missed),
        "grid": list(grid.report.measures),
        "classes": len({thing.label for thing in house.objects}),
        "unmapped": list(imported.unmapped),
        "label_coverage": imported.label_coverage,
        "notes": list(imported.notes),
        "house": str(folder / "house.json"),
        "mjcf": str(scene),
        "errors": [],
    }
    return row, grid
