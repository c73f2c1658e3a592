"""MuJoCo can be imported whatever other projects left in `MUJOCO_GL`."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from lcrl_bench.scenes.gl_setting import CHOICES, failure_reason, gl_setting

SETTINGS = ("", "off", "egl", "EGL", " egl ", "osmesa", "OSMesa", "glfw", "glx", "x", "garbage")
"""Valid and invalid values of `MUJOCO_GL`, some of whose libraries may be missing here."""


def run(script: str, setting: str | None, **more: str) -> subprocess.CompletedProcess[str]:
    environment = {name: text for name, text in os.environ.items() if name != "PYOPENGL_PLATFORM"}
    if setting is not None:
        environment["MUJOCO_GL"] = setting
    return subprocess.run(
        [sys.executable, "-c", script],
        env={**environment, **more},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_grid_is_built_whatever_mujoco_gl_says(setting: str):
    script = (
        "import os\n"
        "before = dict(os.environ)\n"
        "from lcrl_bench.houses.procedural import generate_house\n"
        "from lcrl_bench.scenes.walkable import build_grid\n"
        "assert build_grid(generate_house(0)).tiles > 10\n"
        "assert dict(os.environ) == before, 'the environment of child processes was changed'\n"
    )
    done = run(script, setting)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    notices = done.stderr.splitlines()
    assert len(notices) <= 1, notices
    if setting in ("x", "garbage"):
        assert f"MuJoCo is imported without MUJOCO_GL={setting}" in notices[0]
        assert "set one of: egl, osmesa, glfw" in notices[0]
    elif setting in ("", "off"):
        assert notices == []


def test_a_platform_of_pyopengl_left_over_does_not_matter():
    script = "from lcrl_bench.scenes.mujoco_import import mujoco; print(mujoco.MjSpec().compile())"
    for platform in ("egl", "osmesa", "garbage"):
        done = run(script, "osmesa", PYOPENGL_PLATFORM=platform)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        (" EGL ", "egl"),
        ("OSMesa", "osmesa"),
        ("Off", "off"),
        ("1", "1"),
        ("x", ""),
        ("vulkan", ""),
        ("", ""),
    ],
)
def test_values_are_read_in_any_case_and_unknown_ones_mean_nothing(
    text: str, meaning: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("MUJOCO_GL", text)
    assert gl_setting() == meaning


def test_each_choice_is_a_module_of_mujoco():
    folder = Path(__import__("mujoco").__file__).parent
    assert all((folder / module / "__init__.py").is_file() for module in CHOICES.values())


def test_a_missing_library_is_said_in_plain_words():
    message = "AttributeError: 'NoneType' object has no attribute 'glGetError'"
    assert failure_reason(message) == "its library is not installed"
    assert failure_reason("Cannot create an EGL context.\n") == "Cannot create an EGL context"


def test_nothing_else_in_the_library_imports_mujoco(repository: Path):
    """Another import would run first somewhere, and fail with `MUJOCO_GL=osmesa`."""
    importing = set()
    for path in (repository / "lcrl_bench").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module or ""]
            else:
                continue
            tops = {name.partition(".")[0] for name in names}
            if tops & {"mujoco", "dm_control"}:
                importing.add(path.name)
    assert importing == {"mujoco_import.py"}
