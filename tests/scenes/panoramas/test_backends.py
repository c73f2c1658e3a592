"""The renderer that is chosen where OpenGL works, is switched off, is missing or is broken."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from house_samples import two_rooms
from panorama_samples import BACKENDS, ORIGIN, box, need_gl, standing_points

from lcrl_bench.errors import EnvironmentMissingError, UnknownNameError, UsageError
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.panoramas import (
    automatic_backend,
    backends,
    choose_backend,
    context,
    describe_gl,
    movable_objects,
    open_renderer,
    time_panoramas,
)
from lcrl_bench.scenes.panoramas.context import GlDescription

VASE = box("vase", "vase", (0, 2, 1.25), (0.3, 0.3, 0.3))
CUP = PlacedObject("cup", "cup", "room", (0, 1, 1), (0.1, 0.1, 0.1), 0.0)
CUP_SURFACE = box("cup", "cup", CUP.position, CUP.size, thing="cup")


@pytest.fixture
def no_gl(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A machine whose OpenGL the user switched off."""
    monkeypatch.setenv("MUJOCO_GL", "off")
    describe_gl.cache_clear()
    backends._notice_fallback.cache_clear()
    yield
    describe_gl.cache_clear()
    backends._notice_fallback.cache_clear()


@pytest.mark.usefixtures("no_gl")
def test_without_opengl_auto_means_rays_and_says_so_once(caplog: pytest.LogCaptureFixture):
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            with open_renderer([VASE]) as renderer:
                assert renderer.backend == "rays"
    assert len(caplog.messages) == 1
    assert "OpenGL can't be used: MUJOCO_GL=off" in caplog.messages[0]


@pytest.mark.usefixtures("no_gl")
def test_without_opengl_asking_for_it_names_what_to_install():
    with pytest.raises(EnvironmentMissingError, match=r"libegl1 and libgl1.*--renderer rays"):
        open_renderer([VASE], backend="gl")


CARD = GlDescription("egl", "NVIDIA H100/PCIe/SSE2", False, "")
SOFTWARE = GlDescription("egl", "llvmpipe (LLVM 15.0.6, 256 bits)", True, "")
NOTHING = GlDescription(None, "", False, "egl: its library is not installed.")


@pytest.mark.parametrize(
    ("found", "with_embree", "without_embree"),
    [(CARD, "gl", "gl"), (SOFTWARE, "rays", "gl"), (NOTHING, "rays", "rays")],
    ids=["graphics card", "software", "none"],
)
def test_auto_means_opengl_only_where_a_graphics_card_draws(
    found: GlDescription,
    with_embree: str,
    without_embree: str,
    monkeypatch: pytest.MonkeyPatch,
):
    assert automatic_backend(found) == with_embree
    monkeypatch.setattr(backends.importlib.util, "find_spec", lambda _: None)
    assert automatic_backend(found) == without_embree


def test_auto_is_what_this_machine_s_opengl_says():
    chosen = automatic_backend(describe_gl())
    assert choose_backend() == chosen
    with open_renderer([VASE]) as renderer:
        assert renderer.backend == chosen


