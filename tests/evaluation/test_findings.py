"""What a search finds: means over finished seeds on validation houses, the best first."""

from __future__ import annotations

import noise_method
import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run import Run, run
from lcrl_bench.evaluation.search import Search, findings

ONE, TWO, NONE = (("passes", "1"),), (("passes", "2"),), (("passes", "3"),)


@pytest.fixture(scope="module")
def searched(tmp_path_factory) -> tuple[Search, dict[tuple, list[Run]]]:
    """A search with two seeds of one combination and one of another: its runs."""
    home = tmp_path_factory.mktemp("search")
    write_benchmark(home / "tiny", tiny_benchmark())
    noise = f"{noise_method.__file__}:NoiseMethod"
    search = Search(noise, str(home / "tiny"), houses=1, out=str(home / "runs"))
    session = search.session()
    seeds = {ONE: (0, 1), TWO: (0,)}
    return search, {
        settings: [run(search.spec(settings, seed), session) for seed in own]
        for settings, own in seeds.items()
    }


def test_a_finding_is_the_mean_over_the_seeds_that_are_finished(searched):
    search, runs = searched
    found = {each.settings: each for each in findings(search, (ONE, TWO, NONE), (0, 1))}
    assert set(found) == {ONE, TWO}, "nothing of the third is finished"
    for settings, made in runs.items():
        assert found[settings].results.seeds == tuple(each.spec.seed for each in made)
        joined = Results.join([each.results for each in made])
        for split, row in joined.splits().items():
            assert found[settings].success(Split(split)) == row["total"]


def test_the_best_in_the_validation_houses_comes_first(searched):
    search, _ = searched
    scores = [each.score for each in findings(search, (ONE, TWO), (0, 1))]
    assert scores == sorted(scores, reverse=True)
    assert findings(search, (ONE, TWO), (0, 1))[0].score == max(scores)


def test_runs_of_a_search_are_of_the_carved_benchmark_and_evaluate_no_controls(searched):
    search, runs = searched
    for made in (each for some in runs.values() for each in some):
        summary = made.folder.summary()
        assert summary["benchmark"] == "tiny-validation"
        assert summary["fingerprint"] == search.carved().fingerprint
        assert summary["controls"] == {}
        assert made.folder.path.is_relative_to(f"{search.out}/tiny-validation")
