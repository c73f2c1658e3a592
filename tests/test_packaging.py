"""What is shipped is what is in the tree, and the tested versions fit the declared ranges."""

from __future__ import annotations

import email
import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from lcrl_bench import __version__

REPOSITORY = Path(__file__).parents[1]
CONTENT = ("assets", "baselines", "leaderboard", "tasks")
NOT_SHIPPED = tuple(
    f"lcrl_bench/leaderboard/{name}/"
    for name in ("checkpoints", "recordings", "site", "submissions")
)
"""The leaderboard's rows, and what is made of them."""
BUILD = "import sys; from setuptools import build_meta; print(build_meta.build_wheel(sys.argv[1]))"


def project() -> dict[str, Any]:
    return tomllib.loads((REPOSITORY / "pyproject.toml").read_text())


def pins() -> dict[str, Version]:
    lines = (REPOSITORY / "constraints.txt").read_text().splitlines()
    pairs = [line.split("==") for line in lines if line and not line.startswith("#")]
    return {canonicalize_name(name): Version(version) for name, version in pairs}


def requirements() -> list[Requirement]:
    """All that a developer needs."""
    table = project()["project"]
    texts = [*table["dependencies"], *table["optional-dependencies"]["dev"]]
    return [Requirement(text) for text in texts]


def applies(requirement: Requirement, extra: str = "") -> bool:
    """Whether this interpreter installs it."""
    return requirement.marker is None or requirement.marker.evaluate({"extra": extra})


def supported() -> list[str]:
    """The versions of Python that the package names, oldest first."""
    found = re.findall(r"Python :: (3\.\d+)", "\n".join(project()["project"]["classifiers"]))
    return sorted(found, key=Version)


def test_every_package_of_the_tree_is_listed():
    in_tree = set()
    for top in ("lcrl_bench", *CONTENT):
        for marker in (REPOSITORY / top).rglob("__init__.py"):
            folder = marker.parent.relative_to(REPOSITORY)
            in_tree.add(
                ".".join(folder.parts if top == "lcrl_bench" else ("lcrl_bench", *folder.parts))
            )
    assert sorted(project()["tool"]["setuptools"]["packages"]) == sorted(in_tree)


