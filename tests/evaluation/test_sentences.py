"""What a typed sentence says."""

from __future__ import annotations

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.evaluation.sentences import Meaning, parse_sentence, unknown_words


def test_every_command_of_a_benchmark_parses_to_its_own_task():
    benchmark = tiny_benchmark()
    for task in benchmark.tasks:
        thing = None if task.placement is None else task.placement.label
        assert parse_sentence(task.command) == Meaning(task.kind, task.target, thing)


@pytest.mark.parametrize("sentence", ["Go to the LIVING room!", "go to living room"])
def test_case_punctuation_and_articles_do_not_matter(sentence):
    assert parse_sentence(sentence) == Meaning(Kind.NAV, "living room")


@pytest.mark.parametrize(
    "sentence", ["find the bed", "go to the moon", "move the moon to the bed", "move the cup", ""]
)
def test_what_the_grammar_does_not_have_means_nothing(sentence):
    assert parse_sentence(sentence) is None


def test_unknown_words_come_with_the_nearest_known_one_where_one_is_near():
    words = ("bedroom", "cup", "move", "the", "to")
    found = unknown_words("Move the mug to the bedrom, xyzzy", words)
    assert found == {"mug": None, "bedrom": "bedroom", "xyzzy": None}
    assert unknown_words("move the cup to the bedroom", words) == {}
