"""Held-out sentences: same meaning, a form that training never has."""

import pytest

from lcrl_bench.benchmarks.catalogue import benchmark_folder, list_benchmarks
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.grammar import tokens, words_of
from lcrl_bench.benchmarks.paraphrases import NAV_FORMS, PICK_FORMS, paraphrase, paraphrases
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.houses.house import RoomType


@pytest.fixture(scope="module", params=list_benchmarks())
def benchmark(request):
    return read_benchmark(benchmark_folder(request.param), verify=False)


def test_no_held_out_form_is_a_training_command(benchmark):
    commands = {tokens(t.command) for t in benchmark.tasks if t.split == Split.TRAIN}
    said = {tokens(sentence) for task in benchmark.tasks for sentence in paraphrases(task)}
    assert commands.isdisjoint(said)


def test_every_form_has_a_word_that_training_never_has(benchmark):
    for form in (*NAV_FORMS, *PICK_FORMS):
        words = set(tokens(form.format(thing="", target="")))
        assert not words <= set(benchmark.vocabulary), form


def test_a_paraphrase_keeps_the_names_and_no_verb_of_the_grammar(benchmark):
    for task in benchmark.tasks:
        for sentence in paraphrases(task):
            words = tokens(sentence)
            assert words_of(task.target) in " ".join(words)
            assert not {"go", "move"} & set(words)
            if task.kind == Kind.PICK:
                assert words_of(task.carried()[1].label) in " ".join(words)


def test_no_form_names_anything_by_itself():
    names = {entry.words for entry in semantic_classes()} | {kind.value for kind in RoomType}
    for form in (*NAV_FORMS, *PICK_FORMS):
        padded = f" {' '.join(tokens(form.format(thing='', target='')))} "
        assert [name for name in names if f" {name} " in padded] == []


def test_every_form_is_told_to_some_task_and_always_the_same_one(benchmark):
    told = {task.id: paraphrase(task) for task in benchmark.tasks}
    assert told == {task.id: paraphrase(task) for task in reversed(benchmark.tasks)}
    for kind, forms in ((Kind.NAV, NAV_FORMS), (Kind.PICK, PICK_FORMS)):
        places = [paraphrases(t).index(told[t.id]) for t in benchmark.tasks if t.kind == kind]
        assert set(places) == set(range(len(forms)))
