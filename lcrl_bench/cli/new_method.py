"""`lcrl-bench new-method`: a method that runs, learns and has a test, to start from."""

from __future__ import annotations

import importlib
import importlib.util
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.method_draft import Shape, check_method_name, class_name, draft, write_folder
from lcrl_bench.cli.output import print_json, print_table, say, suggest
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.methods.registry import BASELINES

CONTENTS: Final = {
    "method.py": "its settings, and its objective: what a step of training descends",
    "README.md": "its source, what is faithful to it, what differs",
    "test_method.py": "the contract of a method, and that it learns, in a tiny world",
    "method.toml": "its name in the suite",
    "pyproject.toml": "a package that offers it by the entry point lcrl_bench.methods",
    "__init__.py": "makes the folder a Python package",
}
"""File -> what it holds."""


@dataclass(frozen=True)
class NewMethodFlags:
    """Write a method to start from: it runs, learns and has a test as it stands."""

    name: tyro.conf.Positional[str]
    """A Python identifier in lower case, such as my_method; its class is then MyMethod."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    """The folder to write, which must not be there yet. None: one called as the method, here."""
    package: bool = False
    """Write an installable package, which joins by the entry point `lcrl_bench.methods`."""
    baseline: bool = False
    """Write into `baselines/` of this checkout, as a method of the suite."""
    json: bool = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(NewMethodFlags, argv, verb="new-method")
    shape = _shape(flags)
    check_method_name(flags.name)
    folder = baselines_folder() / flags.name if shape == "baseline" else flags.out
    folder = folder or Path(flags.name)
    texts = draft(flags.name, shape)
    write_folder(folder, texts)
    steps = next_steps(flags.name, folder, shape)
    if flags.json:
        commands = [shlex.join(words) for words, _ in steps]
        print_json({"folder": str(folder), "files": sorted(texts), "next": commands})
    else:
        rows = [(str(folder / path), CONTENTS[Path(path).name]) for path in texts]
        print_table(("file", "what it holds"), rows)
    if shape == "baseline":
        line = f'"{BASELINES}.{flags.name}"'
        say(f"add {line} to `packages` in pyproject.toml: what a wheel carries")
    for words, purpose in steps:
        suggest(words, purpose)
    return ExitCode.DONE


def _shape(flags: NewMethodFlags) -> Shape:
    if flags.baseline and (flags.package or flags.out is not None):
        raise UsageError("--baseline says what is written, and where: leave --package, --out out.")
    return "baseline" if flags.baseline else "package" if flags.package else "folder"


def baselines_folder() -> Path:
    """`baselines/` of the checkout that this is run from.

    Raises:
        UsageError: If the suite is installed without its checkout.
    """
    folder = Path(next(iter(importlib.import_module(BASELINES).__path__)))
    if not (folder.parent / "pyproject.toml").is_file():
        reason = "--baseline needs a checkout of the suite, and this is an installed one."
        raise UsageError(f"{reason} Leave it out, or write a package of your own: --package.")
    return folder


def next_steps(name: str, folder: Path, shape: Shape) -> list[tuple[list[str], str]]:
    """The words of the commands to go on with, and what each does."""
    test, method = ["python", "-m", "pytest", str(folder)], name
    steps = []
    if shape == "folder":
        method = f"{folder / 'method.py'}:{class_name(name)}"
    elif shape == "package":
        install = ["python", "-m", "pip", "install", "--no-deps", "--editable", str(folder)]
        steps.append((install, "lcrl-bench list methods names it then"))
    else:
        flags = f"PYTEST_FLAGS=tests/methods/test_every_method.py -k {name}"
        test = ["make", "test", flags]
    if shape != "baseline" and importlib.util.find_spec("pytest") is None:
        install = ["python", "-m", "pip", "install", "pytest"]
        steps.append((install, "runs tests; a run needs none"))
    steps.append((test, "its contract, in seconds"))
    run = ["lcrl-bench", "run", "--method", method, "--benchmark", "mini"]
    steps.append((run, "train and evaluate it"))
    return steps
