"""Houses (typed rooms, walls with openings, placed labelled objects) and their sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.houses.classes import class_id as class_id
    from lcrl_bench.houses.classes import semantic_classes as semantic_classes
    from lcrl_bench.houses.document import house_digest as house_digest
    from lcrl_bench.houses.document import read_house as read_house
    from lcrl_bench.houses.document import write_house as write_house
    from lcrl_bench.houses.house import House as House
    from lcrl_bench.houses.house import PlacedObject as PlacedObject
    from lcrl_bench.houses.house import Room as Room
    from lcrl_bench.houses.house import RoomType as RoomType
    from lcrl_bench.houses.house import Wall as Wall
    from lcrl_bench.houses.imported import ImportedHouse as ImportedHouse
    from lcrl_bench.houses.procedural.generate import generate_house as generate_house
    from lcrl_bench.houses.sources import detect_source as detect_source
    from lcrl_bench.houses.sources import house_sources as house_sources
    from lcrl_bench.houses.sources import import_house as import_house
    from lcrl_bench.houses.validation import validate_house as validate_house
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "class_id": ".classes",
            "semantic_classes": ".classes",
            "house_digest": ".document",
            "read_house": ".document",
            "write_house": ".document",
            "House": ".house",
            "PlacedObject": ".house",
            "Room": ".house",
            "RoomType": ".house",
            "Wall": ".house",
            "ImportedHouse": ".imported",
            "generate_house": ".procedural.generate",
            "detect_source": ".sources",
            "house_sources": ".sources",
            "import_house": ".sources",
            "validate_house": ".validation",
        },
    )
