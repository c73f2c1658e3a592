"""What a built benchmark promises: proved tasks, splits as in the paper, one fingerprint."""

import pickle
from dataclasses import replace

import pytest
import torch
from benchmark_samples import CONFIG, SEEDS, tiny_benchmark
from house_samples import two_rooms

from lcrl_bench.benchmarks.build import (
    TaskCount,
    build_benchmark,
    join_houses,
    random_streams,
)
from lcrl_bench.benchmarks.built_house import build_house
from lcrl_bench.benchmarks.check import check_benchmark
from lcrl_bench.benchmarks.description import classes_of, describe_benchmark
from lcrl_bench.benchmarks.document import read_benchmark, write_benchmark
from lcrl_bench.benchmarks.grammar import tokens
from lcrl_bench.benchmarks.proof import MAX_RANDOM_SUCCESS
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.houses.procedural import generate_house


@pytest.fixture(scope="module")
def benchmark():
    return tiny_benchmark()


def test_every_split_and_kind_has_tasks(benchmark):
    for kind in Kind:
        assert benchmark.select(split=Split.TRAIN, kind=kind)
        assert benchmark.select(split=Split.TEST_HOUSE, kind=kind)
    assert benchmark.select(split=Split.TEST_TASK)


def test_test_houses_occur_nowhere_else(benchmark):
    test = set(benchmark.houses_of(Split.TEST_HOUSE))
    assert test.isdisjoint(benchmark.houses_of(Split.TRAIN))
    assert set(benchmark.houses_of(Split.TEST_TASK)) <= set(benchmark.houses_of(Split.TRAIN))


def test_a_sentence_occurs_once_in_a_house(benchmark):
    pairs = [(task.house, task.command) for task in benchmark.tasks]
    assert len(set(pairs)) == len(pairs)


def test_every_word_of_a_test_command_is_trained(benchmark):
    for task in benchmark.tasks:
        assert set(tokens(task.command)) <= set(benchmark.vocabulary)


def test_every_task_is_solvable_in_time_and_not_by_chance(benchmark):
    for task in benchmark.tasks:
        assert 0 < task.proof.optimal_length <= benchmark.semantics.horizon
        assert task.proof.random_success <= MAX_RANDOM_SUCCESS


def test_a_moved_object_is_the_only_one_of_its_class_and_ends_elsewhere(benchmark):
    for task in benchmark.select(kind=Kind.PICK):
        house = benchmark.houses[task.house]
        moved, placement = task.carried()
        label = house.object(moved).label
        assert sum(thing.label == label for thing in house.objects) == 1
        assert placement.support != house.object(moved).support
        assert placement.size == house.object(moved).size


def test_the_check_proves_what_was_built(benchmark):
    checked, failures = check_benchmark(benchmark, renderer="rays")
    assert checked == len(benchmark.tasks)
    assert failures == []


def test_the_check_finds_a_task_whose_proof_was_changed(benchmark):
    first = benchmark.tasks[0]
    forged = replace(first, proof=replace(first.proof, optimal_length=1))
    tampered = replace(benchmark, tasks=(forged, *benchmark.tasks[1:]))
    _, failures = check_benchmark(tampered, houses=(first.house,), renderer="rays")
    assert [failure.subject for failure in failures] == [first.id]
    assert "its stored proof" in failures[0].reason


def test_the_check_finds_a_test_house_that_is_trained_in(benchmark):
    leak = replace(benchmark.select(split=Split.TEST_HOUSE)[0], split=Split.TRAIN)
    others = tuple(task for task in benchmark.tasks if task.id != leak.id)
    _, failures = check_benchmark(replace(benchmark, tasks=(*others, leak)), houses=())
    assert any(failure.subject == leak.house for failure in failures)


def test_building_again_gives_the_same_fingerprint_and_another_seed_another(benchmark):
    houses = [generate_house(seed, rooms=4) for seed in SEEDS]
    again = build_benchmark(houses[::-1], CONFIG, renderer="rays")
    assert again.fingerprint == benchmark.fingerprint
    other = build_benchmark(houses[:1], replace(CONFIG, seed=1), renderer="rays")
    first = build_benchmark(houses[:1], CONFIG, renderer="rays")
    assert other.fingerprint != first.fingerprint


