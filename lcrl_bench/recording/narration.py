"""An episode in words: a card about the task, and what happens at each step."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import Action, ObjectState
from lcrl_bench.recording.episode import Episode

HEADING_NAMES: Final = ("north", "east", "south", "west")
ACTION_NAMES: Final = {
    Action.FORWARD: "forward",
    Action.LEFT: "turn left",
    Action.RIGHT: "turn right",
    Action.INTERACT: "interact",
}
FAILURE_WORDS: Final = {
    Failure.WAITS_AT_A: "never took the {thing}, and ends where it could have",
    Failure.AT_B_WITHOUT_OBJECT: "never took the {thing}, and ends where it was to be put",
    Failure.ELSEWHERE: "never took the {thing}, and ends elsewhere",
    Failure.PUT_BACK: "took the {thing}, and put it back where it was",
    Failure.HELD_AT_B: "ends where the {thing} was to be put, still holding it",
    Failure.HELD_ELSEWHERE: "ends elsewhere, still holding the {thing}",
}
"""Each way to fail in words; `{thing}` is what was to be moved."""
_LAST_LATIN: Final = "\u017f"
"""The viewer's font has letters up to this one."""
_SEEN: Final = 9
"""Classes listed per view."""


def room_name(episode: Episode, step: int) -> str:
    """The type of the agent's room: `"living room"`."""
    room = episode.scene.grid.rooms[episode.tiles[step]]
    return episode.scene.house.room(room).type.value


def object_phrase(episode: Episode, step: int) -> str:
    """Where the moved object is: `"at A"`, `"in hand"`, `"at B"`; empty for NAV."""
    if episode.task.kind == Kind.NAV:
        return ""
    words = {ObjectState.AT_A: "at A", ObjectState.HELD: "in hand", ObjectState.AT_B: "at B"}
    return words[ObjectState(int(episode.object_states[step]))]


def action_phrase(episode: Episode, step: int) -> str:
    """The agent's action at a step in words, and whether it had no effect."""
    if step >= episode.horizon:
        return "end"
    name = ACTION_NAMES[Action(int(episode.actions[step]))]
    if episode.states[step] == episode.states[step + 1]:
        return "stay" if name == "interact" else f"{name} (blocked)"
    if name == "interact":
        state = ObjectState(int(episode.object_states[step + 1]))
        return (
            f"take the {episode.thing_name}"
            if state == ObjectState.HELD
            else (f"put the {episode.thing_name} at {'B' if state == ObjectState.AT_B else 'A'}")
        )
    return name


def action_word(episode: Episode, step: int) -> str:
    """`action_phrase` without the object: `"take"`, `"turn left"`."""
    phrase = action_phrase(episode, step)
    return phrase.split()[0] if phrase.startswith(("take", "put")) else phrase


def lanes(episode: Episode, step: int) -> dict[str, str]:
    """The states of an episode at a step in a word or two each: room, action, goal, object."""
    words = {"room": room_name(episode, step), "action": action_word(episode, step)}
    if episode.goal_known:
        words["goal"] = "reached" if episode.done[step] else "not yet"
    if episode.task.kind == Kind.PICK:
        words["object"] = object_phrase(episode, step)
    return {lane: plain(word) for lane, word in words.items()}


def plain(text: str) -> str:
    """Replace letters that the viewer may lack by question marks.

    Rerun 0.41 crashes on a letter that its font lacks, and a command may contain any.
    """
    composed = unicodedata.normalize("NFC", text)
    return "".join(
        letter if letter == "\n" or (letter.isprintable() and letter <= _LAST_LATIN) else "?"
        for letter in composed
    )


def run_title(episode: Episode) -> str:
    """Title of a recording: method, benchmark and seed."""
    return plain(f"{episode.method} on {episode.benchmark}, seed {episode.seed}")


def episode_title(episode: Episode) -> str:
    """Title of a picture: command, method and outcome."""
    came = "reached" if episode.success else "not reached"
    if not episode.goal_known:
        came = "not known"
    return f"“{plain(episode.task.command)}” — {episode.method}, goal {came}"


