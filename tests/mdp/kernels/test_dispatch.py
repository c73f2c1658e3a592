"""The choice between compiled kernels and torch, and loops in parallel."""

from __future__ import annotations

import subprocess
import sys

import pytest
import torch

from lcrl_bench.errors import EnvironmentMissingError, ExitCode, UsageError
from lcrl_bench.mdp.kernels.dispatch import parallel_for, use_kernel

CPU = torch.device("cpu")


@pytest.fixture
def without_numba(monkeypatch):
    """A Python that has no numba."""
    monkeypatch.setitem(sys.modules, "numba", None)


@pytest.mark.parametrize("choice", [None, "", "auto"])
def test_torch_computes_where_numba_is_not_installed(choice, monkeypatch, without_numba):
    if choice is None:
        monkeypatch.delenv("LCRL_BENCH_KERNEL", raising=False)
    else:
        monkeypatch.setenv("LCRL_BENCH_KERNEL", choice)
    assert not use_kernel(CPU)


@pytest.mark.parametrize("choice", ["auto", "numba"])
def test_kernels_compute_where_numba_is_installed(choice, monkeypatch):
    pytest.importorskip("numba")
    monkeypatch.setenv("LCRL_BENCH_KERNEL", choice)
    assert use_kernel(CPU)


@pytest.mark.parametrize("choice", ["auto", "numba", "torch"])
def test_torch_computes_on_any_other_device(choice, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", choice)
    assert not use_kernel(torch.device("cuda"))


def test_torch_can_be_insisted_on(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
    assert not use_kernel(CPU)


def test_an_unknown_kernel_is_refused_with_a_list_of_the_valid_ones(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "cupy")
    with pytest.raises(UsageError, match=r"'cupy' names no kernel\. Valid: auto, numba, torch"):
        use_kernel(CPU)


def test_insisting_on_numba_without_it_says_how_to_install_it(monkeypatch, without_numba):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    with pytest.raises(EnvironmentMissingError) as error:
        use_kernel(CPU)
    assert "pip install numba" in str(error.value)
    assert error.value.exit_code == ExitCode.ENVIRONMENT


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 7])
def test_every_index_is_worked_on_once_whatever_the_threads(count, threads):
    before = torch.get_num_threads()
    done: list[int] = []
    try:
        torch.set_num_threads(threads)
        parallel_for(count, lambda first, end: done.extend(range(first, end)))
    finally:
        torch.set_num_threads(before)
    assert sorted(done) == list(range(count))


def test_what_fails_in_a_thread_fails_for_the_caller():
    def fail(first: int, end: int) -> None:
        raise ValueError(f"part {first} to {end}")

    before = torch.get_num_threads()
    try:
        torch.set_num_threads(2)
        with pytest.raises(ValueError, match="part 0 to 2"):
            parallel_for(4, fail)
    finally:
        torch.set_num_threads(before)


def test_importing_the_solvers_does_not_import_numba():
    names = ("kernels.dispatch", "policy_outcome", "maximum_entropy")
    imports = ", ".join(f"lcrl_bench.mdp.{name}" for name in names)
    program = f"import {imports}, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
