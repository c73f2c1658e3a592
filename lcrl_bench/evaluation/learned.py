"""What a finished training left in its run folder, read back to be used again."""

from __future__ import annotations

from pathlib import Path

from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.model_identity import check_model
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.storage import read_json


def load_learned(folder: Path) -> Reward | Policy:
    """Load the reward or the policy that a run learned.

    Args:
        folder: `runs/<benchmark>/<method>/seed<k>`. Its `config.json` names the method, whose code
            is imported.

    Raises:
        InvalidFileError: If the folder holds no run, or a model that is damaged or that the run's
            own training did not make.
        UnknownNameError: If its method is not installed here.
        UsageError: If it learned from views of another size than its benchmark's.
    """
    path = folder / "config.json"
    document = read_json(path)
    try:
        name = str(document["method"])
    except (KeyError, TypeError) as error:
        reason = f"not the configuration of a run: {error!r}"
        fix = "Name a folder runs/<benchmark>/<method>/seed<k>."
        raise InvalidFileError(path, reason, fix=fix) from error
    if "image_size" in document:
        size = document["image_size"]
        raise UsageError(f"{folder}: learned from views of {size} pixels, of another size.")
    method = resolve_method(name)
    check_model(folder)
    return method.learns.load(RunFolder(folder).model)


def load_reward(folder: Path) -> Reward:
    """Load the reward that a run learned; arguments and errors as `load_learned`.

    Raises:
        UsageError: If the run learned a policy.
    """
    learned = load_learned(folder)
    if not isinstance(learned, Reward):
        raise UsageError(f"{folder}: its method learned a policy, which has no reward.")
    return learned
