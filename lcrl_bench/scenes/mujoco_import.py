"""Imports MuJoCo whatever the value of `MUJOCO_GL`. The whole library imports it from here.

    from lcrl_bench.scenes.mujoco_import import mujoco

MuJoCo's own import reads `MUJOCO_GL`, loads that OpenGL, and fails if the value is unknown or its
library is missing, although most of MuJoCo needs no OpenGL.
"""

from __future__ import annotations

import importlib
import logging
import os
from typing import TYPE_CHECKING

from lcrl_bench.scenes.gl_setting import (
    CHOICES,
    GL_VARIABLES,
    failure_reason,
    gl_environment_kept,
)

_logger = logging.getLogger(__name__)


def _import_mujoco() -> None:
    """Import MuJoCo, if need be without `MUJOCO_GL` and with a notice."""
    setting = os.environ.get("MUJOCO_GL", "")
    with gl_environment_kept():
        try:
            importlib.import_module("mujoco")
            return
        except Exception as error:
            if not setting:
                raise
            reason = failure_reason(" ".join(str(error).split()))
    with gl_environment_kept():
        for name in GL_VARIABLES:
            os.environ.pop(name, None)
        importlib.import_module("mujoco")
    _logger.warning(
        "notice: MuJoCo is imported without MUJOCO_GL=%s (%s). Unset it, or set one of: %s, off.",
        setting,
        reason,
        ", ".join(CHOICES),
    )


if TYPE_CHECKING:
    import mujoco
else:
    _import_mujoco()
    import mujoco

__all__ = ["mujoco"]
