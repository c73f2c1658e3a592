"""What tells two runs apart is named."""

from __future__ import annotations

import torch

from lcrl_bench import __version__
from lcrl_bench.evaluation.identity import differences, edited_since, made_with, without_computer
from lcrl_bench.methods.registry import resolve_method

CPU = torch.device("cpu")


def identity(**changes) -> dict:
    made = made_with(resolve_method("lcrl"), CPU, threads=1)
    resolved = {"passes": 60, "size": 32}
    config = {"method": "lcrl", "settings": {}, "seed": 0, "resolved": resolved}
    return {**config, "made_with": {**made, **changes}}


def test_equal_identities_do_not_differ():
    assert differences(identity(), identity()) == ()


def test_a_setting_is_named_once_with_both_values():
    other = {**identity(), "settings": {"passes": "2"}, "resolved": {"passes": 2, "size": 32}}
    assert differences(identity(), other) == ("passes (unset then, 2 now)",)
    default = {**identity(), "resolved": {"passes": 60, "size": 64}}
    assert differences(identity(), default) == ("size (32 then, 64 now)",)


def test_edited_code_is_named():
    files = identity()["made_with"]["method_files"]
    edited = {**files, "lcrl_bench.baselines.lcrl.method": "0" * 64, "more": "1" * 64}
    assert differences(identity(), identity(method_files=edited)) == (
        "the method's lcrl_bench.baselines.lcrl.method (edited since)",
        "the method's more (new)",
    )
    assert differences(identity(method_files=edited), identity())[1] == "the method's more (gone)"
    assert differences(identity(), identity(suite_code="0" * 64)) == (
        "the code of lcrl_bench (edited since)",
    )


def test_another_version_is_another_run(monkeypatch):
    before = identity()
    monkeypatch.setattr("lcrl_bench.evaluation.identity.__version__", "9.0.0")
    assert differences(before, identity()) == (
        f"version of lcrl_bench ({__version__} then, 9.0.0 now)",
    )


def test_another_kernel_gives_other_bits_but_not_other_figures(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    before = identity()
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
    now = identity(threads=2, device="cuda")
    assert differences(before, now) == (
        "kernel (numba then, torch now)",
        "threads (1 then, 2 now)",
        "device (cpu then, cuda now)",
    )
    assert differences(without_computer(before), without_computer(now)) == ()


def test_what_an_older_version_wrote_is_unknown_not_equal():
    older = {key: value for key, value in identity().items() if key != "made_with"}
    (said,) = differences(older, identity())
    assert "older version" in said
    assert differences([], identity()) == ("its config.json, which is not that of a run",)


def test_what_was_edited_since_a_run_is_known():
    lcrl = resolve_method("lcrl")
    assert edited_since(identity(), lcrl) == ()
    assert edited_since(identity(method_files={}), lcrl) == ("the method's files",)
    assert edited_since({"method": "lcrl"}, lcrl) == ()
