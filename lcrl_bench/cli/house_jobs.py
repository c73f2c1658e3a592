"""Importing and generating houses as jobs: one per house, each writes the house's folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.jobs.job import Job
from lcrl_bench.storage import writing

Tell = Callable[[float], None]


def import_house_job(path: Path, source: str | None, name: str, out: Path) -> Job:
    """Importing the house `name` from a file into `out/name`."""
    arguments = {"path": str(path), "source": source, "out": str(out)}
    written = _written(out / name)
    return Job(str(path), f"{__name__}:import_one", arguments, inputs=(path,), outputs=written)


def generate_house_job(seed: int, rooms: int | None, name: str, out: Path) -> Job:
    """Generating the house `name` from a seed into `out/name`."""
    arguments = {"seed": seed, "rooms": rooms, "out": str(out)}
    return Job(f"seed {seed}", f"{__name__}:generate_one", arguments, outputs=_written(out / name))


def import_one(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of `import_house_job`: the row of the report."""
    from lcrl_bench.houses.sources import import_house

    imported = import_house(Path(arguments["path"]), source=arguments["source"])
    return _write(imported, Path(arguments["out"]))


def generate_one(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of `generate_house_job`: the row of the report."""
    from lcrl_bench.houses.procedural import generate_house

    house = generate_house(arguments["seed"], rooms=arguments["rooms"])
    return _write(ImportedHouse(house, (), 1.0, ()), Path(arguments["out"]))


def _written(folder: Path) -> tuple[Path, ...]:
    return folder / "house.json", folder / "scene" / "scene.xml", folder / "plan.png"


def _write(imported: ImportedHouse, out: Path) -> dict[str, Any]:
    from lcrl_bench.recording.pictures import house_picture
    from lcrl_bench.scenes.report import write_house_folder

    folder = out / imported.house.id
    # On a full disk, the mesh writer doesn't name its file.
    with writing(folder):
        row, grid = write_house_folder(imported, folder)
    house_picture(folder / "plan.png", imported.house, grid)
    return row
