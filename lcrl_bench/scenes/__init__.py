"""House to MuJoCo scene: meshes, collision, MJCF, the walkable grid and the panoramas."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.scenes.arrangement import AS_FOUND as AS_FOUND
    from lcrl_bench.scenes.arrangement import Arrangement as Arrangement
    from lcrl_bench.scenes.grid import Grid as Grid
    from lcrl_bench.scenes.mjcf import compile_scene as compile_scene
    from lcrl_bench.scenes.mjcf import house_mjcf as house_mjcf
    from lcrl_bench.scenes.reach import within_reach as within_reach
    from lcrl_bench.scenes.scene import Scene as Scene
    from lcrl_bench.scenes.walkable import build_grid as build_grid
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "AS_FOUND": ".arrangement",
            "Arrangement": ".arrangement",
            "Grid": ".grid",
            "compile_scene": ".mjcf",
            "house_mjcf": ".mjcf",
            "within_reach": ".reach",
            "Scene": ".scene",
            "build_grid": ".walkable",
        },
    )
