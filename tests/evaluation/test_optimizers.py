"""Re-optimisation by DQN: what is chosen is what is solved, whatever else is chosen."""

import pytest
import torch
from benchmark_samples import TrueRewardBySight, tiny_benchmark, tiny_task_sets

from lcrl_bench.benchmarks.projections import Projection
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation import optimizers
from lcrl_bench.evaluation.harness import ConstantReward
from lcrl_bench.evaluation.optimizers import evaluate_with_dqn, sample_tasks
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.methods.tensors import TensorPolicy

BRIEF = DqnConfig(steps=300, episodes=5, hidden=8, replay=200, target_interval=10)


def seeded(seed=0):
    return torch.Generator().manual_seed(seed)


def true_reward() -> TrueRewardBySight:
    return TrueRewardBySight(tiny_task_sets(), Projection.CERTAIN)


def test_shaped_by_true_values_tasks_of_real_houses_are_solved():
    sets = tiny_task_sets()
    chosen = sample_tasks(sets, 2, seeded())
    config = DqnConfig(steps=12_000, replay=12_000)
    outcomes = evaluate_with_dqn(true_reward(), sets, config, generator=seeded(), chosen=chosen)
    assert sum(outcome.success for outcome in outcomes) / len(outcomes) >= 0.6


def test_every_chosen_task_comes_once_in_order():
    sets = tiny_task_sets()
    every = evaluate_with_dqn(ConstantReward(), sets, BRIEF, generator=seeded())
    order = [task.id for tasks in sets for task in tasks.tasks]
    assert [outcome.task.id for outcome in every] == order
    assert all(0.0 <= outcome.success <= 1.0 for outcome in every)


def test_what_comes_of_a_task_does_not_depend_on_the_others(monkeypatch):
    sets = tiny_task_sets()
    chosen = sample_tasks(sets, 2, seeded())
    every = evaluate_with_dqn(true_reward(), sets, BRIEF, generator=seeded(4))
    monkeypatch.setattr(optimizers, "TASKS_AT_ONCE", 3)
    some = evaluate_with_dqn(true_reward(), sets, BRIEF, generator=seeded(4), chosen=chosen)
    assert list(some) == [outcome for outcome in every if outcome.task.id in chosen]


def test_progress_counts_to_the_end():
    told = []
    sets = tiny_task_sets()
    chosen = sample_tasks(sets, 1, seeded())
    evaluate_with_dqn(
        ConstantReward(),
        sets,
        BRIEF,
        generator=seeded(),
        chosen=chosen,
        progress=lambda done, total: told.append((done, total)),
    )
    counts = [done for done, _ in told]
    assert counts == sorted(set(counts))
    assert {total for _, total in told} == {BRIEF.rounds}
    assert 0 < counts[0] <= counts[-1] == BRIEF.rounds


def test_a_subset_takes_as_many_of_each_split_and_is_named_by_its_seed():
    sets = tiny_task_sets()
    by_id = {task.id: task for task in tiny_benchmark().tasks}
    first, again, other = (sample_tasks(sets, 3, seeded(seed)) for seed in (1, 1, 2))
    assert first == again != other
    for split in Split:
        assert sum(by_id[key].split == split for key in first) == 3
    assert len(sample_tasks(sets, 10_000, seeded())) == len(by_id), "all there are"


class Idle(TensorPolicy):
    def logits(self, views, commands):
        return torch.zeros(len(commands), len(views), 2, 4, 4)


def test_a_policy_is_refused_and_so_is_nothing():
    sets = tiny_task_sets()
    with pytest.raises(UsageError, match="no reward that DQN could optimise"):
        evaluate_with_dqn(Idle(), sets, BRIEF, generator=seeded())
    with pytest.raises(UsageError, match="None of the chosen tasks is in this benchmark"):
        evaluate_with_dqn(ConstantReward(), sets, BRIEF, generator=seeded(), chosen=())
    with pytest.raises(UsageError, match="at least 1 task"):
        sample_tasks(sets, 0, seeded())
