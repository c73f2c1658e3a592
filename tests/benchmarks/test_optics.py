"""What is measured of the cameras: laws of projected rewards, and what height and tilt change."""

# A mean over no task is None; here there are tasks.
# pyright: reportOptionalOperand=false, reportOperatorIssue=false

import json
from dataclasses import replace

import pytest
import torch
from benchmark_samples import SEEDS, tiny_benchmark
from house_samples import two_rooms
from lcrl_bench.benchmarks.compiled import compile_house

from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.benchmarks.optics import measure_optics
from lcrl_bench.benchmarks.projections import (
    Projection,
    alike,
    episode_weights,
    project_reward,
    success_by_sight,
)
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode, NothingSelectedError
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.mdp.success import distance_to_goal
from lcrl_bench.semantics import DEFAULT_SEMANTICS

UP = replace(DEFAULT_SEMANTICS, pitch=1.2)


@pytest.fixture(scope="module")
def compiled():
    benchmark = tiny_benchmark()
    return compile_house(benchmark, next(iter(benchmark.houses)), renderer="rays")


@pytest.fixture(scope="module", params=list(Kind))
def tasks(compiled, request):
    (found,) = [one for one in compiled.sets if one.tasks[0].kind == request.param]
    return found


@pytest.mark.parametrize("projection", list(Projection))
def test_what_looks_alike_is_paid_alike(compiled, tasks, projection):
    paid = project_reward(compiled, tasks, DEFAULT_SEMANTICS, projection)
    looks = alike(compiled, tasks)
    for row in range(len(looks)):
        for look in looks[row].unique():
            assert len(paid[row][looks[row] == look].unique()) == 1
    assert paid.min() >= 0
    assert paid.max() <= DEFAULT_SEMANTICS.success_reward


def test_what_looks_like_nothing_else_is_paid_its_true_reward(compiled, tasks):
    looks = alike(compiled, tasks)
    possible = episode_weights(tasks.batch) > 0
    compared = 0
    for projection in Projection:
        paid = project_reward(compiled, tasks, DEFAULT_SEMANTICS, projection)
        for row in range(len(looks)):
            single = torch.bincount(looks[row])[looks[row]] == 1
            single &= possible[row]
            truth = tasks.batch.goal[row][single] * DEFAULT_SEMANTICS.success_reward
            assert torch.equal(paid[row][single], truth.to(paid.dtype))
            compared += int(single.sum())
    assert compared


def test_the_certain_reward_is_the_least_and_is_paid_at_goals_only(compiled, tasks):
    certain = project_reward(compiled, tasks, DEFAULT_SEMANTICS, Projection.CERTAIN)
    mean = project_reward(compiled, tasks, DEFAULT_SEMANTICS, Projection.CELLS)
    assert (certain <= mean).all()
    assert (certain[~tasks.batch.goal] == 0).all()
    assert (certain > 0).any()


def test_counting_each_cell_once_is_the_mean_over_equal_panoramas(compiled, tasks):
    mean = project_reward(compiled, tasks, DEFAULT_SEMANTICS, Projection.CELLS)
    for row in range(tasks.batch.tasks):
        paid: dict[bytes, list[float]] = {}
        looks = [compiled.store.panorama_views[p].tobytes() for p in tasks.panoramas[row]]
        for look, goal in zip(looks, tasks.batch.goal[row].tolist(), strict=True):
            paid.setdefault(look, []).append(10.0 * goal)
        expected = [sum(paid[look]) / len(paid[look]) for look in looks]
        assert mean[row].tolist() == pytest.approx(expected, abs=1e-9)


def test_the_certain_reward_solves_a_task_just_where_a_proof_can_be_seen_in_time(compiled, tasks):
    certain = project_reward(compiled, tasks, DEFAULT_SEMANTICS, Projection.CERTAIN) > 0
    distance = distance_to_goal(replace(tasks.batch, goal=certain))
    steps = distance.gather(1, tasks.batch.start[:, None]).squeeze(1)
    provable = (steps >= 0) & (steps <= tasks.batch.horizon)
    success = success_by_sight(compiled, tasks, DEFAULT_SEMANTICS, Projection.CERTAIN)
    assert torch.equal(success >= 1 - 1e-9, provable)


