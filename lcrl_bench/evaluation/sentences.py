"""Typed sentences: their meaning by the preset grammar, and words a model doesn't know.

Only the true goal depends on the parse; a learned reward gets the sentence verbatim.
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
"""The taxonomy whose words for objects and rooms are known."""
_ALIKE = 0.77
"""Minimum spelling similarity of two words; excludes "over" and "move"."""


@dataclass(frozen=True)
class Meaning:
    """The meaning of a sentence of the grammar; a house need not have what it names."""

    kind: Kind
    target: str
    """Class name or room type to go to, or to move the object to."""
    thing: str | None = None
    """PICK: class name of the object to move."""


def parse_sentence(sentence: str) -> Meaning | None:
    """Parse "go to X" or "move X to Y", ignoring case, punctuation and "the".

    Returns:
        None for any other sentence, or if X or Y is not a name a command can have.
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
    """Maps the words of every name a command can have to the name."""
    rooms = {kind.value: kind.value for kind in NAMED_ROOMS}
    return {**{words_of(name): name for name in named_classes()}, **rooms}


def known_words(learned: Reward | Policy, otherwise: Iterable[str]) -> tuple[str, ...]:
    """The words a model was trained with.

    Args:
        learned: A model; those of this suite carry their vocabulary.
        otherwise: The words of the training commands, for models that don't.
    """
    vocabulary = getattr(learned, "vocabulary", None)
    return vocabulary.words if isinstance(vocabulary, Vocabulary) else tuple(otherwise)


def unknown_words(sentence: str, known: Iterable[str]) -> dict[str, str | None]:
    """The words of a sentence that a model doesn't know, each with the nearest known one.

    The nearest is a word of the same meaning, according to the names in house files ("mug" is a
    cup), or else one of similar spelling.

    Returns:
        Word → nearest known words, or None; in the order of the sentence.
    """
    words = sorted(known)
    return {word: _nearest(word, words) for word in _written(sentence) if word not in words}


def nothing_known(sentence: str, known: Iterable[str]) -> bool:
    """Whether a sentence has no word that a model knows."""
    return set(tokens(sentence)).isdisjoint(known)


def _written(sentence: str) -> list[str]:
    """The words as written, in any script; models only know the Latin alphabet."""
    return re.findall(r"[^\W_]+", sentence.lower())


def _nearest(word: str, known: Sequence[str]) -> str | None:
    taxonomy = load_taxonomy(_TAXONOMY)
    room = taxonomy.rooms.get(word, RoomType.OTHER)
    for meant in (taxonomy.classify(word), room.value if room in NAMED_ROOMS else None):
        words = words_of(meant) if meant else ""
        if words and words != word and set(words.split()) <= set(known):
            return words
    return next(iter(difflib.get_close_matches(word, known, n=1, cutoff=_ALIKE)), None)
