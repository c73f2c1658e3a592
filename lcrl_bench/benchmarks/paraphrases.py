"""Held-out paraphrases of the grammar's sentences.

No training command has any of these forms: each is built on a verb that the grammar lacks, and
most add other new words; names are shared, and "the" and "to" may be. The lists are frozen with the
grammar. Changing one changes the results of the `paraphrase` control, so a new list needs a new
version number in its name, and its results must be reported next to the old ones.
"""

from __future__ import annotations

from lcrl_bench.benchmarks.grammar import words_of
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.storage import sha256_of

NAV_FORMS = (
    "please walk to the {target}",
    "head over to the {target}",
    "find the {target}",
    "i would like you next to the {target}, if you can get there",
    "could you make your way towards the {target}?",
    "the {target} is where you should be",
)
"""Held-out sentences that mean "go to the target"."""

PICK_FORMS = (
    "bring the {thing} over to the {target}",
    "please carry the {thing} to the {target}",
    "the {thing} belongs at the {target}",
    "take the {thing} and put it down by the {target}",
    "could you fetch the {thing} and leave it at the {target}?",
    "i want the {thing} placed where the {target} is",
)
"""Held-out sentences that mean "move the thing to the target"."""


def paraphrases(task: Task) -> tuple[str, ...]:
    """Every held-out sentence with the meaning of a task's command."""
    target = words_of(task.target)
    if task.kind == Kind.NAV:
        return tuple(form.format(target=target) for form in NAV_FORMS)
    thing = words_of(task.carried()[1].label)
    return tuple(form.format(thing=thing, target=target) for form in PICK_FORMS)


def paraphrase(task: Task) -> str:
    """One held-out sentence for a task, determined by the task's id alone."""
    every = paraphrases(task)
    return every[int(sha256_of(task.id.encode())[:15], 16) % len(every)]
