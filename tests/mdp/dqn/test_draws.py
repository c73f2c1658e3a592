"""Random numbers that belong to a task: in range, even, the same in any company."""

import pytest
import torch

from lcrl_bench.mdp.dqn.draws import Draws

SEEDS = torch.tensor([0, 1, 2, 1 << 61])


def test_numbers_lie_in_the_unit_interval_and_are_even():
    values = Draws(SEEDS).uniform(40_000)
    assert float(values.min()) >= 0.0
    assert float(values.max()) < 1.0
    for row in values:
        counts = torch.histc(row, bins=20, min=0.0, max=1.0)
        # Chi-squared with 19 degrees of freedom: 55 has a chance of 2e-5.
        assert float(((counts - 2000) ** 2 / 2000).sum()) < 55


def test_a_task_draws_the_same_in_any_company():
    together = Draws(SEEDS)
    first, second = together.uniform(5), together.uniform(3)
    for row, seed in enumerate(SEEDS):
        alone = Draws(seed.view(1))
        assert torch.equal(alone.uniform(5)[0], first[row])
        assert torch.equal(alone.uniform(3)[0], second[row])


@pytest.mark.parametrize("lag", [0, 1, 2, 7])
def test_neighbouring_seeds_are_not_alike_even_if_shifted(lag):
    values = Draws(torch.tensor([5, 6])).uniform(20_000)
    pair = torch.stack([values[0, lag:], values[1, : 20_000 - lag]])
    # The correlation of independent rows has a spread of 0.007.
    assert abs(float(torch.corrcoef(pair)[0, 1])) < 0.035


def test_branches_are_sequences_of_their_own_and_leave_the_trunk_alone():
    trunk, untouched = Draws(SEEDS), Draws(SEEDS)
    first, second = trunk.branch(0).uniform(8), trunk.branch(1).uniform(8)
    values = trunk.uniform(8)
    assert torch.equal(values, untouched.uniform(8))
    assert not any(torch.equal(a, b) for a, b in [(first, second), (first, values)])


def test_whole_numbers_cover_their_range_and_no_more():
    drawn = Draws(SEEDS).below(7, 500)
    for row in drawn:
        assert sorted(set(row.tolist())) == list(range(7))
