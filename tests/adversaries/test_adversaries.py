"""Who tries to score without seeing or listening ends at chance, or is refused."""

from __future__ import annotations

from pathlib import Path

import adversaries as they
import pytest
import torch
from benchmark_samples import TrueRewardBySight, tiny_benchmark, tiny_task_sets
from board_samples import make_desk

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.evaluation.harness import ConstantReward, evaluate, own_command
from lcrl_bench.evaluation.independence import dependence_of
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.methods.contract import Panoramas, Policy, Reward
from lcrl_bench.methods.tensors import TensorReward
from lcrl_bench.storage import sha256_of

MARGIN = 0.1
"""Of 13 and 8 tasks: one more may be passed on the way."""


class Chance(TensorReward):
    """A reward of what is seen that is drawn by lot: it knows nothing, and leads somewhere."""

    def __init__(self, seed: int) -> None:
        self.seed = str(seed)

    def score(self, views: Panoramas, commands) -> torch.Tensor:
        names = [sha256_of(view.tobytes()) for view in views.views.numpy()]
        lots = [
            int(sha256_of("".join([self.seed, *(names[k] for k in row)]).encode())[:8], 16)
            for row in views.panorama_views.tolist()
        ]
        return they.per_panorama(torch.tensor(lots), commands)


def success(learned: Reward | Policy, kind: Kind) -> float:
    found = [o.success for o in evaluate(learned, tiny_task_sets()) if o.task.kind == kind]
    return sum(found) / len(found)


@pytest.fixture(scope="module")
def chance() -> dict[Kind, float]:
    """The luckiest of ten rewards drawn by lot."""
    return {kind: max(success(Chance(seed), kind) for seed in range(10)) for kind in Kind}


@pytest.mark.parametrize(
    "learned",
    [
        they.LastThird(),
        they.HighNumbers(),
        they.ViewNumbers(),
        they.Memory(),
        they.Lookup(tiny_benchmark()),
        they.CallCounter(),
        they.Numbered(),
        they.Vandal(),
    ],
    ids=lambda each: type(each).__name__,
)
@pytest.mark.parametrize("kind", Kind)
def test_who_reads_numbers_names_or_memory_ends_at_chance(learned, kind, chance):
    assert success(learned, kind) <= chance[kind] + MARGIN


def test_no_house_is_called_by_a_name_the_benchmark_has():
    learned = they.Lookup(tiny_benchmark())
    evaluate(learned, tiny_task_sets())
    assert learned.found == 0


@pytest.mark.parametrize(
    ("learned", "reason"),
    [
        (they.CallCounter(), "how often it is asked"),
        (they.Lottery(), "how often it is asked"),
        (they.HighNumbers(), "how often it is asked|the order of what is asked"),
        (they.LastThird(), "the order of what is asked"),
        (they.ViewNumbers(), "the order of what is asked"),
        (they.Numbered(), "the order of what is asked"),
        (they.Twins(), "what else is asked"),
        (they.Company(tiny_benchmark()), "what else is asked"),
    ],
    ids=lambda each: type(each).__name__ if isinstance(each, (Reward, Policy)) else "",
)
def test_whose_answers_depend_on_more_than_what_is_seen_and_said_is_found_out(learned, reason):
    sentences = [own_command, *language_controls(tiny_task_sets()).values()]
    found = set()
    for house in by_house(tiny_task_sets()):
        tasks = [task for tasks in house for task in tasks.tasks]
        said = [text for task in tasks for of in sentences if (text := of(task)) is not None]
        generator = torch.Generator().manual_seed(0)
        found.add(dependence_of(learned, house[0].views.observed, said, generator=generator))
    assert found & set(reason.split("|"))


def test_who_paints_over_what_it_is_shown_harms_nobody_else():
    before = evaluate(ConstantReward(), tiny_task_sets())
    evaluate(they.Vandal(), tiny_task_sets())
    assert evaluate(ConstantReward(), tiny_task_sets()) == before
    truth = TrueRewardBySight(tiny_task_sets())
    assert min(outcome.success for outcome in evaluate(truth, tiny_task_sets())) > 0.99


def test_a_row_of_a_method_that_compares_what_it_is_shown_is_disputed(tmp_path: Path):
    file = Path(__file__).with_name("twin_method.py")
    desk = make_desk(tmp_path, f"{file}:TwinMethod", settings={})
    found = desk.verify(method=f"{file}:TwinMethod")
    assert found.verdict == "disputed"
    assert {each.where.split(".")[-1] for each in found.differences} == {"answers"}
    assert "depend on what else is asked" in str(found.differences[0].found)


@pytest.mark.parametrize(
    "learned",
    [they.Burglar(), TrueRewardBySight(tiny_task_sets())],
    ids=["reads the harness's memory", "carries the public tasks with it"],
)
def test_what_a_process_can_not_be_kept_from_is_a_limit_that_the_docs_name(learned):
    """If this fails, the limit is gone: take it out of `docs/metrics.md`."""
    assert success(learned, Kind.NAV) > 0.9
