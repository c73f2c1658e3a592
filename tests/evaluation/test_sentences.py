"""What a typed sentence says."""

from __future__ import annotations

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.asked_task import clean_sentence
from lcrl_bench.evaluation.sentences import Meaning, nothing_known, parse_sentence, unknown_words


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


WORDS = ("bedroom", "cup", "living", "move", "plate", "refrigerator", "room", "the", "to")


@pytest.mark.parametrize(
    ("word", "near"),
    [
        ("bedrom", "bedroom"),
        ("cups", "cup"),
        ("mug", "cup"),
        ("Fridge", "refrigerator"),
        ("livingroom", "living room"),
        ("corridor", None),
        ("over", None),
        ("please", None),
        ("été", None),
        ("卧室", None),
    ],
)
def test_an_unknown_word_comes_with_what_means_the_same_or_is_spelt_alike(word, near):
    assert unknown_words(f"Move the {word}, to the cup", WORDS) == {word.lower(): near}


def test_words_that_were_told_are_not_unknown_and_signs_are_no_words():
    assert unknown_words("move the cup to the bedroom 🙂 ...", WORDS) == {}


@pytest.mark.parametrize("sentence", ["卧室", "🙂", "va al dormitorio", "?"])
def test_a_sentence_of_other_words_only_says_nothing(sentence):
    assert nothing_known(sentence, WORDS)
    assert not nothing_known(f"{sentence} cup", WORDS)


def test_spaces_are_made_single():
    assert clean_sentence(" go to\n\tthe  bed ") == "go to the bed"
    assert clean_sentence("the 👨‍👩‍👧 of the حمّام") == "the 👨‍👩‍👧 of the حمّام"


@pytest.mark.parametrize("letter", ["\x1b", "\x00", "\u202e", "\u2066", "\udcff", "\x9b"])
def test_what_a_terminal_would_obey_is_refused(letter):
    with pytest.raises(UsageError, match="can't contain control characters"):
        clean_sentence(f"go to {letter}the bed")


@pytest.mark.parametrize("sentence", ["", " \n ", "x" * 201])
def test_a_sentence_is_neither_empty_nor_endless(sentence):
    with pytest.raises(UsageError, match="A sentence needs 1 to 200 characters"):
        clean_sentence(sentence)
