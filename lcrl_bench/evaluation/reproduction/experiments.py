"""Declarations of the paper's four experiments: their rows, runs and the paper's results.

A row names a run. Rows with the same run share it: LC-RL with its defaults is in every table.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.results import COLUMNS
from lcrl_bench.evaluation.run import RunSpec

PAPER_SEEDS: Final = (0, 1, 2)
"""The paper's results are means over three seeds."""
TEN_SEEDS: Final = tuple(range(10))
"""For two rows that are close: with three seeds, the difference is mostly between seeds."""


@dataclass(frozen=True)
class Row:
    """One row of a table."""

    label: str
    run: RunSpec
    """The run, for any seed."""
    paper: str | None = None
    """The row of the paper's table to compare it with."""
    seeds: tuple[int, ...] = PAPER_SEEDS
    """Default seeds."""

    @property
    def control(self) -> bool:
        """Whether it is a control, which has no seeds."""
        return self.run.control

    def specs(self, asked: Sequence[int] | None, budget: float | None) -> dict[int, RunSpec]:
        """Its runs by seed: for the seeds given, or else its own; a control has one run."""
        if self.control:
            return {0: self.run}
        seeds = self.seeds if asked is None else tuple(asked)
        return {seed: replace(self.run, seed=seed, budget=budget) for seed in seeds}


@dataclass(frozen=True)
class Claim:
    """A claim of the paper about two rows."""

    text: str
    first: str
    """Label of a row."""
    second: str
    """Label of another row."""
    column: str
    """`<split>.<pick|nav|total>`."""
    relation: Literal["better", "alike"] = "better"
    """Whether the first is claimed to be better than the second, or no different."""


@dataclass(frozen=True)
class Experiment:
    """One table of the paper."""

    name: str
    """Its name, also that of the paper's table in `assets/paper_tables.toml`."""
    title: str
    rows: tuple[Row, ...]
    columns: tuple[str, ...]
    """`<split>.<pick|nav|total>`."""
    claims: tuple[Claim, ...] = ()
    language: bool = False
    """Whether the table includes the language controls."""

    def row(self, label: str) -> Row:
        """The row with that label."""
        return next(row for row in self.rows if row.label == label)


TOTALS: Final = tuple(f"{split.value}.total" for split in Split)
EVERY_COLUMN: Final = tuple(f"{split.value}.{kind}" for split in Split for kind in COLUMNS)

CONTROLS: Final = (
    Row("random actions", RunSpec("random", control=True)),
    Row("constant reward", RunSpec("constant", control=True)),
    Row("word look-up (lexical)", RunSpec("lexical", control=True)),
    Row("optimal policy", RunSpec("optimal", control=True)),
)

_LCRL, _GAIL, _CLONING = "LC-RL", "GAIL-Exact", "optimal policy cloning"
_AGILE, _REGRESSION = "AGILE", "reward regression (oracle)"


def _claims(text: str, first: str, second: str, splits: tuple[Split, ...]) -> tuple[Claim, ...]:
    return tuple(Claim(text, first, second, f"{split.value}.total") for split in splits)


_ALL, _TESTS = tuple(Split), (Split.TEST_TASK, Split.TEST_HOUSE)

TABLE_1: Final = Experiment(
    name="table-1",
    title="Success of every method (Table 1)",
    rows=(
        Row(_CLONING, RunSpec("cloning"), "Optimal Policy Cloning"),
        Row(_AGILE, RunSpec("agile"), "AGILE"),
        Row(_GAIL, RunSpec("gail_exact"), "GAIL-Exact", seeds=TEN_SEEDS),
        Row(_LCRL, RunSpec("lcrl"), "LC-RL (ours)", seeds=TEN_SEEDS),
        Row("LC-RL, the paper's settings", RunSpec("lcrl", preset="paper"), "LC-RL (ours)"),
        Row(_REGRESSION, RunSpec("reward_regression"), "Reward Reg. (Oracle)"),
        *CONTROLS,
    ),
    columns=EVERY_COLUMN,
    claims=(
        *_claims("rewards transfer better than a policy", _LCRL, _CLONING, _ALL),
        *_claims("GAIL-Exact is worse in tests", _LCRL, _GAIL, _TESTS),
        Claim("GAIL-Exact is comparable in training", _LCRL, _GAIL, "train.total", "alike"),
        *_claims("an exact solver beats a sampling one", _GAIL, _AGILE, _ALL),
        *_claims("LC-RL is better than AGILE", _LCRL, _AGILE, _ALL),
        *_claims("GAIL-Exact is better than cloning", _GAIL, _CLONING, _ALL),
        *_claims("the oracle is better", _REGRESSION, _LCRL, _ALL),
    ),
    language=True,
)