def test_houses_built_one_by_one_in_any_order_give_the_same_benchmark(benchmark):
    houses = [generate_house(seed, rooms=4) for seed in SEEDS]
    rng, streams = random_streams([house.id for house in houses], CONFIG.seed)
    built = []
    for house in houses[::-1]:
        # As it comes back from another process.
        generator = pickle.loads(pickle.dumps(streams[house.id]))
        made = build_house(
            house,
            CONFIG.semantics,
            nav=CONFIG.nav,
            pick=CONFIG.pick,
            rng=generator,
            renderer="rays",
        )
        built.append(pickle.loads(pickle.dumps(made)))
    assert join_houses(built, CONFIG, rng).fingerprint == benchmark.fingerprint


def test_the_fingerprint_covers_tasks_houses_grids_and_constants(benchmark):
    name = benchmark.tasks[0].house
    house, grid = benchmark.houses[name], benchmark.grids[name]
    moved = replace(house.objects[0], yaw=house.objects[0].yaw + 1)
    variants = [
        replace(benchmark, tasks=benchmark.tasks[1:]),
        replace(benchmark, semantics=replace(benchmark.semantics, eye_height=1.3)),
        replace(
            benchmark,
            houses={**benchmark.houses, name: replace(house, objects=(moved, *house.objects[1:]))},
        ),
        replace(benchmark, grids={**benchmark.grids, name: replace(grid, tile=0.7)}),
    ]
    found = {variant.fingerprint for variant in (benchmark, *variants)}
    assert len(found) == len(variants) + 1


def test_the_description_counts_what_is_there(benchmark):
    row = describe_benchmark(benchmark)
    assert row["pick"] + row["nav"] == sum(row["splits"].values()) == len(benchmark.tasks)
    assert {"wall", "bed", "void", "window"} <= classes_of(benchmark)


def test_all_that_the_first_run_sees_was_rendered_by_building(tmp_path, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "cache"))
    houses = [generate_house(seed, rooms=4) for seed in SEEDS[:2]]
    write_benchmark(tmp_path / "built", build_benchmark(houses, CONFIG, renderer="rays"))
    built = read_benchmark(tmp_path / "built")
    with monkeypatch.context() as patch:
        patch.setattr("lcrl_bench.scenes.scene.open_renderer", None)
        sets = load_task_sets(built, renderer="rays")
    assert sum(map(len, sets)) == len(built.tasks)
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "empty"))
    for found, fresh in zip(sets, load_task_sets(built, renderer="rays"), strict=True):
        assert torch.equal(found.views.views, fresh.views.views)
        assert torch.equal(found.views.panorama_views, fresh.views.panorama_views)


def test_houses_of_one_name_are_refused():
    with pytest.raises(UsageError, match="Several houses are named"):
        build_benchmark([two_rooms(), two_rooms()], CONFIG, renderer="rays")


def test_a_house_without_anything_to_name_is_an_error():
    bare = replace(two_rooms(furnished=False), rooms=two_rooms().rooms)
    with pytest.raises(NothingSelectedError, match="No house yields a task"):
        build_benchmark([bare], replace(CONFIG, nav=0, pick=4), renderer="rays")


def test_exact_numbers_of_tasks_are_met_or_refused():
    houses = [generate_house(seed, rooms=4) for seed in SEEDS]
    counts = (
        TaskCount(Split.TRAIN, Kind.PICK, 4),
        TaskCount(Split.TEST_HOUSE, Kind.NAV, 1),
    )
    found = build_benchmark(houses, replace(CONFIG, counts=counts), renderer="rays")
    for count in counts:
        assert len(found.select(split=count.split, kind=count.kind)) == count.tasks
    per_house = [len(found.select(house=h, kind=Kind.PICK)) for h in found.houses_of(Split.TRAIN)]
    assert max(per_house) - min(per_house) <= 1, "as even over the houses as can be"
    trained = {word for task in found.select(split=Split.TRAIN) for word in tokens(task.command)}
    assert all(trained.issuperset(tokens(task.command)) for task in found.tasks)
    many = replace(CONFIG, counts=(TaskCount(Split.TRAIN, Kind.NAV, 999),))
    with pytest.raises(NothingSelectedError, match="not 999"):
        build_benchmark(houses, many, renderer="rays")