def test_rays_instead_of_software_are_no_news(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    monkeypatch.setattr(backends, "describe_gl", lambda: SOFTWARE)
    with caplog.at_level(logging.INFO):
        assert choose_backend() == "rays"
    assert caplog.messages == []


@pytest.mark.parametrize(
    ("driver", "software"),
    [
        ("llvmpipe (LLVM 15.0.6, 256 bits)", True),
        ("softpipe", True),
        ("Mesa Software Rasterizer (swrast)", True),
        ("zink Vulkan 1.3(llvmpipe (LLVM 17.0.6, 256 bits))", True),
        ("Apple Software Renderer", True),
        ("GDI Generic", True),
        ("D3D12 (Microsoft Basic Render Driver)", True),
        ("D3D12 (NVIDIA GeForce RTX 4090)", False),
        ("NVIDIA H100 PCIe/PCIe/SSE2", False),
        ("Mesa Intel(R) UHD Graphics 620 (KBL GT2)", False),
        ("AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6)", False),
        ("Apple M2", False),
    ],
)
def test_software_drivers_are_told_by_their_names(
    driver: str, software: bool, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(context, "_probe", lambda _: (driver, ""))
    assert describe_gl.__wrapped__().software is software


def test_an_unknown_renderer_lists_the_known():
    with pytest.raises(
        UnknownNameError, match=r"'ray'. Did you mean 'rays'\? Valid: auto, gl, rays"
    ):
        open_renderer([VASE], backend="ray")


def test_the_description_of_opengl_names_the_driver_or_the_reason():
    found = describe_gl()
    assert (found.backend is None) == (found.renderer == "")
    assert (found.backend is None) == (found.error != "")


def test_a_value_of_mujoco_gl_that_nobody_knows_is_as_good_as_none(
    monkeypatch: pytest.MonkeyPatch,
):
    tried: list[str] = []
    monkeypatch.setattr(context, "_probe", lambda backend: (tried.append(backend), ("", "no"))[1])
    for setting in ("", "vulkan", "EGL"):
        monkeypatch.setenv("MUJOCO_GL", setting)
        found = describe_gl.__wrapped__()
    every = list(context._backends())
    assert tried == [*every, *every, "egl"]
    assert found.error == "egl: no, as chosen by MUJOCO_GL=egl."


def test_a_driver_that_ends_its_process_is_reported_and_passed_over(
    monkeypatch: pytest.MonkeyPatch,
):
    crash = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    real_run = subprocess.run
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(
        context.subprocess,
        "run",
        lambda command, **more: real_run([sys.executable, "-c", crash], **more),
    )
    found = describe_gl.__wrapped__()
    assert found.backend is None
    assert "egl: the driver's process was killed by signal 11" in found.error


def test_opengl_that_breaks_in_this_process_alone_falls_back_too(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    claimed = GlDescription("osmesa", "a card that isn't there", False, "")
    monkeypatch.setattr(context, "describe_gl", lambda: claimed)
    monkeypatch.setattr(backends, "describe_gl", lambda: claimed)
    # As where the library is missing: the module of that name can't be imported.
    monkeypatch.setitem(sys.modules, "mujoco.osmesa", None)
    backends._notice_fallback.cache_clear()
    with caplog.at_level(logging.WARNING), open_renderer([VASE]) as renderer:
        assert renderer.backend == "rays"
    backends._notice_fallback.cache_clear()
    assert "works in a fresh process but not in this one" in caplog.text
    with pytest.raises(EnvironmentMissingError, match="libosmesa6"):
        open_renderer([VASE], backend="gl")


@pytest.mark.parametrize("value", ["off", "osmesa", "EGL", "nonsense", ""])
def test_no_setting_of_mujoco_gl_crashes_the_fallback(value: str):
    script = (
        "import numpy as np\n"
        "from lcrl_bench.scenes.panoramas import open_renderer\n"
        "with open_renderer([]) as renderer:\n"
        "    print(renderer.backend, renderer.render(np.zeros((2, 2))).shape)\n"
    )
    environment = {**os.environ, "MUJOCO_GL": value}
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    name, shape = done.stdout.strip().split(maxsplit=1)
    assert shape == "(2, 4, 24, 32)"
    assert name in ("gl", "rays")
    # One line where MuJoCo is imported without the value, and one where no OpenGL works at all.
    notices = done.stderr.splitlines()
    assert len(notices) <= 2
    assert all(line.startswith("notice: ") for line in notices)


@pytest.mark.parametrize("value", ["nonsense", "EGL", ""])
@pytest.mark.parametrize("platform", ["osmesa", "nonsense", ""])
def test_opengl_starts_whatever_other_projects_left_in_the_shell(value: str, platform: str):
    if describe_gl().backend != "egl":
        pytest.skip(f"no EGL here: {describe_gl()}")
    script = (
        "import numpy as np\n"
        "from lcrl_bench.scenes.panoramas import open_renderer\n"
        "with open_renderer([], backend='gl') as renderer:\n"
        "    renderer.render(np.zeros((1, 2)))\n"
    )
    environment = {**os.environ, "MUJOCO_GL": value, "PYOPENGL_PLATFORM": platform}
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("\n") == (1 if value == "nonsense" else 0)


def test_opening_a_renderer_leaves_the_environment_as_it_was():
    need_gl()
    before = dict(os.environ)
    with open_renderer([VASE], backend="gl"):
        assert dict(os.environ) == before


def test_a_renderer_left_open_ends_quietly():
    need_gl()
    script = (
        "import numpy as np\n"
        "from lcrl_bench.scenes.panoramas import open_renderer\n"
        "first, second = (open_renderer([], backend='gl') for _ in range(2))\n"
        "second.render(np.zeros((1, 2)))\n"
        "del first\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_closing_one_renderer_leaves_another_unharmed():
    need_gl()
    kept = open_renderer([VASE], backend="gl")
    before = kept.render(ORIGIN)
    with open_renderer([CUP_SURFACE], backend="gl") as other:
        other.render(ORIGIN)
    np.testing.assert_array_equal(kept.render(ORIGIN), before)
    kept.close()
    kept.close()
    with pytest.raises(UsageError, match="closed"):
        kept.render(ORIGIN)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "points", [np.zeros(2), np.zeros((1, 3)), np.array([[0.0, np.nan]])], ids=str
)
def test_points_that_are_no_points_are_refused(backend: str, points: np.ndarray):
    need_gl(backend)
    with (
        open_renderer([VASE], backend=backend) as renderer,
        pytest.raises(UsageError, match="finite"),
    ):
        renderer.render(points)


@pytest.mark.parametrize(
    ("arrangement", "reason"),
    [
        (Arrangement("cupp"), "Did you mean 'cup'"),
        (Arrangement(None, CUP), "must be hidden"),
        (Arrangement("cup", PlacedObject("cup", "cup", "room", (0, 0, 0), (1, 1, 1), 0)), "found"),
        (Arrangement("cup", PlacedObject("cup", "vase", "room", (0, 0, 0), CUP.size, 0)), "found"),
    ],
)
def test_an_arrangement_that_makes_no_sense_is_refused(arrangement: Arrangement, reason: str):
    with (
        open_renderer([CUP_SURFACE], movable=[CUP], backend="rays") as renderer,
        pytest.raises((UsageError, UnknownNameError), match=reason),
    ):
        renderer.render(ORIGIN, arrangement)


def test_what_tasks_move_about_is_movable_and_furniture_is_not():
    assert [thing.id for thing in movable_objects(two_rooms())] == ["cup"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_panorama_takes_milliseconds(backend: str):
    need_gl(backend)
    house = two_rooms()
    with open_renderer(house_surfaces(house), backend=backend) as renderer:
        assert 0.01 < time_panoramas(renderer, standing_points(house), seconds=0.1) < 1000
