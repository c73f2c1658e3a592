"""A spec names one run: one folder, one identity."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.session import Workplace
from lcrl_bench.names import LONGEST

RUNS = Path("runs")
NOISE = f"{noise_method.__file__}:NoiseMethod"
LONG = {"hidden": "32", "image": "film", "mirror": "false", "passes": "20", "size": "32"}


def folder(spec: RunSpec) -> str:
    return spec.folder(RUNS, tiny_benchmark()).path.as_posix()


def identity(spec: RunSpec, **place) -> dict:
    return spec.identity(tiny_benchmark(), Workplace(RUNS, **place))


DIFFERENT = {
    "defaults": RunSpec("lcrl"),
    "another method": RunSpec("cloning"),
    "another seed": RunSpec("lcrl", seed=1),
    "a preset": RunSpec("lcrl", preset="paper"),
    "settings": RunSpec.of("lcrl", {"least_steps": "20", "passes": "1"}),
    "other settings": RunSpec.of("lcrl", {"least_steps": "20", "passes": "2"}),
    "a setting more": RunSpec.of("lcrl", {"least_steps": "20", "passes": "1", "size": "32"}),
    "long settings": RunSpec.of("lcrl", {**LONG, "standardise": "false"}),
    "long ones that begin alike": RunSpec.of("lcrl", {**LONG, "standardise": "true"}),
    "another size": RunSpec("lcrl", image_size=(64, 64)),
    "a budget": RunSpec("lcrl", budget=0.5),
    "a control": RunSpec("random", control=True),
}


def test_specs_that_differ_have_folders_and_identities_of_their_own():
    known = {name: (folder(s), s.key, identity(s)) for name, s in DIFFERENT.items()}
    for (one, first), (other, second) in combinations(known.items(), 2):
        for mine, others in zip(first, second, strict=True):
            assert mine != others, (one, other)


def test_equal_specs_have_one_folder_and_one_identity():
    for spec in DIFFERENT.values():
        assert replace(spec) == spec
        assert folder(replace(spec)) == folder(spec)
        assert identity(replace(spec)) == identity(spec)


def test_a_folder_is_named_by_what_differs_from_the_defaults():
    names = {name: folder(spec).removeprefix("runs/tiny/") for name, spec in DIFFERENT.items()}
    assert names["defaults"] == "lcrl/seed0"
    assert names["another seed"] == "lcrl/seed1"
    assert names["a preset"] == "lcrl-paper/seed0"
    assert names["settings"] == "lcrl-least_steps-20-passes-1/seed0"
    assert names["a setting more"] == "lcrl-least_steps-20-passes-1-size-32/seed0"
    assert names["another size"] == "lcrl-64x64/seed0"
    assert names["a budget"] == "lcrl-budget-0.5/seed0"
    assert names["a control"] == "control-random"
    assert folder(RunSpec("here/mine.py:Mine")) == "runs/tiny/mine/seed0"


def test_the_order_of_settings_changes_nothing():
    settings = {"passes": "1", "size": "32", "least_steps": "20"}
    one, other = (
        RunSpec.of("lcrl", dict(items)) for items in (settings.items(), reversed(settings.items()))
    )
    assert one == other
    assert folder(one) == folder(other)
    assert identity(one) == identity(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"views": "a/b"}, {"views": "a-b"}),
        ({"views": "Max"}, {"views": "max"}),
        ({"rate": "1."}, {"rate": "1"}),
        ({"words": "x" * 200}, {"words": "x" * 201}),
    ],
)
def test_values_that_no_folder_can_be_named_by_are_told_apart_all_the_same(one, other):
    names = [RunSpec.of("lcrl", settings).variant for settings in (one, other)]
    assert len(set(names)) == 2
    for name in names:
        assert len(name) <= LONGEST
        assert folder(RunSpec.of("lcrl", one)).count("/") == 3


def test_what_a_learned_reward_is_optimised_by_is_beside_its_training():
    spec = RunSpec("lcrl", optimizer=Optimizer.DQN, dqn_tasks=3)
    assert spec.training == RunSpec("lcrl")
    assert folder(spec) == folder(spec.training)
    assert (spec.key, spec.training.key) == ("lcrl/seed0/dqn", "lcrl/seed0")
    assert spec.dqn_settings().tasks_per_split == 3
    assert spec.dqn_settings().config.shaping == "none"
    shaped = replace(spec, optimizer=Optimizer.DQN_SHAPED)
    assert shaped.dqn_settings().config.shaping == "optimal-value"


def test_a_budget_shortens_the_training_and_what_dqn_learns():
    spec = RunSpec.of(NOISE, {"passes": "30"}, budget=0.1, optimizer=Optimizer.DQN)
    assert spec.resolved_settings() == {"passes": "3"}
    assert spec.make_method().config.passes == 3
    full = replace(spec, budget=None)
    assert full.resolved_settings() == {"passes": "30"}
    assert spec.dqn_settings().tasks_per_split == full.dqn_settings().tasks_per_split // 10
    assert spec.dqn_settings().config.steps < full.dqn_settings().config.steps


def test_an_identity_has_every_setting_and_what_computes_the_run():
    found = identity(RunSpec.of("lcrl", {"passes": "2"}, seed=3), threads=2, renderer="rays")
    assert (found["method"], found["seed"], found["settings"]) == ("lcrl", 3, {"passes": "2"})
    assert found["fingerprint"] == tiny_benchmark().fingerprint
    assert found["resolved"]["passes"] == 2
    assert found["resolved"]["learning_rate"] > 0, "defaults count too"
    assert (found["made_with"]["threads"], found["made_with"]["renderer"]) == (2, "rays")
    control = identity(RunSpec("random", control=True))
    assert (control["control"], control["settings"]) == ("random", {})
    assert "seed" not in control


def test_a_class_may_stand_for_its_name():
    spec = RunSpec("noise", code=noise_method.NoiseMethod)
    assert spec.method_class() is noise_method.NoiseMethod
    assert folder(spec) == "runs/tiny/noise/seed0"


@pytest.mark.parametrize(
    ("spec", "error", "message"),
    [
        (RunSpec("lcrll"), UnknownNameError, "Did you mean 'lcrl'"),
        (RunSpec("lcrl", preset="papre"), UnknownNameError, "papre"),
        (RunSpec.of("lcrl", {"speed": "9"}), UnknownNameError, "Unknown setting 'speed'"),
        (RunSpec.of("lcrl", {"passes": "many"}), UsageError, "passes=many"),
    ],
)
def test_what_is_no_run_is_named(spec, error, message):
    with pytest.raises(error, match=message):
        identity(spec)