def test_every_module_lies_in_a_package():
    stray = [
        str(path.relative_to(REPOSITORY))
        for top in ("lcrl_bench", *CONTENT)
        for path in (REPOSITORY / top).rglob("*.py")
        if not (path.parent / "__init__.py").exists()
    ]
    assert stray == []


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built from a copy of the checkout, so that no build folder is left in it."""
    copy = tmp_path_factory.mktemp("checkout") / "source"
    copy.mkdir()
    for name in ("lcrl_bench", "tools", *CONTENT):
        unwanted = shutil.ignore_patterns("__pycache__", ".*")
        shutil.copytree(REPOSITORY / name, copy / name, ignore=unwanted)
    for name in ("pyproject.toml", "README.md", "LICENSE", "NOTICE"):
        shutil.copy(REPOSITORY / name, copy / name)
    out = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-W", "ignore", "-c", BUILD, str(out)]
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out / done.stdout.splitlines()[-1]


def wheel_path(path: Path) -> str:
    """Where a file of the checkout lies in the wheel."""
    relative = path.relative_to(REPOSITORY).as_posix()
    return relative if relative.startswith("lcrl_bench/") else f"lcrl_bench/{relative}"


def test_a_wheel_carries_every_file_of_the_packages_and_no_other(wheel: Path):
    in_tree = {
        wheel_path(path)
        for top in ("lcrl_bench", *CONTENT)
        for path in (REPOSITORY / top).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and not path.name.startswith(".")
    }
    in_tree = {name for name in in_tree if not name.startswith(NOT_SHIPPED)}
    in_wheel = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert sorted(in_tree - in_wheel) == []
    assert sorted(in_wheel - in_tree) == []
    assert "lcrl_bench/assets/classes.toml" in in_wheel


def test_a_wheel_carries_no_tool(wheel: Path):
    kept = {path.name for path in (REPOSITORY / "tools").rglob("*.toml")}
    assert kept
    for name in zipfile.ZipFile(wheel).namelist():
        assert "tools" not in Path(name).parts
        assert Path(name).name not in kept


def test_every_verb_has_help_from_the_wheel_alone(wheel: Path, tmp_path: Path):
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    program = (
        "import importlib.util, sys; from lcrl_bench.cli.main import VERBS, main; "
        "assert importlib.util.find_spec('tools') is None; "
        "sys.exit(any(main([verb.name, '--help']) for verb in VERBS))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_a_wheel_states_version_licence_and_command(wheel: Path):
    archive = zipfile.ZipFile(wheel)
    info = f"lcrl_bench-{__version__}.dist-info"
    metadata = email.message_from_bytes(archive.read(f"{info}/METADATA"))
    assert metadata["Version"] == __version__
    assert metadata["License-Expression"] == "Apache-2.0"
    assert sorted(metadata.get_all("License-File", [])) == ["LICENSE", "NOTICE"]
    assert b"Apache License" in archive.read(f"{info}/licenses/LICENSE")
    entry_points = archive.read(f"{info}/entry_points.txt").decode()
    assert "lcrl-bench = lcrl_bench.cli.main:entry_point" in entry_points


def test_the_command_and_its_data_work_from_the_wheel_alone(wheel: Path, tmp_path: Path):
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    program = (
        "import json; from importlib import resources; import lcrl_bench; "
        "text = (resources.files('lcrl_bench.assets') / 'classes.toml').read_text(); "
        "from lcrl_bench.cli.main import main; "
        "print(json.dumps([lcrl_bench.__file__, len(text), main(['--version'])]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    version, answer = done.stdout.splitlines()
    origin, length, status = json.loads(answer)
    assert version == f"lcrl-bench {__version__}"
    assert Path(origin).is_relative_to(tmp_path)
    assert (length > 0, status) == (True, 0)


def test_the_version_is_the_same_everywhere():
    citation = (REPOSITORY / "CITATION.cff").read_text()
    cited = re.search(r"^version: (.+)$", citation, flags=re.MULTILINE)
    assert cited is not None
    assert project()["project"]["version"] == __version__ == cited.group(1)
    assert importlib.metadata.version("lcrl-bench") == __version__


@pytest.mark.parametrize("requirement", requirements(), ids=lambda each: each.name)
def test_the_tested_version_is_in_the_declared_range(requirement: Requirement):
    pinned = pins()
    name = canonicalize_name(requirement.name)
    assert name in pinned, f"{name} is not in constraints.txt"
    assert pinned[name] in requirement.specifier


def test_everything_that_gets_installed_has_a_tested_version():
    # torch requires exact versions of most of CUDA's parts, so torch's pin fixes those.
    missing: set[str] = set()
    seen: set[tuple[str, str]] = set()
    wanted = [each for each in requirements() if applies(each)]
    todo = [(each.name, extra) for each in wanted for extra in ("", *each.extras)]
    while todo:
        name, extra = todo.pop()
        if (canonicalize_name(name), extra) in seen:
            continue
        seen.add((canonicalize_name(name), extra))
        if canonicalize_name(name) not in pins():
            missing.add(name)
        for text in importlib.metadata.requires(name) or ():
            child = Requirement(text)
            if applies(child, extra) and not (name == "torch" and "==" in str(child.specifier)):
                todo += [(child.name, each) for each in ("", *child.extras)]
    assert missing == set()


def test_this_interpreter_is_one_of_those_named():
    assert f"{sys.version_info.major}.{sys.version_info.minor}" in supported()


def test_every_file_names_the_same_versions_of_python():
    versions = supported()
    oldest, newest = versions[0], versions[-1]
    assert versions == [f"3.{minor}" for minor in range(11, 11 + len(versions))]
    table = project()
    assert table["project"]["requires-python"] == f">={oldest}"
    assert table["tool"]["ruff"]["target-version"] == f"py{oldest.replace('.', '')}"
    assert table["tool"]["pyright"]["pythonVersion"] == oldest
    script = (REPOSITORY / "scripts" / "bootstrap.sh").read_text()
    assert f'versions="{" ".join(reversed(versions))}"' in script
    workflow = (REPOSITORY / ".github" / "workflows" / "ci.yml").read_text()
    assert f"python: {json.dumps(versions)}" in workflow
    for name in ("README.md", "CONTRIBUTING.md", "Makefile", "scripts/bootstrap.sh"):
        text = " ".join((REPOSITORY / name).read_text().split())
        spans = re.findall(r"Python (3\.\d+) (?:to|or|and) (3\.\d+)", text.replace("# ", ""))
        assert spans, f"{name} names no versions of Python"
        assert set(spans) == {(oldest, newest)}, name


def test_the_oldest_and_the_newest_allowed_releases_are_tested_every_week():
    workflow = (REPOSITORY / ".github" / "workflows" / "bounds.yml").read_text()
    assert re.search(r'cron: "\d+ \d+ \* \* \d"', workflow)
    assert "sh scripts/test_bounds.sh ${{ matrix.bound }}" in workflow
    assert re.findall(r"bound: (\w+)", workflow) == ["oldest", "newest"]
    for line in project()["project"]["dependencies"]:
        assert re.search(r">=\d", line), f"{line} has no lower bound"


def test_a_demo_needs_no_tool_of_a_developer():
    extras = project()["project"]["optional-dependencies"]
    tools = {Requirement(text).name for text in extras["dev"]} - {"dm-control", "mujoco"}
    runs = [*project()["project"]["dependencies"], *extras["fast"]]
    assert not tools & {Requirement(text).name for text in runs}
    assert set(extras["dm-control"]) <= set(extras["dev"])
    # A run is several times slower without the compiler of its kernels.
    assert "numba" in {Requirement(text).name for text in runs}
    makefile = (REPOSITORY / "Makefile").read_text()
    calls = re.findall(r"^(\w+):.*\n.*bootstrap\.sh \S+ (\w+)$", makefile, flags=re.MULTILINE)
    assert dict(calls) == {"install": "fast", "setup": "dev"}
    needs = dict(re.findall(r"^(demo|test|check): (\w+)", makefile, flags=re.MULTILINE))
    assert needs == {"demo": "install", "test": "setup", "check": "setup"}