def _dqn_rows(label: str, method: str, paper: str) -> tuple[Row, ...]:
    shaped, plain = Optimizer.DQN_SHAPED, Optimizer.DQN
    return (
        Row(f"{label}, DQN, shaping", RunSpec(method, optimizer=shaped), f"{paper} (DQN), shaping"),
        Row(
            f"{label}, DQN, no shaping",
            RunSpec(method, optimizer=plain),
            f"{paper} (DQN), no shaping",
        ),
        Row(f"{label}, Q-iteration", RunSpec(method), f"{paper} (QI)"),
    )


TABLE_2: Final = Experiment(
    name="table-2",
    title="Learned rewards optimised again by DQN (Table 2)",
    rows=(
        *_dqn_rows("LC-RL", "lcrl", "LC-RL"),
        *_dqn_rows("reward regression", "reward_regression", "Reward Regression"),
    ),
    columns=TOTALS,
    claims=(
        *_claims("shaping helps", "LC-RL, DQN, shaping", "LC-RL, DQN, no shaping", _ALL),
        *_claims(
            "shaping helps",
            "reward regression, DQN, shaping",
            "reward regression, DQN, no shaping",
            _ALL,
        ),
        *_claims(
            "DQN is worse than the exact solver", "LC-RL, Q-iteration", "LC-RL, DQN, shaping", _ALL
        ),
        *_claims(
            "regressed rewards are easier to optimise",
            "reward regression, DQN, shaping",
            "LC-RL, DQN, shaping",
            _ALL,
        ),
    ),
)

IMAGES: Final = {"pooling": "Pooling", "film": "FiLM", "fc": "FC"}
"""How a view is encoded: setting → the paper's term."""
FUSIONS: Final = {"mult": "Mult", "add": "Add", "concat": "Concat"}
"""How image and command are fused: setting → the paper's term."""


SWEEP: Final = {
    "size": "32",
    "hidden": "32",
    "passes": "20",
    "mirror": "false",
    "standardise": "false",
}
"""Settings of all architectures: the paper's sizes and inputs, and a third of the default passes.
They are only compared with each other, and a pass of the fully connected encoder takes five times
as long."""


def _architecture(image: str, fusion: str) -> Row:
    label = f"{IMAGES[image]}, {FUSIONS[fusion]}"
    return Row(label, RunSpec.of("lcrl", {"image": image, "fusion": fusion, **SWEEP}), label)


ARCHITECTURES: Final = Experiment(
    name="architectures",
    title="Architectures of the reward network (appendix, architecture sweep)",
    rows=tuple(_architecture(image, fusion) for image in IMAGES for fusion in FUSIONS),
    columns=TOTALS,
    claims=(
        *_claims("global pooling beats a fully connected layer", "Pooling, Mult", "FC, Mult", _ALL),
        *(
            Claim(
                "multiplying and concatenating are alike", "Pooling, Mult", "Pooling, Concat",
                column, "alike",
            )
            for column in TOTALS
        ),
    ),
)  # fmt: skip

IMAGE_SIZE: Final = Experiment(
    name="image-size",
    title="Size of the images (appendix, image ablation)",
    rows=(
        Row("32 by 24", RunSpec("lcrl"), "32 by 24"),
        Row("64 by 64", RunSpec("lcrl", image_size=(64, 64)), "64 by 64"),
    ),
    columns=TOTALS,
    claims=tuple(
        Claim("the size of the image matters little", "64 by 64", "32 by 24", column, "alike")
        for column in TOTALS
    ),
)

EXPERIMENTS: Final = (TABLE_1, TABLE_2, IMAGE_SIZE, ARCHITECTURES)
"""In the order they are run in: the sweep, which takes longest, is last."""


def specs_of(
    experiments: Iterable[Experiment], seeds: Sequence[int] | None, budget: float | None
) -> tuple[RunSpec, ...]:
    """All distinct runs of some tables, ordered by table, then by seed, trainings first.

    Args:
        experiments: The tables.
        seeds: Seeds for all rows; None means each row's own.
        budget: Share of the full training; None means all of it.
    """
    found: dict[RunSpec, None] = {}
    for experiment in experiments:
        rows = [row.specs(seeds, budget) for row in experiment.rows]
        for seed in dict.fromkeys(seed for specs in rows for seed in specs):
            wanted = [specs[seed] for specs in rows if seed in specs]
            found.update(dict.fromkeys(spec.training for spec in wanted))
            found.update(dict.fromkeys(wanted))
    return tuple(found)
