"""Type, size and class of ProcTHOR's models, by asset id.

Source: `assets/taxonomies/procthor_assets.csv`, derived from ProcTHOR's asset database. An asset id
is only a key into that table: it is never parsed, and never used as a path.
"""

from __future__ import annotations

import csv
import hashlib
import statistics
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from lcrl_bench.houses.house import Vector
from lcrl_bench.houses.taxonomy import FALLBACK, load_taxonomy

SOURCE = "procthor"
"""Name of this house source and of its taxonomy."""


@dataclass(frozen=True)
class Model:
    """A model of the asset database."""

    type: str
    """ProcTHOR's object type: `"DiningTable"`."""
    size: Vector
    """(width, depth, height) of its box."""
    shape: int
    """Its index among the models of its type."""


@dataclass(frozen=True)
class Identity:
    """Class and size of an object in a house file."""

    label: str
    """Class name."""
    size: Vector
    """(width, depth, height) of its unrotated box."""
    shape: int
    source_label: str
    mapped: bool
    """Whether the taxonomy knows the source's label; if not, `label` is the fallback class."""
    measured: bool
    """Whether the size is the model's own; if not, it is typical of the class."""


@lru_cache(maxsize=1)
def models() -> dict[str, Model]:
    """All models of the asset database, by asset id."""
    file = resources.files("lcrl_bench.assets").joinpath("taxonomies", "procthor_assets.csv")
    table: dict[str, Model] = {}
    shapes: dict[str, int] = {}
    for row in csv.DictReader(file.read_text("utf-8").splitlines()):
        kind = row["objectType"]
        size = (float(row["width"]), float(row["depth"]), float(row["height"]))
        shape = shapes[kind] = shapes.get(kind, -1) + 1
        table[row["assetId"]] = Model(kind, size, shape)
    return table


def identify(asset: str, stated_type: str | None) -> Identity:
    """Identify an object by its asset id, or else by the type its file states."""
    taxonomy = load_taxonomy(SOURCE)
    model = models().get(asset)
    if model is not None:
        label = taxonomy.classify(model.type)
        return Identity(label or FALLBACK, model.size, model.shape, model.type, bool(label), True)
    source_label = stated_type or asset
    label = taxonomy.classify(stated_type) if stated_type else None
    # An asset has the same shape wherever it occurs, even if nothing else is known about it.
    shape = int(hashlib.sha256(asset.encode()).hexdigest()[:4], 16)
    size = typical_size(label or FALLBACK)
    return Identity(label or FALLBACK, size, shape, source_label, label is not None, False)


@lru_cache(maxsize=128)
def typical_size(label: str) -> Vector:
    """The median (width, depth, height) of a class's models; of all models if it has none."""
    taxonomy = load_taxonomy(SOURCE)
    sizes = [model.size for model in models().values() if taxonomy.classify(model.type) == label]
    columns = zip(*(sizes or [model.size for model in models().values()]), strict=True)
    width, depth, height = (statistics.median(column) for column in columns)
    return width, depth, height
