"""OpenGL beside a second LLVM: PyTorch's CUDA builds bring triton, Mesa's drivers another one.

A process into which triton is loaded after Mesa's LLVM ends with a segmentation fault. numba's
LLVM does not, so where triton is not installed only the order of loading can be tested.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest
from panorama_samples import need_gl

from lcrl_bench.scenes.panoramas import describe_gl

DRAW = (
    "import sys\n"
    "import numpy as np\n"
    "from lcrl_bench.scenes.panoramas import open_renderer\n"
    "with open_renderer([], backend=sys.argv[1]) as renderer:\n"
    "    renderer.render(np.zeros((1, 2)))\n"
)
STAND_IN = (
    "from pathlib import Path\n"
    "loaded = 'libLLVM' in Path('/proc/self/maps').read_text()\n"
    "print('triton, after LLVM' if loaded else 'triton, before LLVM', flush=True)\n"
)
AFTERWARDS = "print('LLVM' if 'libLLVM' in open('/proc/self/maps').read() else 'no LLVM')\n"


def run(script: str, backend: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    more = {} if folder is None else {"PYTHONPATH": str(folder)}
    return subprocess.run(
        [sys.executable, "-c", script, backend],
        env={**os.environ, **more},
        capture_output=True,
        text=True,
    )


def need_mesa() -> None:
    need_gl()
    if not sys.platform.startswith("linux") or "LLVM" not in describe_gl().renderer:
        pytest.skip(f"the driver brings no LLVM: {describe_gl().renderer}")


@pytest.mark.skipif(importlib.util.find_spec("triton") is not None, reason="triton is installed")
@pytest.mark.parametrize("content", [STAND_IN, STAND_IN + "raise OSError('no libcuda')\n"])
def test_what_brings_an_llvm_is_loaded_before_the_driver_s(content: str, tmp_path: Path):
    need_mesa()
    (tmp_path / "triton.py").write_text(content)
    done = run(DRAW + AFTERWARDS, "gl", tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["triton, before LLVM", "LLVM"]


def test_rays_load_neither_triton_nor_a_driver(tmp_path: Path):
    (tmp_path / "triton.py").write_text("print('triton')")
    script = DRAW + "print('mujoco' in sys.modules, 'OpenGL' in sys.modules)"
    done = run(script, "rays", tmp_path)
    assert (done.returncode, done.stdout.strip()) == (0, "False False"), done.stderr


def test_asking_what_opengl_there_is_opens_none_here():
    script = (
        "import sys\n"
        "from lcrl_bench.scenes.panoramas import describe_gl\n"
        "describe_gl()\n"
        "print('OpenGL' in sys.modules, 'mujoco.egl' in sys.modules)\n"
    )
    environment = {name: text for name, text in os.environ.items() if name != "MUJOCO_GL"}
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout.strip()) == (0, "False False"), done.stderr


@pytest.mark.slow
@pytest.mark.skipif(
    importlib.util.find_spec("triton") is None,
    reason="triton is not installed: PyPI's default PyTorch for Linux brings it, CPU builds do not",
)
@pytest.mark.parametrize("backend", ["gl", "auto"])
def test_triton_and_torch_s_compiler_load_after_drawing(backend: str):
    need_gl()
    script = DRAW + "import triton._C.libtriton, torch._dynamo\nprint('alive')\n"
    done = run(script, backend)
    assert (done.returncode, done.stdout.strip()) == (0, "alive"), done.stderr
