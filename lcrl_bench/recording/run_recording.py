"""The recordings of a run: a showcase, further episodes in files of their own, curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final, Literal, get_args

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.evaluation.run import Run
from lcrl_bench.evaluation.session import Session
from lcrl_bench.names import slug
from lcrl_bench.recording.curves import curves_picture, read_metrics, series
from lcrl_bench.recording.episode import Episode, read_episode, write_episode
from lcrl_bench.recording.index import (
    EPISODES,
    RECORDING_FILE,
    add_to_index,
    episode_file,
    is_recorded,
)
from lcrl_bench.recording.pictures import reward_map_picture, showcase_picture
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.rollout import episode_of
from lcrl_bench.recording.strip import strip_picture

Selection = Literal["none", "showcase", "first", "failures", "all"]
SELECTIONS: Final[tuple[Selection, ...]] = get_args(Selection)
MOST_FAILURES: Final = 20
"""Failures recorded per run."""
SOLVED: Final = 0.5
"""Success probability from which a task counts as solved."""
SHOWCASE_PICTURE, CURVES_PICTURE = "showcase.png", "curves.png"
_DRAWN: Final[dict[str, Callable[[Path, Episode], None]]] = {
    "map": reward_map_picture,
    "strip": strip_picture,
    "recording": lambda path, episode: record_episodes(path, [episode]),
}
"""Role in the index → what draws the file of an episode."""


def record_run(
    run: Run,
    session: Session,
    selection: Selection,
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> Path:
    """Record the showcase of a run, its learning curves, and the episodes of a selection.

    Writes `recording.rrd`, `showcase.png` and `curves.png` into the run's folder, and into its
    `episodes` a `.rrd`, a `.npz`, a map and a strip per further episode, with an index. Existing
    files are kept, so an interrupted recording resumes.

    Args:
        run: The run.
        session: The benchmark that it is on.
        selection: Which episodes to record; any but `"none"` starts with the showcase.
        progress: Called with each task of the selection once its episode is recorded.

    Returns:
        The recording of the showcase.
    """
    folder = run.folder.path
    if not is_recorded(folder, "showcase"):
        record_showcase(run, session, folder)
        _draw_curves(run, session.benchmark)
    if not is_recorded(folder, selection):
        recorded = _record_each(run, session, selection, progress)
        add_to_index(folder / EPISODES, selection, recorded)
    return folder / RECORDING_FILE


def record_showcase(run: Run, session: Session, folder: Path) -> None:
    """Record a NAV success, a PICK success and a failure of a run, where they occurred.

    Writes `recording.rrd` and `showcase.png` into `folder`, and into its `episodes` a `.npz` (the
    record), a reward map and a strip per episode, with an index.
    """
    pairs = [
        (_follow(run, one, session.benchmark), outcome)
        for outcome, one in _chosen(run, session, "showcase")
    ]
    episodes = [episode for episode, _ in pairs]
    home = folder / EPISODES
    for episode in episodes:
        write_episode(home, slug(episode.task.id), episode)
        reward_map_picture(episode_file(home, episode.task.id, "map"), episode)
        strip_picture(episode_file(home, episode.task.id, "strip"), episode)
    shown = next((e for e in episodes if e.success and e.task.kind == Kind.PICK), episodes[0])
    showcase_picture(folder / SHOWCASE_PICTURE, shown)
    record_episodes(folder / RECORDING_FILE, episodes)
    add_to_index(home, "showcase", pairs)


def _chosen(run: Run, session: Session, selection: Selection) -> Iterator[tuple[Outcome, TaskSet]]:
    """The outcomes of a selection, each with its task as a set of one."""
    sets = session.task_sets(run.spec.image_size)
    places = {task.id: (tasks, row) for tasks in sets for row, task in enumerate(tasks.tasks)}
    outcomes = run.results.outcomes(task for tasks in sets for task in tasks.tasks)
    for outcome in choose(selection, outcomes):
        tasks, row = places[outcome.task.id]
        yield outcome, tasks.rows([row])


def _follow(run: Run, one: TaskSet, benchmark: Benchmark) -> Episode:
    spec = run.spec
    return episode_of(run.learned, one, benchmark=benchmark, method=spec.method, seed=spec.seed)


def _record_each(
    run: Run, session: Session, selection: Selection, progress: Callable[[str], None]
) -> Iterator[tuple[Episode, Outcome]]:
    """Record episodes one by one: each takes a few megabytes while it is drawn."""
    folder = run.folder.path / EPISODES
    for outcome, one in _chosen(run, session, selection):
        task = outcome.task.id
        episode = _read_back(episode_file(folder, task, "record"), one)
        if episode is None:
            episode = _follow(run, one, session.benchmark)
            write_episode(folder, slug(task), episode)
        for role, draw in _DRAWN.items():
            path = episode_file(folder, task, role)
            if not path.exists():
                draw(path, episode)
        progress(task)
        yield episode, outcome


def _read_back(record: Path, one: TaskSet) -> Episode | None:
    """An episode that is already recorded; None if it isn't, or was by another version."""
    if not record.exists():
        return None
    try:
        return read_episode(record, one)
    except InvalidFileError:
        return None


