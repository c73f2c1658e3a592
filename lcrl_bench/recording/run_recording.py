"""The recordings of a run: a showcase, further episodes in files of their own, curves."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final, Literal, get_args

from matplotlib.figure import Figure

from lcrl_bench.benchmarks.house_sets import tasks_by_set, tasks_of
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.evaluation.run import Run, RunSpec, run
from lcrl_bench.evaluation.run_jobs import SessionSpec, shared_session, spec_document, spec_of
from lcrl_bench.evaluation.session import Session
from lcrl_bench.jobs.job import Job, Tell
from lcrl_bench.recording.curves import training_curves
from lcrl_bench.recording.episode import episode_record
from lcrl_bench.recording.figures import figure_file
from lcrl_bench.recording.index import RECORDING_FILE, Archive
from lcrl_bench.recording.pictures import showcase_figure
from lcrl_bench.recording.rerun.log import recording_file
from lcrl_bench.recording.reward_plan import reward_map_figure
from lcrl_bench.recording.rollout import episode_of
from lcrl_bench.recording.storyboard import Storyboard, storyboard_of
from lcrl_bench.recording.views import strip_figure

Selection = Literal["none", "showcase", "first", "failures", "all"]
SELECTIONS: Final[tuple[Selection, ...]] = get_args(Selection)
MOST_FAILURES: Final = 20
"""Failures recorded per run."""
SOLVED: Final = 0.5
"""Success probability from which a task counts as solved."""
SHOWCASE_PICTURE, CURVES_PICTURE = "showcase.png", "curves.png"


def record_run(
    run: Run,
    session: Session,
    selection: Selection,
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> Path:
    """Record the showcase of a run, its learning curves, and the episodes of a selection.

    Writes `recording.rrd`, `showcase.png` and `curves.png` into the run's folder, and into its
    `episodes` a `.rrd`, a `.npz`, a map and a strip per further episode, with an index. Episodes
    that are there are kept, so an interrupted recording resumes.

    Args:
        run: The run.
        session: The benchmark that it is on.
        selection: Which episodes to record; any but `"none"` starts with the showcase.
        progress: Called with each task of the selection once its episode is recorded.

    Returns:
        The recording of the showcase.
    """
    archive, benchmark = Archive(run.folder.path), session.benchmark
    if "showcase" not in archive.selections:
        title = f"{run.spec.method} on {benchmark.name}, seed {run.spec.seed}"
        curves = training_curves(run.folder, len(benchmark.houses_of(Split.TRAIN)), title)
        _record_showcase(run, session, archive, curves)
    if selection not in archive.selections:
        for outcome, board in _followed(run, session, selection, but=archive.recorded):
            files = _episode_files(board)
            files["recording"] = recording_file([board])
            archive.add(board.episode, outcome, files)
            progress(outcome.task.id)
        archive.complete(selection, {})
    return run.folder.path / RECORDING_FILE


def record_job(arguments: Mapping[str, Any], tell: Tell) -> None:
    """The function of the jobs of `record_jobs_of`."""
    session = shared_session(SessionSpec(**arguments["session"]))
    found = run(spec_of(arguments["spec"]), session)
    with found.folder.locked():
        record_run(found, session, arguments["selection"], progress=lambda task: tell(0.0, task))


def record_jobs_of(
    session: SessionSpec, specs: Mapping[str, RunSpec], selection: Selection
) -> list[Job]:
    """The recordings of finished runs by name, as jobs called `<name>/recording`."""
    common = {"session": asdict(session), "selection": selection}
    return [
        Job(
            f"{name}/recording",
            f"{__name__}:record_job",
            {**common, "spec": spec_document(spec)},
            kept=False,
        )
        for name, spec in specs.items()
    ]


def record_showcase(run: Run, session: Session, folder: Path) -> None:
    """Record a NAV success, a PICK success and a failure of a run, where they occurred.

    Writes `recording.rrd` and `showcase.png` into `folder`, and into its `episodes` a `.npz` (the
    record), a reward map and a strip per episode, with an index.
    """
    _record_showcase(run, session, Archive(folder), None)


def _record_showcase(run: Run, session: Session, archive: Archive, curves: Figure | None) -> None:
    """Record the showcase of a run, with its learning curves if there are any."""
    boards = []
    for outcome, board in _followed(run, session, "showcase"):
        files = _episode_files(board)
        archive.add(board.episode, outcome, files)
        boards.append(board)
    picks = [board for board in boards if board.episode.task.kind == Kind.PICK]
    shown = next((board for board in picks if board.episode.success), boards[0])
    figures = {SHOWCASE_PICTURE: showcase_figure(shown)}
    if curves is not None:
        figures[CURVES_PICTURE] = curves
    files = {name: figure_file(figure) for name, figure in figures.items()}
    files[RECORDING_FILE] = recording_file(boards)
    archive.complete("showcase", files)


def _followed(
    run: Run, session: Session, selection: Selection, *, but: Collection[str] = ()
) -> Iterator[tuple[Outcome, Storyboard]]:
    """Follow a run in the tasks of a selection, except some; one by one: each takes megabytes."""
    spec = run.spec
    for outcome, one in _chosen(run, session, selection):
        if outcome.task.id not in but:
            episode = episode_of(
                run.learned, one, benchmark=session.benchmark, method=spec.method, seed=spec.seed
            )
            yield outcome, storyboard_of(episode)


def _episode_files(board: Storyboard) -> dict[str, bytes]:
    """The files that every episode has: role → content."""
    reward_map, strip = reward_map_figure(board), strip_figure(board)
    files = {"map": figure_file(reward_map), "strip": figure_file(strip)}
    return {**files, "record": episode_record(board.episode)}


def _chosen(run: Run, session: Session, selection: Selection) -> Iterator[tuple[Outcome, TaskSet]]:
    """The outcomes of a selection, each with its task as a set of one."""
    sets = session.task_sets(run.spec.image_size)
    numbers = {
        task.id: (number, row)
        for number, each in enumerate(tasks_by_set(sets))
        for row, task in enumerate(each)
    }
    outcomes = run.results.outcomes(tasks_of(sets))
    for outcome in choose(selection, outcomes):
        number, row = numbers[outcome.task.id]
        yield outcome, sets[number].rows([row])


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