def test_a_cell_weighs_as_many_steps_as_are_left_when_it_is_reached(compiled, tasks):
    batch = tasks.batch
    weights = episode_weights(batch)
    start = batch.start // 4
    for row in range(batch.tasks):
        goal = torch.zeros_like(batch.goal)
        for cell in (int(start[row]), int(weights[row].argmax()), batch.cells - 1):
            goal.zero_()[row, cell] = True
            steps = int(distance_to_goal(replace(batch, goal=goal))[row, batch.start[row]])
            left = max(batch.horizon + 1 - steps, 0) if steps >= 0 else 0
            # A way found needs `steps` actions; each of four headings fits the rest at most.
            assert bool(weights[row, cell] > 0) == (left > 0)
            assert weights[row, cell] <= 4 * left


def test_the_weights_of_one_step_count_what_one_action_leads_to(compiled, tasks):
    batch = replace(tasks.batch, horizon=1)
    weights = episode_weights(batch)
    for row in range(batch.tasks):
        first = int(batch.start[row])
        after = set(batch.next_state[row, first].tolist())
        expected = torch.zeros(batch.cells, dtype=weights.dtype)
        for state in [first, *after]:
            expected[state // 4] += 1
        assert torch.equal(weights[row], expected)


def test_eyes_on_the_ceiling_see_nothing_that_is_moved():
    house = generate_house(SEEDS[0], rooms=4)
    ahead, up = measure_optics([house], [DEFAULT_SEMANTICS, UP], nav=2, pick=4)
    assert ahead.tasks == up.tasks
    assert ahead.tiles == up.tiles, "pitch decides neither where one stands nor the tasks"
    assert up.pixels[ObjectState.AT_B] == 0
    assert up.seen_from_some[ObjectState.AT_B] == 0
    assert up.solved[Kind.PICK][Projection.CERTAIN] == 0
    assert ahead.solved[Kind.PICK][Projection.CERTAIN] > 0
    assert ahead.pixels[ObjectState.AT_B] > 0
    assert ahead.seen_from_some[ObjectState.AT_B] >= ahead.seen_from_all[ObjectState.AT_B]
    assert up.unique_views < ahead.unique_views, "ceilings look alike"


def test_measuring_again_gives_the_same_and_another_seed_other_tasks():
    houses = [generate_house(SEEDS[0], rooms=4)]
    first, again = (measure_optics(houses, [DEFAULT_SEMANTICS], nav=3, pick=3) for _ in range(2))
    assert first == again
    other = measure_optics(houses, [DEFAULT_SEMANTICS], nav=3, pick=3, seed=1)
    assert other != first


def test_smaller_tiles_make_more_of_them():
    house = generate_house(SEEDS[0], rooms=4)
    small = replace(DEFAULT_SEMANTICS, tile=0.6)
    usual, finer = measure_optics([house], [DEFAULT_SEMANTICS, small], nav=1, pick=1)
    assert finer.tiles > usual.tiles


def test_no_house_no_variant_and_no_task_are_errors():
    with pytest.raises(NothingSelectedError, match="at least one"):
        measure_optics([], [DEFAULT_SEMANTICS])
    with pytest.raises(NothingSelectedError, match="at least one"):
        measure_optics([two_rooms()], [])
    with pytest.raises(NothingSelectedError, match="yield no task"):
        measure_optics([two_rooms()], [DEFAULT_SEMANTICS], nav=0, pick=0)


def test_the_command_measures_every_combination(tmp_path, capsys):
    write_house(tmp_path / "house.json", generate_house(SEEDS[0], rooms=4))
    words = ["--eye-height", "1.25", "1.5", "--pitch", "-0.26", "-0.4", "--nav", "2", "--pick", "2"]
    verb = ["benchmark", "optics", "--houses", str(tmp_path), *words]
    assert main([*verb, "--json"]) == ExitCode.DONE
    rows = json.loads(capsys.readouterr().out)["variants"]
    pairs = [(row["eye_height"], row["pitch"]) for row in rows]
    assert pairs == [(1.25, -0.26), (1.25, -0.4), (1.5, -0.26), (1.5, -0.4)]
    assert all(set(row["solved"]["pick"]) == set(Projection) for row in rows)
    assert main(verb) == ExitCode.DONE
    table = capsys.readouterr().out
    assert "certain" in table
    assert table.count("0.75") >= len(rows)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "--houses DIR or --seeds"),
        (["--seeds", "1", "--pitch", "7"], "--pitch 7"),
        (["--seeds", "1", "--eye-height", "0"], "--eye-height 0"),
        (["--seeds", "1", "--tile", "nan"], "--tile nan"),
    ],
)
def test_a_wrong_flag_is_named(words, said, capsys):
    assert main(["benchmark", "optics", *words]) == ExitCode.USAGE
    assert said in capsys.readouterr().err
