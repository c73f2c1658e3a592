"""A run trains, evaluates and finishes once; then it is read back."""

from __future__ import annotations

import json

import noise_method
import pytest
import torch
from benchmark_samples import tiny_session, tiny_task_sets
from noise_method import Noise, NoiseMethod

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.evaluation.finished_runs import read_reward, read_run
from lcrl_bench.evaluation.harness import evaluate
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run import Run, RunSpec, read_results, run
from lcrl_bench.evaluation.session import Session
from lcrl_bench.methods.tensors import TensorPolicy

NOISE = f"{noise_method.__file__}:NoiseMethod"


class Idle(TensorPolicy):
    def logits(self, views, commands):
        return torch.zeros(len(commands), len(views.panorama_views), 2, 4, 4)


class Mistaken(NoiseMethod):
    learns = Idle


class Idler(NoiseMethod):
    """Learns nothing, and draws nothing."""

    learns = Idle

    def fit(self, train, **rest):
        return Idle({})


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> tuple[Session, Run]:
    """A run, and the session that it was made in: not to be changed."""
    bench = tiny_session(tmp_path_factory.mktemp("runs"))
    return bench, run(RunSpec(NOISE), bench)


def test_what_was_learned_is_read_back_to_the_bit(made):
    _, found = made
    again = read_reward(found.folder.path)
    assert type(again).__name__ == Noise.__name__
    views, said = tiny_task_sets()[0].views.observed.views, ("go to the bed", "")
    assert torch.equal(again.score(views, said), found.learned.score(views, said))


def test_a_run_is_named_by_its_folder(made):
    _, found = made
    spec, _ = read_run(found.folder.path)
    assert spec == found.spec == RunSpec(NOISE)


def test_results_are_those_of_evaluating_what_was_learned(made):
    bench, found = made
    sets = bench.task_sets()
    tasks = [task for each in sets for task in each.tasks]
    assert found.results.outcomes(tasks) == evaluate(found.learned, sets)
    assert found.results.controls == ("blank", "shuffled", "wrong-target", "paraphrase")


def test_results_tables_files_and_summary_say_the_same(made):
    bench, found = made
    summary = found.folder.summary()
    assert {key: summary[key] for key in found.results.tables()} == found.results.tables()
    assert summary["seed"] == 0
    assert not summary["deterministic"], "noise is drawn"
    controls = {name: each.splits() for name, each in bench.controls().items()}
    for name, table in controls.items():
        assert {split: summary["controls"][name][split] for split in table} == table
    again = read_results(found.spec, found.folder)
    assert again.tables() == found.results.tables()
    assert again.rows == found.results.rows


def test_a_finished_run_is_read_back_and_not_repeated(made):
    bench, found = made
    files = {path: path.stat().st_mtime_ns for path in found.folder.path.rglob("*")}
    told = []
    again = run(RunSpec(NOISE), bench, log=told.append)
    assert found.read_back is None
    assert again.read_back == found.folder.finished
    assert again.results.tables() == found.results.tables()
    assert told == []
    assert {path: path.stat().st_mtime_ns for path in found.folder.path.rglob("*")} == files


def test_the_same_spec_gives_the_same_bits_and_another_seed_others(made, tmp_path):
    _, found = made
    bench = tiny_session(tmp_path)
    again, other = (run(RunSpec(NOISE, seed=seed), bench) for seed in (0, 1))
    assert again.results.tables() == found.results.tables()
    assert not torch.equal(again.learned.tensors["worth"], other.learned.tensors["worth"])
    joined = Results.join([again.results, other.results])
    assert joined.seeds == (0, 1)
    assert joined.seed_tables()[0] == found.results.tables()


def test_every_row_of_the_training_is_told(tmp_path):
    told = []
    run(RunSpec.of(NOISE, {"passes": "3"}), tiny_session(tmp_path), log=told.append)
    assert [row["step"] for row in told] == [1, 2, 3]
    lines = next(tmp_path.rglob("metrics.jsonl")).read_text().splitlines()
    assert [json.loads(line) for line in lines] == told


def test_runs_of_other_settings_stand_beside_each_other(tmp_path):
    bench = tiny_session(tmp_path)
    for settings in ({}, {"passes": "2"}, {"passes": "2", "fails": "false"}):
        assert run(RunSpec.of(NOISE, settings), bench).read_back is None
    assert sorted(path.parent.parent.name for path in tmp_path.rglob("DONE")) == [
        "noise_method",
        "noise_method-fails-false-passes-2",
        "noise_method-passes-2",
    ]


def test_another_run_in_the_folder_is_refused_or_set_aside(tmp_path):
    run(RunSpec(NOISE), tiny_session(tmp_path))
    with pytest.raises(UsageError, match="holds another run"):
        run(RunSpec(NOISE), tiny_session(tmp_path, threads=2))
    found = run(RunSpec(NOISE), tiny_session(tmp_path, threads=2, fresh=True))
    assert found.folder.aside == found.folder.path.with_name("seed0.old1")


def test_a_method_that_learns_something_else_than_it_says_is_refused(tmp_path):
    with pytest.raises(UsageError, match="fit returned a Noise, but learns = Idle"):
        run(RunSpec("mistaken", code=Mistaken), tiny_session(tmp_path))
    assert not list(tmp_path.rglob("model*"))


def test_a_mistyped_setting_is_named_before_a_house_is_loaded(tmp_path):
    with pytest.raises(UnknownNameError, match="Did you mean 'passes'"):
        run(RunSpec.of(NOISE, {"passs": "1"}), tiny_session(tmp_path))
    assert not list(tmp_path.rglob("config.json"))


def test_a_method_that_draws_nothing_is_known_for_it(tmp_path):
    found = run(RunSpec("idler", code=Idler), tiny_session(tmp_path))
    assert found.folder.summary()["deterministic"]


def test_a_learned_reward_is_optimised_again_beside_its_training(made):
    bench, _ = made
    spec = RunSpec(NOISE, optimizer=Optimizer.DQN, dqn_tasks=1, budget=0.001)
    shares: list[float] = []
    again = run(spec, bench, tell=shares.append)
    assert again.folder.path == spec.training.folder(bench.place.out, bench.benchmark).path
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert [row["n"] for row in again.results.splits().values()] == [1, 1, 1]
    summary = json.loads((again.folder.path / "dqn.json").read_text())
    assert summary["splits"] == again.results.splits()
    assert read_results(spec, again.folder).splits() == again.results.splits()
    told: list[float] = []
    assert run(spec, bench, tell=told.append).results.splits() == again.results.splits()
    assert told == [], "what was done is read back"


def test_a_policy_has_no_reward_to_optimise(tmp_path):
    spec = RunSpec("idler", code=Idler, optimizer=Optimizer.DQN)
    with pytest.raises(UsageError, match="no reward that DQN could optimise"):
        run(spec, tiny_session(tmp_path))