def _draw_curves(run: Run, benchmark: Benchmark) -> None:
    """Draw what the training logged, if anything."""
    folder = run.folder.path
    metrics = folder / "metrics.jsonl"
    rows = read_metrics(metrics) if metrics.exists() else []
    if not series(rows):
        return
    houses = len(benchmark.houses_of(Split.TRAIN))
    passes = ((run.folder.config or {}).get("resolved") or {}).get("passes")
    # Methods that train in passes take one step per house.
    whole = passes is not None and rows[-1].get("steps", 0) % houses == 0
    curves_picture(
        folder / CURVES_PICTURE,
        rows,
        title=f"{run.spec.method} on {benchmark.name}, seed {run.spec.seed}",
        pass_steps=houses if whole else None,
    )


def choose(selection: Selection, outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """The outcomes of the tasks that a selection records.

    Args:
        selection: `"showcase"`: see `choose_showcase`; `"first"`: the first task of each split and
            kind; `"failures"`: see `choose_failures`; `"all"`; `"none"`.
        outcomes: Of all tasks, in order.
    """
    if selection == "showcase":
        return choose_showcase(outcomes)
    if selection == "first":
        return choose_first(outcomes)
    if selection == "failures":
        return choose_failures(outcomes)
    return tuple(outcomes) if selection == "all" else ()


def choose_showcase(outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """A NAV success, a PICK success and a failure, where they occurred.

    Held-out houses and tasks come first; among those the longest successes and the shortest
    failure.
    """
    order = (Split.TEST_HOUSE, Split.TEST_TASK, Split.TRAIN)

    def rank(outcome: Outcome, sign: int) -> tuple[int, int, str]:
        task = outcome.task
        return order.index(task.split), sign * task.proof.optimal_length, task.id

    chosen: list[Outcome] = []
    for kind in (Kind.NAV, Kind.PICK):
        solved = [o for o in outcomes if o.task.kind == kind and o.success >= SOLVED]
        chosen += sorted(solved, key=lambda o: rank(o, -1))[:1]
    failed = [outcome for outcome in outcomes if outcome.success < SOLVED]
    chosen += sorted(failed, key=lambda o: rank(o, 1))[:1]
    return tuple(chosen)


def choose_first(outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """The first task of each split and kind, whether solved or not."""
    first: dict[tuple[Split, Kind], Outcome] = {}
    for outcome in outcomes:
        first.setdefault((outcome.task.split, outcome.task.kind), outcome)
    return tuple(first[split, kind] for split in Split for kind in Kind if (split, kind) in first)


def choose_failures(
    outcomes: Sequence[Outcome], *, most: int = MOST_FAILURES
) -> tuple[Outcome, ...]:
    """Failed tasks, spread evenly over splits, kinds and ways to fail.

    One task of each split, kind and likeliest way to fail is taken in turn, shortest first, until
    there are enough or none is left.

    Args:
        outcomes: Of all tasks.
        most: How many are enough.
    """
    groups: dict[tuple[Split, Kind, Failure | None], list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.success < SOLVED:
            key = (outcome.task.split, outcome.task.kind, likeliest_failure(outcome))
            groups.setdefault(key, []).append(outcome)
    queues = [sorted(group, key=_shortest_first) for group in groups.values()]
    rounds = max(map(len, queues), default=0)
    turns = [queue[turn] for turn in range(rounds) for queue in queues if turn < len(queue)]
    return tuple(turns[:most])


def likeliest_failure(outcome: Outcome) -> Failure | None:
    """The most frequent way a PICK task fails; None for NAV."""
    if not outcome.failures:
        return None
    return max(Failure, key=lambda failure: outcome.failures.get(failure, 0.0))


def _shortest_first(outcome: Outcome) -> tuple[int, str]:
    return outcome.task.proof.optimal_length, outcome.task.id
