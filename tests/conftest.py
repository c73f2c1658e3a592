"""What every test has: derandomised properties, one torch thread, a cache of its own."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import pytest

# The processes of pytest-xdist share the cores; torch and BLAS read these when first imported.
for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

hypothesis.settings.register_profile("ci", derandomize=True, deadline=None, database=None)
hypothesis.settings.load_profile("ci")

REPOSITORY = Path(__file__).parents[1]


@pytest.fixture(scope="session", autouse=True)
def one_torch_thread() -> None:
    """Keep torch on one thread: sums in one order, and no fight over the cores."""
    import torch

    torch.set_num_threads(1)


@pytest.fixture(scope="session", autouse=True)
def interruptible() -> None:
    """Take Ctrl-C as a terminal sends it: a shell in the background starts its jobs deaf to it."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def isolated_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Point the suite's caches and logs at a folder of this test process."""
    folder = tmp_path_factory.mktemp("lcrl_bench_home")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LCRL_BENCH_HOME", str(folder))
        yield folder


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return REPOSITORY


@pytest.fixture(scope="session")
def real_houses() -> Path:
    """Folder of real house files of other data sets; they are not part of the repository."""
    named = os.environ.get("LCRL_REAL_HOUSES")
    folder = Path(named) if named else REPOSITORY.parent / "shared" / "houses"
    if not folder.is_dir():
        pytest.skip(f"no real houses in {folder}; name a folder with LCRL_REAL_HOUSES")
    return folder
