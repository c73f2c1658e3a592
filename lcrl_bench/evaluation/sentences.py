"""What a typed sentence says: its meaning by the preset grammar, and words a model doesn't know.

Only the truth about a sentence rests on its parse; a learned reward is given the sentence as it is.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from lcrl_bench.benchmarks.grammar import NAMED_ROOMS, named_classes, tokens, words_of
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.houses.house import RoomType
from lcrl_bench.houses.taxonomy import load_taxonomy
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.networks.vocabulary import Vocabulary

_NAV = re.compile(r"go to (?:the )?(?P<target>.+)")
_PICK = re.compile(r"move (?:the )?(?P<thing>.+?) to (?:the )?(?P<target>.+)")
_TAXONOMY = "procthor"
"""Whose words for things and rooms are known."""
_ALIKE = 0.77
"""Share of letters in common from which two words are spelt alike: not "over" and "move"."""


@dataclass(frozen=True)
class Meaning:
    """What a sentence of the grammar asks for; nothing says that a house has it."""

    kind: Kind
    target: str
    """Class name or room type to go to, or to move the thing to."""
    thing: str | None = None
    """PICK: class name of what is to be moved."""


def parse_sentence(sentence: str) -> Meaning | None:
    """Read "go to X" or "move X to Y", case, punctuation and "the" aside.

    Returns:
        None for any other sentence, and where X or Y is no name a command can have.
    """
    text, names = " ".join(tokens(sentence)), _names()
    for pattern, kind in ((_NAV, Kind.NAV), (_PICK, Kind.PICK)):
        found = pattern.fullmatch(text)
        if found is not None:
            named = {key: names.get(words) for key, words in found.groupdict().items()}
            target, thing = named["target"], named.get("thing")
            if target is not None and (kind == Kind.NAV or thing is not None):
                return Meaning(kind, target, thing)
    return None


def _names() -> dict[str, str]:
    """The words of every name a command can have, and the name."""
    rooms = {kind.value: kind.value for kind in NAMED_ROOMS}
    return {**{words_of(name): name for name in named_classes()}, **rooms}


def known_words(learned: Reward | Policy, otherwise: Iterable[str]) -> tuple[str, ...]:
    """The words a model was trained with.

    Args:
        learned: A model; those of this suite carry their vocabulary.
        otherwise: The words of the training commands, for one that doesn't.
    """
    vocabulary = getattr(learned, "vocabulary", None)
    return vocabulary.words if isinstance(vocabulary, Vocabulary) else tuple(otherwise)


def unknown_words(sentence: str, known: Iterable[str]) -> dict[str, str | None]:
    """The words of a sentence that a model was never told, each with the nearest it was.

    Nearest is what means the same, as far as the names that house files use tell ("mug" is a cup),
    or else what is spelt alike.

    Returns:
        Word → nearest known words, None where none are near; in the order of the sentence.
    """
    words = sorted(known)
    return {word: _nearest(word, words) for word in _written(sentence) if word not in words}


def nothing_known(sentence: str, known: Iterable[str]) -> bool:
    """Whether a sentence has no word that a model was told."""
    return set(tokens(sentence)).isdisjoint(known)


def _written(sentence: str) -> list[str]:
    """The words as they are written, in any script: a model's own are of the Latin alphabet."""
    return re.findall(r"[^\W_]+", sentence.lower())


def _nearest(word: str, known: Sequence[str]) -> str | None:
    taxonomy = load_taxonomy(_TAXONOMY)
    room = taxonomy.rooms.get(word, RoomType.OTHER)
    for meant in (taxonomy.classify(word), room.value if room in NAMED_ROOMS else None):
        words = words_of(meant) if meant else ""
        if words and words != word and set(words.split()) <= set(known):
            return words
    return next(iter(difflib.get_close_matches(word, known, n=1, cutoff=_ALIKE)), None)
