"""Tasks side by side: padding is never reached, and no two states look alike to an agent."""

import pytest
import torch
from mdp_samples import corridor, random_batch
from task_samples import sample_train_set

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.dqn.stack import TaskStack, object_states


def house_batches():
    return list(sample_train_set(0).tasks)


def test_padding_leads_to_itself_and_nothing_leads_there():
    batches = house_batches()
    stack = TaskStack.of(batches)
    first = 0
    for batch in batches:
        for row in range(first, first + len(batch)):
            real, padding = stack.next_state[row, : batch.states], stack.next_state[row]
            assert torch.equal(real, batch.next_state[row - first])
            assert int(real.max()) < batch.states
            beyond = torch.arange(batch.states, stack.states)
            assert torch.equal(padding[batch.states :], beyond[:, None].expand(-1, 4))
        first += len(batch)
    assert first == stack.tasks


def test_every_state_of_a_task_switches_on_other_inputs():
    batches = house_batches()
    stack = TaskStack.of(batches)
    sizes = [batch.states for batch in batches for _ in range(len(batch))]
    for inputs, states in zip(stack.inputs, sizes, strict=True):
        assert len(torch.unique(inputs[:states], dim=0)) == states
        assert int(inputs.max()) < stack.rows


def test_the_object_counts_where_interaction_does_something():
    nav, pick = house_batches()[:2]
    assert (object_states(nav), object_states(pick)) == (1, 3)
    assert object_states(random_batch(0, cells=4)) == 1, "no third of four cells"


def test_inputs_tell_heading_object_and_tile_apart():
    nav, pick = house_batches()[:2]
    stack = TaskStack.of([nav, pick])
    tiles = nav.cells
    state = (2 * tiles + 5) * 4 + 3
    assert stack.inputs[len(nav), state].tolist() == [3, 4 + 2, 7 + 5]
    assert stack.inputs[0, 5 * 4 + 3].tolist() == [3, 4, 7 + 5]


def test_what_can_not_be_stacked_is_refused():
    with pytest.raises(UsageError, match="no task"):
        TaskStack.of([])
    with pytest.raises(UsageError, match="share horizon and discount"):
        TaskStack.of([corridor(3, goal_cell=2), corridor(3, goal_cell=2, horizon=9)])
