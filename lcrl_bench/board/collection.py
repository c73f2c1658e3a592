"""From the folders of finished runs to a `Submission`."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.board.admission import check_submission
from lcrl_bench.board.checkpoints import listed_files
from lcrl_bench.board.document import CURVE_POINTS, LEAST_SEEDS, Submission
from lcrl_bench.documents import parse_document
from lcrl_bench.errors import InvalidFileError, NothingSelectedError, UsageError
from lcrl_bench.evaluation.identity import differences, without_computer
from lcrl_bench.evaluation.model_identity import check_model
from lcrl_bench.evaluation.results import TABLES, Results
from lcrl_bench.evaluation.run_folder import EPISODES_FILE, RunFolder, is_set_aside
from lcrl_bench.evaluation.settings import DEFAULT_PRESET
from lcrl_bench.methods.registry import method_registry, resolve_method, short_name
from lcrl_bench.storage import read_json

RUN_AGAIN: Final = "Run it again: lcrl-bench run --method METHOD --seeds 0 1 2"


@dataclass(frozen=True)
class Statement:
    """What the submitter adds to what the runs record."""

    title: str = ""
    """Empty: the name of the folder of the runs."""
    summary: str = ""
    """Empty: the method's own line."""
    author: str = ""
    code: str = ""
    weights: str = ""
    draft: bool = False
    checkpoints: Path | None = None
    """The folder of seed<k>/model; None: the runs themselves."""
    packed: Path | None = None
    """The folder that `pack` will copy the runs' checkpoints to; None: they stay where they are."""


def seed_folders(paths: Sequence[Path]) -> tuple[Path, ...]:
    """The run folders at some paths: a path itself, or all the seeds in a method's folder.

    Raises:
        NothingSelectedError: If none of them is finished.
        UsageError: If a folder that was named itself is not finished, or they lie apart.
    """
    found: dict[Path, None] = {}
    for path in paths:
        if (path / "config.json").exists():
            if not RunFolder(path).done:
                raise UsageError(f"{path} is not finished. Repeat its lcrl-bench run command.")
            found[path.resolve()] = None
            continue
        inside = sorted(path.glob("seed*"), key=lambda each: (len(each.name), each.name))
        seeds = [each for each in inside if RunFolder(each).done and not is_set_aside(each)]
        found.update((each.resolve(), None) for each in seeds)
    if not found:
        names = ", ".join(map(str, paths))
        advice = "Name runs/<benchmark>/<method>, or its seed folders."
        raise NothingSelectedError(f"No finished seed in {names}. {advice}")
    if len({each.parent for each in found}) > 1:
        raise UsageError("The seeds lie in several folders; a submission is one method's runs.")
    return tuple(found)


def benchmark_of(folder: Path) -> str:
    """The name of the benchmark that a run is on."""
    return str(_read(folder / "config.json", "benchmark"))


def collect(
    folders: Sequence[Path], benchmark: Benchmark, statement: Statement, *, out: Path
) -> Submission:
    """Make the submission of some seeds of one method.

    The seeds of a deterministic method are all the same: the first stands for all.

    Args:
        folders: `seed_folders`.
        benchmark: The benchmark as it is shipped.
        statement: What the submitter says.
        out: The file that the submission will be: checkpoints are named relative to it.

    Raises:
        InvalidFileError: If the runs are of another benchmark, differ in more than the seed, hold
            a model or figures that their training did not give, lack controls, or
            `check_submission` refuses what comes of them.
        UsageError: If there are too few seeds.
    """
    configs = [_config(folder, benchmark) for folder in folders]
    _check_alike(folders, configs)
    deterministic = _all_the_same(folders)
    if deterministic:
        folders, configs = folders[:1], configs[:1]
    elif len(folders) < LEAST_SEEDS and not statement.draft:
        raise UsageError(
            f"{len(folders)} of {LEAST_SEEDS} seeds are finished. Run the others: lcrl-bench run "
            "--seeds 0 1 2. Or give --draft: a draft is shown, never ranked."
        )
    first, summaries = configs[0], [_summary(folder) for folder in folders]
    asked = str(first["method"])
    method_class = resolve_method(asked)
    registered = asked in method_registry()
    files = {int(c["seed"]): f / EPISODES_FILE for c, f in zip(configs, folders, strict=True)}
    results = Results.read(asked, files)
    models = statement.checkpoints or folders[0].parent
    named = statement.packed or models
    value = {
        "method": short_name(asked),
        "registered": registered,
        "title": statement.title or folders[0].parent.name,
        "summary": statement.summary or _summary_line(asked, method_class),
        "author": statement.author,
        "code": statement.code,
        "weights": statement.weights,
        "draft": statement.draft,
        "deterministic": deterministic,
        "oracle": method_class.oracle,
        "expert": method_class.expert,
        "benchmark": benchmark.name,
        "fingerprint": benchmark.fingerprint,
        "image_size": first.get("image_size"),
        "preset": first.get("preset", DEFAULT_PRESET),
        "changed": first["settings"],
        "settings": first.get("resolved", {}),
        "run": folders[0].parent.name,
        "checkpoints": Path(os.path.relpath(named, out.parent.resolve())).as_posix(),
        **shared_tables(results),
        "controls": _without_totals(summaries[0]["controls"]),
        "seeds": [
            _seed(folder, models, seed, summary, results.seed(seed).tables())
            for folder, seed, summary in zip(folders, results.seeds, summaries, strict=True)
        ],
    }
    submission = parse_document(
        Submission, value, path=folders[0].parent, kind="what can be submitted", fix=RUN_AGAIN
    )
    check_submission(submission, folders[0].parent)
    return submission


