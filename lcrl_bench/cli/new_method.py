"""`lcrl-bench new-method`: a method that runs, learns and has a test, to start from.

Its files are those of `assets/method_template` with the name replaced. The template is a method
like any other, called `my_method`: it is linted, type-checked and tested as it stands.
"""

from __future__ import annotations

import importlib
import importlib.util
import keyword
import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Final, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, say, suggest
from lcrl_bench.errors import DuplicateNameError, ExitCode, InvalidNameError, UsageError
from lcrl_bench.methods.registry import BASELINES, method_registry
from lcrl_bench.names import check_name
from lcrl_bench.storage import atomic_folder, write_bytes

Shape = Literal["folder", "package", "baseline"]
"""A folder that is run by path, an installable package, or a method of the suite."""

NAME: Final = "my_method"
CLASS: Final = "MyMethod"
"""Name of the template, and of its class."""
BY_FILE: Final = f"{NAME}/method.py:{CLASS}"
"""How the template is run while it isn't registered."""
SOURCES: Final[dict[Shape, dict[str, str]]] = {
    "folder": {
        "method.py": "method.py",
        "test_method.py": "test_method.py",
        "README.md": "README.md",
    },
    "package": {
        f"{NAME}/__init__.py": "",
        f"{NAME}/method.py": "method.py",
        f"{NAME}/test_method.py": "test_method.py",
        "README.md": "README.md",
        "pyproject.toml": "package.toml",
    },
    "baseline": {
        "__init__.py": "",
        "method.py": "method.py",
        "method.toml": "method.toml",
        "README.md": "README.md",
    },
}
"""Shape → file to write → file of the template, or "" for one with only a docstring. A baseline's
contract is tested by `tests/methods/test_every_method.py`."""
RULE: Final = "use lower-case letters, digits and '_', starting with a letter, as in my_method"
CONTENTS: Final = {
    "method.py": "its settings, and its objective: the loss of a training step",
    "README.md": "its source, what is faithful to it and what differs",
    "test_method.py": "tests: the contract of a method, and that it learns in a tiny house",
    "method.toml": "its name in the suite",
    "pyproject.toml": "a package that registers it, by the entry point lcrl_bench.methods",
    "__init__.py": "makes the folder a Python package",
}
"""File → its contents."""


@dataclass(frozen=True)
class NewMethodFlags:
    """Write a method to start from: it runs, learns and has a test."""

    name: tyro.conf.Positional[str]
    """A Python identifier in lower case, such as my_method; its class is then MyMethod."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER")] = None
    """The folder to write, which must not exist; default: ./<name>."""
    package: bool = False
    """Write an installable package, registered by the entry point `lcrl_bench.methods`."""
    baseline: bool = False
    """Write into `baselines/` of this checkout, as a method of the suite."""
    json: bool = False
    """Print only a JSON object on stdout."""


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
        print_table(("file", "contents"), rows)
    if shape == "baseline":
        line = f'"{BASELINES}.{flags.name}"'
        say(f"add {line} to `packages` in pyproject.toml, so that wheels include it")
    for words, purpose in steps:
        suggest(words, purpose)
    return ExitCode.DONE


def _shape(flags: NewMethodFlags) -> Shape:
    if flags.baseline and (flags.package or flags.out is not None):
        raise UsageError("--baseline decides what is written and where: drop --package and --out.")
    return "baseline" if flags.baseline else "package" if flags.package else "folder"


def baselines_folder() -> Path:
    """`baselines/` of the checkout that is running.

    Raises:
        UsageError: If the suite is installed without its checkout.
    """
    folder = Path(next(iter(importlib.import_module(BASELINES).__path__)))
    if not (folder.parent / "pyproject.toml").is_file():
        reason = "--baseline needs a checkout of the suite, and this one is installed."
        raise UsageError(f"{reason} Drop it, or write a package of your own: --package.")
    return folder


def next_steps(name: str, folder: Path, shape: Shape) -> list[tuple[list[str], str]]:
    """The next commands, and what each does."""
    test, method = ["python", "-m", "pytest", str(folder)], name
    steps = []
    if shape == "folder":
        method = f"{folder / 'method.py'}:{class_name(name)}"
    elif shape == "package":
        install = ["python", "-m", "pip", "install", "--no-deps", "--editable", str(folder)]
        steps.append((install, "lcrl-bench list methods will list it"))
    else:
        flags = f"PYTEST_FLAGS=tests/methods/test_every_method.py -k {name}"
        test = ["make", "test", flags]
    if shape != "baseline" and importlib.util.find_spec("pytest") is None:
        install = ["python", "-m", "pip", "install", "pytest"]
        steps.append((install, "runs tests; training does without"))
    steps.append((test, "test its contract, in seconds"))
    run = ["lcrl-bench", "run", "--method", method, "--benchmark", "mini"]
    steps.append((run, "train and evaluate it"))
    return steps


def class_name(name: str) -> str:
    """Class of a method: `"MyMethod"` for `"my_method"`."""
    return "".join(word.capitalize() for word in name.split("_"))


def check_method_name(name: str) -> None:
    """Refuse a name that a new method can't have.

    Raises:
        InvalidNameError: If it is not a lower-case Python identifier, or its class would have a
            name that the template's code uses.
        DuplicateNameError: If a method has that name.
        UsageError: If an installed Python package has that name.
    """
    check_name("method", name)
    if not name.isidentifier() or keyword.iskeyword(name) or keyword.iskeyword(class_name(name)):
        raise InvalidNameError("method", name, RULE)
    if name in method_registry():
        raise DuplicateNameError("method", name)
    code = _template("method.py").replace(CLASS, "")
    for word in (class_name(name), f"{class_name(name)}Config"):
        if re.search(rf"\b{word}\b", code):
            reason = f"{word} already has a meaning in its code; choose another name"
            raise InvalidNameError("method", name, reason)
    if importlib.util.find_spec(name) is not None:
        reason = f"'{name}' is the name of an installed Python package."
        raise UsageError(f"{reason} Choose another name.")


def draft(name: str, shape: Shape) -> dict[str, str]:
    """The files of a new method: path in its folder → text.

    Args:
        name: Checked by `check_method_name`.
        shape: What the folder is to be.
    """
    return {
        _named(path, name): _text(source, name, shape) for path, source in SOURCES[shape].items()
    }


def _text(source: str, name: str, shape: Shape) -> str:
    text = _template(source) if source else f'"""{CLASS}."""\n'
    if shape != "folder":
        text = text.replace(BY_FILE, NAME)
    return _named(text, name)


def _named(text: str, name: str) -> str:
    return text.replace(NAME, name).replace(CLASS, class_name(name))


def _template(file: str) -> str:
    return files("lcrl_bench.assets").joinpath("method_template", file).read_text("utf-8")


def write_folder(folder: Path, texts: dict[str, str]) -> None:
    """Write a new folder, atomically.

    Args:
        folder: Where to write; parent folders are created.
        texts: Path in it → content.

    Raises:
        UsageError: If something exists there.
        EnvironmentMissingError: If it can't be written.
    """
    if folder.exists() or folder.is_symlink():
        reason = f"{folder} already exists and is left untouched."
        raise UsageError(f"{reason} Choose another name, or another folder with --out.")
    with atomic_folder(folder) as fresh:
        for path, text in texts.items():
            write_bytes(fresh / path, text.encode())
