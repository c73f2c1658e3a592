"""The shapes of each class, and the two functions that return an object's meshes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import (
    appliances,
    bathroom,
    beds,
    cabinets,
    decor,
    fittings,
    heating,
    keepsakes,
    lamps,
    screens,
    seating,
    small_appliances,
    storage_furniture,
    tables,
    tableware,
    toys,
)
from lcrl_bench.scenes.shapes.hulls import hollow_hulls
from lcrl_bench.scenes.shapes.primitives import Part, place

Builder = Callable[[Vector], list[Part]]
"""Makes parts that fill a box of this size, standing on z = 0, centred in x and y."""

_SHAPES: Final[dict[str, tuple[Builder, ...]]] = {
    "door": (fittings.panelled_door, fittings.flush_door, fittings.glazed_door),
    "stairs": (fittings.closed_stairs, fittings.open_stairs),
    "column": (fittings.round_column, fittings.square_column),
    "curtain": (fittings.parted_curtain, fittings.drawn_curtain, fittings.tied_curtain),
    "rug": (fittings.bordered_rug, fittings.round_rug, fittings.fringed_rug),
    "pillow": (beds.square_pillow, beds.round_pillow, beds.bolster),
    "bed": (beds.platform_bed, beds.posted_bed, beds.box_bed),
    "sofa": (seating.box_sofa, seating.rolled_sofa, seating.slim_sofa),
    "armchair": (seating.club_armchair, seating.wooden_armchair, seating.tub_armchair),
    "chair": (
        seating.slat_chair,
        seating.upholstered_chair,
        seating.swivel_chair,
        seating.carver_chair,
    ),
    "stool": (seating.round_stool, seating.square_stool, seating.bar_stool),
    "bench": (seating.plank_bench, seating.padded_bench, seating.chest_bench),
    "dining_table": (tables.four_leg_table, tables.trestle_table, tables.pedestal_table),
    "coffee_table": (tables.shelf_table, tables.sled_table, tables.round_coffee_table),
    "side_table": (tables.nightstand, tables.shelf_table, tables.tripod_table),
    "desk": (tables.drawer_desk, tables.writing_desk, tables.frame_desk),
    "dresser": (
        storage_furniture.drawer_dresser,
        storage_furniture.leggy_dresser,
        storage_furniture.sideboard,
    ),
    "wardrobe": (
        storage_furniture.door_wardrobe,
        storage_furniture.sliding_wardrobe,
        storage_furniture.armoire,
    ),
    "base_cabinet": (
        cabinets.door_base_cabinet,
        cabinets.drawer_base_cabinet,
        cabinets.plain_base_cabinet,
    ),
    "wall_cabinet": (
        cabinets.door_wall_cabinet,
        cabinets.glazed_wall_cabinet,
        cabinets.open_wall_cabinet,
    ),
    "shelf": (
        storage_furniture.bookcase,
        storage_furniture.rack_shelf,
        storage_furniture.cabinet_shelf,
    ),
    "tv_stand": (
        storage_furniture.media_tv_stand,
        storage_furniture.drawer_tv_stand,
        storage_furniture.open_tv_stand,
    ),
    "countertop": (
        cabinets.door_countertop,
        cabinets.drawer_countertop,
        cabinets.waterfall_countertop,
    ),
    "refrigerator": (
        appliances.two_door_refrigerator,
        appliances.french_refrigerator,
        appliances.rounded_refrigerator,
    ),
    "stove": (appliances.ring_stove, appliances.glass_stove),
    "dishwasher": (appliances.panel_dishwasher, appliances.steel_dishwasher),
    "microwave": (appliances.button_microwave, appliances.dial_microwave),
    "washing_machine": (appliances.front_washing_machine, appliances.top_washing_machine),
    "television": (screens.footed_television, screens.pedestal_television),
    "coffee_machine": (
        small_appliances.drip_coffee_machine,
        small_appliances.espresso_machine,
        small_appliances.capsule_machine,
    ),
    "sink": (bathroom.pedestal_sink, bathroom.vanity_sink, bathroom.kitchen_sink),
    "toilet": (bathroom.close_coupled_toilet, bathroom.closed_toilet),
    "bathtub": (bathroom.panelled_bathtub, bathroom.standing_bathtub),
    "shower": (bathroom.corner_shower, bathroom.walk_in_shower),
    "mirror": (bathroom.framed_mirror, bathroom.round_mirror),
    "heater_ac": (heating.radiator, heating.air_conditioner, heating.fan_heater),
    "lamp": (lamps.shade_lamp, lamps.tripod_lamp, lamps.reading_lamp),
    "picture": (decor.framed_picture, decor.canvas_picture, decor.gallery_picture),
    "plant": (decor.leafy_plant, decor.bushy_plant, decor.cactus),
    "trash_can": (decor.open_bin, decor.pedal_bin, decor.swing_bin, decor.open_square_bin),
    "small_object": (decor.lidded_box, decor.jar, decor.remote_control, decor.basket),
    "cup": (tableware.mug, tableware.tea_cup, tableware.tumbler),
    "laptop": (screens.silver_laptop, screens.black_laptop),
    "fruit_bowl": (tableware.fruit_bowl, tableware.footed_fruit_bowl, tableware.banana_bowl),
    "vase": (tableware.amphora_vase, tableware.flower_vase, tableware.globe_vase),
    "pan": (tableware.frying_pan, tableware.saucepan, tableware.wok),
    "kettle": (tableware.stove_kettle, tableware.jug_kettle),
    "bottle": (tableware.wine_bottle, tableware.water_bottle, tableware.squat_bottle),
    "book": (keepsakes.closed_book, keepsakes.book_stack, keepsakes.open_book),
    "plate": (tableware.round_plate, tableware.banded_plate, tableware.square_plate),
    "clock": (keepsakes.alarm_clock, keepsakes.mantel_clock, keepsakes.ring_clock),
    "cellphone": (screens.smartphone, screens.button_phone),
    "candle": (keepsakes.pillar_candle, keepsakes.tapered_candle, keepsakes.jar_candle),
    "toy": (toys.teddy_bear, toys.toy_ball, toys.toy_car, toys.toy_blocks),
    "toaster": (small_appliances.slot_toaster, small_appliances.long_toaster),
}


def shaped_labels() -> tuple[str, ...]:
    """Names of the classes that have shapes, in order of their ids."""
    return tuple(_SHAPES)


def shape_count(label: str) -> int:
    """Number of different shapes of the class `label`.

    Raises:
        UnknownNameError: If it has none.
    """
    return len(_builders(label))


@lru_cache(maxsize=4096)
def object_parts(label: str, size: Vector, shape: int = 0) -> tuple[Part, ...]:
    """The meshes of an object.

    Args:
        label: Class name.
        size: Width, depth and height of its box in metres, all positive.
        shape: Index of the class's shape, modulo `shape_count`.

    Returns:
        Watertight parts in the object's frame (centred on its box, facing +y) whose union fills
        the box exactly. The arrays are shared and read-only.

    Raises:
        UnknownNameError: If the class has no shapes.
        UsageError: If a side of the box is not a positive number.
    """
    builders = _builders(label)
    if not all(math.isfinite(side) and side > 0 for side in size):
        raise UsageError(f"A {label} can't have the size {size}: all sides must be above 0 m.")
    return _fitted(builders[shape % len(builders)](size), size)


@lru_cache(maxsize=4096)
def collision_parts(label: str, size: Vector, shape: int = 0) -> tuple[Part, ...]:
    """Convex parts that together cover `object_parts`; same frame and arguments.

    A part that is not convex is replaced by its hulls, named after it: `"basin.1"`.

    Raises:
        UnknownNameError: If the class has no shapes.
        UsageError: If a side of the box is not a positive number.
        IntegrityError: If a hull file is not the one made for the shape.
    """
    parts = []
    for part in object_parts(label, size, shape):
        if part.convex:
            parts.append(part)
            continue
        low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
        x, y, z = zip(low.tolist(), high.tolist(), strict=True)
        for k, hull in enumerate(hollow_hulls(part.hollow)):
            parts.append(_frozen(place(hull, f"{part.name}.{k + 1}", x, y, z, part.tint)))
    return tuple(parts)


def _builders(label: str) -> tuple[Builder, ...]:
    if label not in _SHAPES:
        raise UnknownNameError("shaped class", label, _SHAPES)
    return _SHAPES[label]


def _fitted(parts: list[Part], size: Vector) -> tuple[Part, ...]:
    """`parts` moved to the box's centre, and stretched where slanting bars fall short of it."""
    low = np.min([part.vertices.min(axis=0) for part in parts], axis=0)
    high = np.max([part.vertices.max(axis=0) for part in parts], axis=0)
    scale = np.array(size) / (high - low)
    return tuple(
        _frozen(replace(part, vertices=(part.vertices - (low + high) / 2) * scale))
        for part in parts
    )


def _frozen(part: Part) -> Part:
    part.vertices.setflags(write=False)
    part.faces.setflags(write=False)
    return part
