"""`new-method` writes a method that runs, learns, keeps its contract, and says what to do next."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli import new_method
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.methods.network_method import NetworkMethod
from lcrl_bench.methods.registry import method_registry, resolve_method


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    # A package that a test wrote and imported is not installed for the next one.
    for name in [name for name in sys.modules if name.partition(".")[0] == "soft_gaze"]:
        del sys.modules[name]


def next_commands(text: str) -> list[str]:
    return re.findall(r"^next: (.*?)   #", text, flags=re.MULTILINE)


def test_the_method_that_is_written_runs_and_passes_its_own_test(here, capsys):
    assert main(["new-method", "soft_gaze"]) == ExitCode.DONE
    test, run = next_commands(capsys.readouterr().err)
    assert sorted(os.listdir("soft_gaze")) == ["README.md", "method.py", "test_method.py"]

    words = [sys.executable, *shlex.split(test)[1:], "-q", "-p", "no:cacheprovider"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert "4 passed" in done.stdout

    write_benchmark(here / "tiny", tiny_benchmark())
    words = [str(here / "tiny") if word == "mini" else word for word in shlex.split(run)[1:]]
    words += ["--set", "passes=1", "least_steps=0", "penalty=0.5", "--no-record", "--out", "done"]
    assert main([*words, "--json"]) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out)["method"] == "soft_gaze/method.py:SoftGaze"


@pytest.mark.parametrize("shape", ["folder", "package", "baseline"])
def test_nothing_of_the_template_s_name_is_left_and_the_linter_is_content(shape, here):
    texts = new_method.draft("soft_gaze", shape)
    assert not [
        path for path, text in texts.items() if re.search("my_method|MyMethod", path + text)
    ]
    new_method.write_folder(here / "soft_gaze", texts)
    words = ["check", "--isolated", "--no-cache", "--select", "E,F,W,D", "--ignore", "D105,D107"]
    words += ["--line-length", "100", "--config", "lint.pydocstyle.convention='google'"]
    done = subprocess.run(
        [sys.executable, "-m", "ruff", *words, "soft_gaze"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_package_joins_by_its_entry_point(here, monkeypatch, capsys):
    assert main(["new-method", "soft_gaze", "--package", "--out", "site", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["next"][-1] == "lcrl-bench run --method soft_gaze --benchmark mini"
    project = tomllib.loads(Path("site/pyproject.toml").read_text())
    # What an installer would write beside the package.
    info = here / "site" / "soft_gaze-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.4\nName: soft_gaze\nVersion: 0.1.0\n")
    groups = project["project"]["entry-points"]
    lines = [
        f"[{group}]\n{k} = {v}\n" for group, points in groups.items() for k, v in points.items()
    ]
    (info / "entry_points.txt").write_text("".join(lines))
    monkeypatch.syspath_prepend(str(here / "site"))
    found = {entry.name: entry.summary for entry in method_registry()}
    assert found["soft_gaze"] == "from soft_gaze"
    assert issubclass(resolve_method("soft_gaze"), NetworkMethod)
    assert project["tool"]["setuptools"]["packages"] == ["soft_gaze"]
    assert (here / "site" / "soft_gaze" / "__init__.py").is_file()


def test_a_baseline_is_written_where_the_suite_finds_it(here, monkeypatch, capsys):
    (here / "baselines").mkdir()
    monkeypatch.setattr(new_method, "baselines_folder", lambda: here / "baselines")
    assert main(["new-method", "soft_gaze", "--baseline"]) == ExitCode.DONE
    folder = here / "baselines" / "soft_gaze"
    assert sorted(os.listdir(folder)) == ["README.md", "__init__.py", "method.py", "method.toml"]
    entry = tomllib.loads((folder / "method.toml").read_text())
    assert entry["name"] == "soft_gaze"
    assert entry["target"] == "lcrl_bench.baselines.soft_gaze.method:SoftGaze"
    assert '"lcrl_bench.baselines.soft_gaze"' in capsys.readouterr().err


def test_a_baseline_needs_a_checkout(here, monkeypatch, repository):
    assert new_method.baselines_folder() == repository / "baselines"
    package = type("Package", (), {"__path__": [str(here / "lcrl_bench" / "baselines")]})
    monkeypatch.setattr(new_method.importlib, "import_module", lambda _name: package)
    with pytest.raises(UsageError, match="--package"):
        new_method.baselines_folder()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("lcrl", "already registered"),
        ("soft-gaze", "use lower-case letters"),
        ("SoftGaze", "use 1 to 80 lower-case"),
        ("../soft_gaze", "use 1 to 80 lower-case"),
        ("3d", "use lower-case letters"),
        ("class", "use lower-case letters"),
        ("none", "use lower-case letters"),
        ("training", "TrainingConfig already has a meaning"),
        ("network_method", "NetworkMethod already has a meaning"),
        ("json", "an installed Python package"),
    ],
)
def test_a_name_that_can_not_be_used_is_refused_with_the_reason(name, said, here, capsys):
    assert main(["new-method", name]) == ExitCode.USAGE
    assert said in capsys.readouterr().err
    assert os.listdir(here) == []


def test_what_is_there_is_never_overwritten(here, capsys):
    (here / "soft_gaze").mkdir()
    (here / "file").write_text("kept")
    (here / "link").symlink_to("nowhere")
    for place in ("soft_gaze", "file", "link"):
        assert main(["new-method", "soft_gaze", "--out", place]) == ExitCode.USAGE
        assert "is left untouched" in capsys.readouterr().err
    assert os.listdir("soft_gaze") == []
    assert (here / "file").read_text() == "kept"


def test_a_folder_is_there_whole_or_not_at_all(here, monkeypatch, capsys):
    written = Path.write_bytes

    def fails_at_the_readme(path, data):
        if "README" in path.name:
            raise OSError(28, "No space left on device")
        return written(path, data)

    monkeypatch.setattr(Path, "write_bytes", fails_at_the_readme)
    assert main(["new-method", "soft_gaze"]) == ExitCode.ENVIRONMENT
    message = "soft_gaze/README.md: can't be written: No space left on device"
    assert message in capsys.readouterr().err
    assert os.listdir(here) == []


def test_where_a_baseline_goes_is_not_for_two_flags_to_say(here, capsys):
    for more in (["--package"], ["--out", "elsewhere"]):
        assert main(["new-method", "soft_gaze", "--baseline", *more]) == ExitCode.USAGE
    assert os.listdir(here) == []
    capsys.readouterr()