def about(episode: Episode) -> str:
    """A card in Markdown: the command, facts about the task, and its origin."""
    task, proof = episode.task, episode.task.proof
    lines = [
        f"**{task.command}** ({task.kind.value.upper()}, {task.split.value})"
        if episode.fingerprint
        else f"**{task.command}**",
        f"Goal {outcome(episode)}",
        f"**{episode.method}**, seed {episode.seed}, in house {episode.scene.house.id}"
        + (
            f" of {episode.benchmark} ({episode.fingerprint[:12]})." if episode.fingerprint else "."
        ),
    ]
    if episode.goal_known:
        lines.append(
            f"Random actions succeed {_percent(proof.random_success)}; the best return is "
            f"{proof.value:.1f}."
        )
    if episode.reward is None:
        lines.insert(2, "The method learned a policy and no reward: its visits are shown.")
    if failure := episode.failure:
        lines.insert(2, f"It {FAILURE_WORDS[failure].format(thing=episode.thing_name)}.")
    return plain("\n\n".join(lines) + "\n\n---\n\n" + _legend(episode))


def outcome(episode: Episode) -> str:
    """The outcome in Markdown, after "Goal": `"**reached at step 9**; the shortest path ..."`."""
    if not episode.goal_known:
        return "**unknown**: success can't be checked for this sentence"
    reached = np.flatnonzero(episode.done)
    came = f"reached at step {reached[0]}" if episode.success else "not reached"
    shortest = episode.task.proof.optimal_length
    if shortest < 0:
        return f"**{came}**; it can't be reached within {episode.horizon} steps"
    return f"**{came}**; the shortest path takes {shortest} of {episode.horizon} steps"


def _percent(share: float) -> str:
    return "in less than 0.01 %" if share < 1e-4 else f"in {100 * share:.2g} %"


def _legend(episode: Episode) -> str:
    """The meaning of marks and colours."""
    lines = [
        "- **Tiles**: red is low, blue is high; for visits, darker is more. Hover over the "
        "centre of a tile for its numbers.",
        "- **Yellow, with an arrow**: the agent; **black line**: its path.",
    ]
    if episode.task.kind == Kind.PICK:
        thing = episode.thing_name
        lines += [
            f"- **A, green**: from here the {thing} can be taken.",
            f"- **B, orange**: from here the {thing} can be put where the command wants it.",
            "- A carried object is drawn above the agent's head; no view shows it.",
        ]
    elif episode.goal_known:
        lines.append("- **Orange**: tiles that fulfil the command.")
    lines.append(
        "- **Views**: each pixel is one of 61 classes; hover over it for its name. "
        "The framed view is ahead of the agent."
    )
    return "\n".join(lines)


@dataclass(frozen=True)
class Mark:
    """An entry of the legend of a map."""

    kind: Literal["start", "agent", "take", "goal"]
    words: str


def marks(episode: Episode) -> tuple[Mark, ...]:
    """The legend of the marks on a map."""
    task = episode.task
    both = Mark("start", "start"), Mark("agent", "agent, at the end")
    if not episode.goal_known:
        return both
    if task.kind == Kind.PICK:
        take = Mark("take", f"A: {episode.thing_name} within reach")
        return (*both, take, Mark("goal", "B: where it is to go, within reach"))
    if task.target_room is not None:
        return (*both, Mark("goal", f"goal: in the {task.target}"))
    return (*both, Mark("goal", f"goal: at the {task.target.replace('_', ' ')}"))


def now(episode: Episode, step: int) -> str:
    """What happens at a step, in Markdown."""
    done = bool(episode.done[: step + 1].any())
    action = f"**{action_phrase(episode, step)}**"
    if step < episode.horizon:
        action += f" (p {episode.action_probabilities[step, episode.actions[step]]:.2f})"
    heading = HEADING_NAMES[int(episode.headings[step])]
    facts = [
        f"step **{step}** of {episode.horizon}: {action}",
        f"in the {room_name(episode, step)}, facing {heading}",
    ]
    if episode.task.kind == Kind.PICK:
        facts.append(f"{episode.thing_name} **{object_phrase(episode, step)}**")
    if episode.goal_known:
        facts.append("**goal reached**" if done else "goal not reached yet")
    lines = [f"### {episode.task.command}", ", ".join(facts), f"sees {_seen(episode.seen[step])}"]
    return plain("\n\n".join(lines))


def _seen(panorama: NDArray[np.uint8]) -> str:
    """The classes in a panorama, most pixels first, without the building itself."""
    counts = np.bincount(panorama.reshape(-1), minlength=61)
    order = np.argsort(-counts, kind="stable")
    classes = semantic_classes()
    words = [
        classes[number].words
        for number in order
        if counts[number] and classes[number].group != "structure"
    ]
    more = f", and {len(words) - _SEEN} more" if len(words) > _SEEN else ""
    return (", ".join(words[:_SEEN]) or "nothing but the building") + more
