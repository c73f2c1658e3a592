"""`doctor` draws a known house, says how, and never fails in silence."""

from __future__ import annotations

import copy
import json
import math
import os
import subprocess
import sys
from typing import Any

import pytest

from lcrl_bench.cli import doctor
from lcrl_bench.cli import main as door
from lcrl_bench.errors import ExitCode


@pytest.fixture(scope="module")
def examined() -> dict[str, Any]:
    """The report on this machine."""
    return doctor.examine()


@pytest.fixture
def report(examined: dict[str, Any]) -> dict[str, Any]:
    """The report, for a test to change."""
    return copy.deepcopy(examined)


def test_rays_draw_on_every_machine(report: dict[str, Any]):
    milliseconds = report["panorama_ms"]["rays"]
    assert 0 < milliseconds < 1000
    assert report["rays_error"] == ""
    assert doctor.verdict(report) == ExitCode.DONE


def test_where_opengl_draws_it_draws_the_same_picture(report: dict[str, Any]):
    if report["gl"]["backend"] is None:
        assert report["gl"]["error"]
        assert report["agreement"] is None
        assert report["panorama_ms"]["gl"] is None
    else:
        assert report["agreement"] >= doctor.SAME_PICTURE
        assert math.isfinite(report["panorama_ms"]["gl"])


def test_versions_are_those_installed(report: dict[str, Any]):
    import mujoco
    import torch

    assert report["versions"]["mujoco"] == mujoco.__version__
    # PyPI's wheel names its version without the kind of build, torch with it (2.13.0+cu130).
    assert torch.__version__.startswith(report["versions"]["torch"])
    assert all(report["versions"].values())


def test_nothing_that_renders_is_an_environment_error(report: dict[str, Any]):
    report["panorama_ms"] = {"gl": None, "rays": None}
    assert doctor.verdict(report) == ExitCode.ENVIRONMENT


def test_a_cache_that_cant_be_written_is_an_environment_error(report: dict[str, Any]):
    report["cache_writable"] = False
    assert doctor.verdict(report) == ExitCode.ENVIRONMENT
    assert any("LCRL_BENCH_HOME" in trap for trap in doctor.traps(report))


def test_renderers_that_disagree_are_a_red_check(report: dict[str, Any]):
    report["agreement"] = 0.9
    assert doctor.verdict(report) == ExitCode.RED
    assert any("90.00%" in trap for trap in doctor.traps(report))


def test_a_software_renderer_is_said_loudly(report: dict[str, Any]):
    report["gl"].update(backend="egl", renderer="llvmpipe (LLVM 15)", software=True, error="")
    assert any(trap.startswith("software renderer: llvmpipe") for trap in doctor.traps(report))
    report["gl"].update(renderer="a graphics card", software=False)
    assert not any("software renderer" in trap for trap in doctor.traps(report))


def test_the_answer_is_one_json_object(
    examined: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
):
    monkeypatch.setattr(doctor, "examine", lambda: dict(examined))
    assert door.main(["doctor", "--json"]) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out) == {**examined, "ok": True}
    assert door.main(["doctor"]) == ExitCode.DONE
    assert "drawn by rays" in capsys.readouterr().out


@pytest.mark.parametrize("setting", ["disable", "egl", "osmesa"])
def test_whatever_mujoco_gl_says_there_is_an_answer(setting: str):
    done = subprocess.run(
        [sys.executable, "-m", "lcrl_bench", "doctor", "--json"],
        env={**os.environ, "MUJOCO_GL": setting},
        capture_output=True,
        text=True,
    )
    report = json.loads(done.stdout)
    assert done.returncode in (ExitCode.DONE, ExitCode.ENVIRONMENT)
    assert report["ok"] == (done.returncode == ExitCode.DONE)
    if not report["ok"]:
        assert "unset it" in done.stderr
    elif report["gl"]["backend"] is None:
        assert "no OpenGL" in done.stderr
    else:
        assert report["gl"]["backend"] == setting
