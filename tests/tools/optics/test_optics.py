"""`python -m tools.optics`: what eye height, pitch and tile size change."""

# A mean over no tasks is None; here there are tasks.
# pyright: reportOptionalOperand=false, reportOperatorIssue=false

import json
from dataclasses import replace

import pytest
from benchmark_samples import SEEDS
from house_samples import two_rooms

from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.benchmarks.projections import Projection
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.cli.main import run_command
from lcrl_bench.errors import ExitCode, NothingSelectedError
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.semantics import DEFAULT_SEMANTICS
from tools.optics.command import PROGRAM, main
from tools.optics.measurement import measure_optics

UP = replace(DEFAULT_SEMANTICS, pitch=1.2)


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


def test_a_house_without_tasks_counts_for_its_tiles_and_views_alone():
    house, bare = generate_house(SEEDS[0], rooms=4), two_rooms(furnished=False)
    (alone,) = measure_optics([house], [DEFAULT_SEMANTICS], nav=0, pick=1)
    (both,) = measure_optics([house, bare], [DEFAULT_SEMANTICS], nav=0, pick=1)
    assert (both.houses, both.tasks) == (2, alone.tasks)
    assert both.solved == alone.solved
    assert both.tiles == (alone.tiles + Scene(bare).grid.tiles) / 2
    assert both.unique_views != alone.unique_views


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
    words += ["--houses", str(tmp_path)]
    assert main([*words, "--json"]) == ExitCode.DONE
    rows = json.loads(capsys.readouterr().out)["variants"]
    pairs = [(row["eye_height"], row["pitch"]) for row in rows]
    assert pairs == [(1.25, -0.26), (1.25, -0.4), (1.5, -0.26), (1.5, -0.4)]
    assert all(set(row["solved"]["pick"]) == set(Projection) for row in rows)
    assert main(words) == ExitCode.DONE
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
    assert run_command(main, words, program=PROGRAM) == ExitCode.USAGE
    assert said in capsys.readouterr().err