def _read(path: Path, key: str) -> Any:  # noqa: ANN401 - any JSON value
    value = read_json(path)
    if not isinstance(value, dict) or key not in value:
        raise InvalidFileError(path, f"says nothing of '{key}'", fix=RUN_AGAIN)
    return value[key]


def _config(folder: Path, benchmark: Benchmark) -> dict[str, Any]:
    path = folder / "config.json"
    for key in ("method", "settings", "seed", "benchmark"):
        _read(path, key)
    found = str(_read(path, "fingerprint"))
    if found != benchmark.fingerprint:
        reason = (
            f"a run on another {benchmark.name}: fingerprint {found[:12]}, "
            f"the shipped one has {benchmark.fingerprint[:12]}"
        )
        raise InvalidFileError(path, reason, fix=f"Figures don't carry over. {RUN_AGAIN}")
    return read_json(path)


def _check_alike(folders: Sequence[Path], configs: Sequence[Mapping[str, Any]]) -> None:
    """Refuse seeds that differ in more than the seed."""
    first, *others = [without_computer({**config, "seed": None}) for config in configs]
    for folder, other in zip(folders[1:], others, strict=True):
        if different := differences(first, other):
            reason = f"another run than {folders[0]}: it differs in {'; '.join(different)}"
            fix = "All seeds of a submission have the same settings and code."
            raise InvalidFileError(folder / "config.json", reason, fix=fix)


def _all_the_same(folders: Sequence[Path]) -> bool:
    """Whether training is deterministic, and all seeds have the same checkpoint."""
    if not all(RunFolder(folder).summary().get("deterministic") is True for folder in folders):
        return False
    first = listed_files(folders[0] / "model")
    return all(listed_files(folder / "model") == first for folder in folders)


def _summary(folder: Path) -> dict[str, Any]:
    for key in (*TABLES, "controls", "wall_s"):
        _read(folder / "summary.json", key)
    return RunFolder(folder).summary()


def _summary_line(asked: str, method_class: type) -> str:
    registry = method_registry()
    if asked in registry:
        return registry.entries[asked].summary
    return (method_class.__doc__ or "").strip().partition("\n")[0][:200]


def shared_tables(results: Results) -> dict[str, Any]:
    """The tables over all seeds: means, and success with its intervals."""
    figures = {
        split: {kind: None if each is None else asdict(each) for kind, each in row.items()}
        for split, row in results.figures().items()
    }
    means = {name: table for name, table in results.tables().items() if name != "splits"}
    return {"figures": figures, **means}


def _without_totals(controls: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    return {
        name: {split: row for split, row in table.items() if split != "all"}
        for name, table in controls.items()
    }


def _seed(
    folder: Path, models: Path, seed: int, summary: Mapping[str, Any], tables: Mapping[str, Any]
) -> dict[str, Any]:
    check_model(folder)
    files = listed_files(folder / "model")
    given = models / folder.name / "model"
    if given.resolve() != (folder / "model").resolve() and listed_files(given) != files:
        reason = f"not the checkpoint of {folder}"
        raise InvalidFileError(given, reason, fix="Copy the run's model/ there, as it is.")
    made_with = read_json(folder / "environment.json")
    keys = ("lcrl_bench", "python", "device", "machine", "threads", "versions")
    return {
        "seed": seed,
        "files": [asdict(file) for file in files],
        **tables,
        "wall_s": summary["wall_s"],
        "machine": {**{key: made_with.get(key) for key in keys}, "cores": made_with.get("cores")},
        "curve": learning_curve(folder / "metrics.jsonl"),
    }


def learning_curve(path: Path, *, points: int = CURVE_POINTS) -> list[dict[str, float]]:
    """The training loss thinned to a few points: each the mean since the point before.

    Empty if the method logs no `loss`.
    """
    rows = []
    for line in path.read_text("utf-8").splitlines() if path.exists() else ():
        row = json.loads(line)
        loss = row.get("loss")
        if isinstance(loss, (int, float)) and math.isfinite(loss) and "step" in row:
            rows.append((int(row["step"]), float(loss)))
    size = max(1, math.ceil(len(rows) / points))
    parts = [rows[start : start + size] for start in range(0, len(rows), size)]
    return [
        {"step": part[-1][0], "loss": round(math.fsum(loss for _, loss in part) / len(part), 6)}
        for part in parts
    ]
