"""The encoder's compiled kernel against the same layers by torch."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.errors import EnvironmentMissingError, UsageError
from lcrl_bench.networks.kernels import largest_cells
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import PatchIndex, build_patch_index

laws = settings(derandomize=True, deadline=None, max_examples=25)


@st.composite
def house_views(draw) -> torch.Tensor:
    """Views of a house from entirely flat to entirely noise, of any number and even sides."""
    shape = (draw(st.integers(1, 9)), 2 * draw(st.integers(1, 12)), 2 * draw(st.integers(1, 16)))
    rng = np.random.default_rng(draw(st.integers(0, 10_000)))
    views = np.full(shape, rng.integers(61), np.uint8)
    for view in views:
        for _ in range(draw(st.sampled_from([0, 1, 4]))):
            y, x = rng.integers(shape[1]), rng.integers(shape[2])
            view[y : y + rng.integers(1, 12), x : x + rng.integers(1, 14)] = rng.integers(61)
    if draw(st.booleans()):
        views[0] = rng.integers(61, size=shape[1:])
    return torch.from_numpy(views)


def index_of(views: torch.Tensor) -> PatchIndex:
    return build_patch_index(views, torch.zeros(1, 4, dtype=torch.int64), classes=61)


def make(seed: int, **sizes: int) -> PanoramaEncoder:
    return PanoramaEncoder(61, generator=torch.Generator().manual_seed(seed), **sizes)


def house(seed: int = 0, count: int = 40) -> PatchIndex:
    rng = np.random.default_rng(seed)
    views = np.ones((count, 24, 32), np.uint8)
    for view in views:
        for _ in range(4):
            y, x = rng.integers(20), rng.integers(28)
            view[y : y + rng.integers(1, 12), x : x + rng.integers(1, 14)] = rng.integers(61)
    return index_of(torch.from_numpy(views))


def results(encoder: PanoramaEncoder, index: PatchIndex) -> list[torch.Tensor]:
    """The embeddings and the gradient of every weight."""
    output = encoder.embed_views(index)
    weights = torch.linspace(-1, 1, output.numel(), dtype=output.dtype).view_as(output)
    parameters = list(encoder.parameters())
    return [output.detach(), *torch.autograd.grad((weights * output).sum(), parameters)]


def by(kernel: str, encoder: PanoramaEncoder, index: PatchIndex) -> list[torch.Tensor]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LCRL_BENCH_KERNEL", kernel)
        return results(encoder, index)


def assert_close(found: list[torch.Tensor], expected: list[torch.Tensor], limit: float) -> None:
    """Compare relative to the largest entry of each tensor."""
    for part, reference in zip(found, expected, strict=True):
        error = (part - reference).abs().max() / reference.abs().max().clamp(min=1e-30)
        assert float(error) < limit, tuple(reference.shape)


@laws
@given(house_views(), st.integers(0, 10_000))
def test_the_kernel_gives_what_torch_gives_forwards_and_backwards(views, seed):
    encoder, index = make(seed), index_of(views)
    assert_close(by("numba", encoder, index), by("torch", encoder, index), 1e-5)


def test_the_kernel_is_close_to_double_precision_on_a_whole_house():
    encoder, index = make(1), house(1, count=200)
    found = by("numba", encoder, index)
    assert_close(found, by("torch", encoder.double(), index), 1e-5)


def test_two_convolutions_side_by_side_are_covered():
    encoder, index = make(2), house(2, count=7)
    pair = torch.cat([encoder.second_weight, -encoder.second_weight])
    found = []
    for kernel in ("numba", "torch"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("LCRL_BENCH_KERNEL", kernel)
            output = encoder.largest_cells(index, pair)
        weight = torch.linspace(-1, 1, output.numel()).view_as(output)
        parameters = [encoder.first_weight, encoder.first_bias, encoder.second_weight]
        gradients = torch.autograd.grad((weight * output).sum(), parameters, retain_graph=True)
        found.append([output.detach(), *gradients])
    assert found[0][0].shape == (7, 64)
    assert_close(found[0], found[1], 1e-5)


def test_mirrored_kernels_see_mirror_images():
    rng = np.random.default_rng(0)
    views = torch.from_numpy(rng.integers(61, size=(3, 8, 12)).astype(np.uint8))
    encoder = make(3)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LCRL_BENCH_KERNEL", "numba")
        found = encoder.embed_views(index_of(views), mirrored=True)
        expected = encoder.embed_views(index_of(views.flip(-1)))
    torch.testing.assert_close(found, expected)


def test_any_number_of_threads_gives_the_same_bits():
    encoder, index, before = make(3), house(3), torch.get_num_threads()
    try:
        found = []
        for threads in (1, 1, 2, 3):
            torch.set_num_threads(threads)
            found.append(by("numba", encoder, index))
    finally:
        torch.set_num_threads(before)
    for other in found[1:]:
        assert all(torch.equal(a, b) for a, b in zip(found[0], other, strict=True))


def test_without_gradients_the_same_embeddings_come_out(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    encoder, index = make(4), house(4)
    expected = encoder.embed_views(index)
    assert expected.requires_grad
    with torch.no_grad():
        assert torch.equal(encoder.embed_views(index), expected)


def refused(*_: object) -> torch.Tensor:
    raise AssertionError("this implementation must not be called")


@pytest.mark.parametrize("sizes", [{"filters": 8}, {"size": 16}, {"filters": 32, "size": 48}])
def test_other_sizes_are_computed_by_torch(sizes, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    monkeypatch.setattr(largest_cells, "largest_cells", refused)
    encoder = make(5, **sizes)
    assert encoder.embed_views(house(5, count=3)).shape == (3, encoder.size)


def test_double_precision_is_computed_by_torch(monkeypatch):
    monkeypatch.setattr(largest_cells, "largest_cells", refused)
    assert make(5).double().embed_views(house(5, count=3)).dtype == torch.float64


@pytest.mark.parametrize("name", ["first_weight", "first_bias", "second_weight", "second_bias"])
def test_a_weight_that_is_no_number_shows_in_the_embeddings(name, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    encoder = make(6)
    with torch.no_grad():
        getattr(encoder, name).fill_(torch.nan)
    assert encoder.embed_views(house(6, count=3)).isnan().any()


def test_the_variable_chooses(monkeypatch):
    encoder, index = make(7), house(7, count=3)
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
    with monkeypatch.context() as patch:
        patch.setattr(largest_cells, "largest_cells", refused)
        encoder.embed_views(index)
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    monkeypatch.setattr(encoder, "_largest_cells", refused)
    encoder.embed_views(index)


def test_an_unknown_kernel_is_refused(monkeypatch):
    index = house(8, count=2)
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "cuda")
    with pytest.raises(UsageError, match="Valid: auto, numba, torch"):
        make(8).embed_views(index)


def test_everything_works_without_numba(monkeypatch):
    encoder, index = make(9), house(9, count=4)
    expected = by("torch", encoder, index)
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delenv("LCRL_BENCH_KERNEL", raising=False)
    found = results(encoder, house(9, count=4))
    assert all(torch.equal(a, b) for a, b in zip(found, expected, strict=True))
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    with pytest.raises(EnvironmentMissingError, match="pip install numba"):
        encoder.embed_views(index)


def test_importing_the_networks_does_not_import_numba():
    code = (
        "import sys, lcrl_bench.networks.panorama_encoder, lcrl_bench.networks.patches\n"
        "assert 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
