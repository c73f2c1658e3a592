"""Colours of materials: RGB, each 0..1. For pictures only; colours don't identify classes."""

from __future__ import annotations

from typing import Final

from lcrl_bench.scenes.shapes.primitives import Tint

WOOD: Final[Tint] = (0.66, 0.46, 0.28)
LIGHT_WOOD: Final[Tint] = (0.80, 0.64, 0.43)
DARK_WOOD: Final[Tint] = (0.36, 0.23, 0.14)
PAINT: Final[Tint] = (0.92, 0.91, 0.88)
CERAMIC: Final[Tint] = (0.97, 0.97, 0.98)
STONE: Final[Tint] = (0.52, 0.51, 0.50)
STEEL: Final[Tint] = (0.74, 0.76, 0.78)
IRON: Final[Tint] = (0.20, 0.20, 0.22)
BRASS: Final[Tint] = (0.80, 0.63, 0.30)
GLASS: Final[Tint] = (0.72, 0.86, 0.92)
DARK_GLASS: Final[Tint] = (0.10, 0.11, 0.14)
SCREEN: Final[Tint] = (0.10, 0.16, 0.28)
PLASTIC: Final[Tint] = (0.85, 0.84, 0.80)
RUBBER: Final[Tint] = (0.13, 0.13, 0.13)
FABRIC: Final[Tint] = (0.45, 0.52, 0.60)
WARM_FABRIC: Final[Tint] = (0.72, 0.45, 0.36)
PALE_FABRIC: Final[Tint] = (0.86, 0.80, 0.70)
LEATHER: Final[Tint] = (0.42, 0.26, 0.18)
LINEN: Final[Tint] = (0.95, 0.94, 0.90)
GREEN: Final[Tint] = (0.25, 0.52, 0.24)
PALE_GREEN: Final[Tint] = (0.42, 0.65, 0.32)
SOIL: Final[Tint] = (0.25, 0.17, 0.11)
TERRACOTTA: Final[Tint] = (0.76, 0.43, 0.30)
RED: Final[Tint] = (0.80, 0.20, 0.17)
ORANGE: Final[Tint] = (0.93, 0.55, 0.16)
YELLOW: Final[Tint] = (0.95, 0.80, 0.25)
BLUE: Final[Tint] = (0.20, 0.38, 0.70)
FUR: Final[Tint] = (0.68, 0.47, 0.27)
PAPER: Final[Tint] = (0.96, 0.94, 0.87)
WAX: Final[Tint] = (0.96, 0.91, 0.78)
FLAME: Final[Tint] = (1.0, 0.75, 0.20)
LAMPLIGHT: Final[Tint] = (0.98, 0.92, 0.75)
