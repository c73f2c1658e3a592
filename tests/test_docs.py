"""Every command and every program shown in the documentation runs."""

from __future__ import annotations

import ast
import importlib
import json
import re
import shlex
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.catalogue import list_benchmarks
from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.main import main
from lcrl_bench.cli.run import RunFlags
from lcrl_bench.errors import ExitCode
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.evaluation.results import MEASURES, Results
from lcrl_bench.evaluation.table import table_blocks
from tools.house_statistics.command import StatisticsFlags
from tools.optics.command import OpticsFlags
from tools.speed.command import SpeedFlags

ROOT = Path(__file__).parents[1]
PAGES = (
    "README.md",
    "docs/importing-a-house.md",
    "docs/adding-a-method.md",
    "docs/building-a-benchmark.md",
    "docs/clusters.md",
    "docs/choosing-settings.md",
    "docs/asking.md",
    "docs/playing.md",
    "docs/submitting-a-method.md",
    "docs/leaderboard.md",
)
LINKED = (
    *PAGES,
    "docs/metrics.md",
    "docs/reading-a-recording.md",
    "docs/reproducing.md",
    "docs/reliability.md",
    "docs/gymnasium.md",
    "docs/optics.md",
    "docs/gallery.md",
    "docs/performance.md",
    "docs/kernels.md",
    "CONTRIBUTING.md",
    "tasks/mini/README.md",
    "tasks/lcrl-v1/README.md",
)
FOLDERS = (
    *("assets", "baselines", "docs", "lcrl_bench", "leaderboard", "scripts", "tasks", "tests"),
    "tools",
)
"""Folders of the repository that pages name files of."""
MADE = (
    "leaderboard/checkpoints/mini",
    "leaderboard/recordings",
    "leaderboard/site",
    "leaderboard/submissions/mini",
)
"""What the commands of the pages make in them."""
SHORT = ("--set", "passes=1", "least_steps=1")
"""Keeps a shown training to one pass: what is tested is that the command works as written."""


def blocks(page: str, language: str) -> list[str]:
    text = (ROOT / page).read_text("utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def commands(page: str) -> list[str]:
    lines = [line for block in blocks(page, "sh") for line in block.splitlines()]
    return [line.partition("#")[0].strip() for line in lines if line.strip()]


def really(text: str) -> str:
    """Name a shortened run's folder after the benchmark and the settings that it is really of."""
    return re.sub(r"\bruns/mini/(lcrl|my_method)\b", r"runs/tiny/\1-least_steps-1-passes-1", text)


def on_the_board(words: list[str]) -> list[str]:
    """The flags by which the leaderboard's commands find the tiny benchmark, and are quick."""
    if words[0] == "run" and "--seeds" in words:
        return ["--no-record"]
    if words[0] == "submit":
        return ["--benchmark", "mini"]
    if words[:2] == ["leaderboard", "verify"]:
        return ["--benchmark", "mini", "--no-record"]
    if words[:2] == ["leaderboard", "build"]:
        return ["--benchmarks", "mini", "--no-viewer"]
    return []


def without_cluster(words: list[str]) -> list[str]:
    """The words without the flags that name a cluster: this machine stands in for it."""
    kept: list[str] = []
    flag = ""
    for word in words:
        flag = word if word.startswith("--") else flag
        kept += [] if flag in ("--cluster", "--cluster-options") else [word]
    return kept


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A folder as a reader's: nothing but the method of the guide, and what commands make."""
    (program,) = [b for b in blocks("docs/adding-a-method.md", "python") if "class Counting" in b]
    (tmp_path / "counting.py").write_text(program)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("page", PAGES)
def test_every_command_of_a_page_works_in_the_order_shown(page, workplace, capsys):
    shown = [c for c in commands(page) if c.startswith("lcrl-bench ")]
    assert shown, f"{page} shows no command"
    write_benchmark(workplace / "mini", tiny_benchmark())
    for command in shown:
        words = shlex.split(command)[1:]
        if words[0] == "run" and {"lcrl", "my_method/method.py:MyMethod"} & set(words):
            words += SHORT
        if words[0] == "run" and "--benchmark" not in words:
            words += ["--benchmark", "mini"]
        if words[0] == "search":
            words += ["passes=1", "least_steps=1", "--houses", "1", "--workers", "1"]
            words += ["--benchmark", "mini"]
        if words[0] in {"ask", "play"} and "--benchmark" not in words:
            words += ["--benchmark", "mini"]
        if words[0] == "play" and "--keys" not in words:
            words += ["--keys", "wvvdmp"]
        words += on_the_board(words)
        words = without_cluster(words)
        words = [really(word) for word in words]
        words = [
            word.replace("/mini-lcrl.", "/tiny-lcrl-least_steps-1-passes-1.") for word in words
        ]
        # A shipped benchmark is a folder too; the tiny one stands in for the wait.
        words = [str(workplace / "mini") if word == "mini" else word for word in words]
        assert main(words) == ExitCode.DONE, f"{command}: {capsys.readouterr().err}"


@pytest.mark.parametrize("page", LINKED)
def test_what_the_programs_of_a_page_import_is_there(page):
    for program in blocks(page, "python"):
        for node in ast.walk(ast.parse(program)):
            if isinstance(node, ast.ImportFrom) and str(node.module).startswith("lcrl_bench"):
                module = importlib.import_module(str(node.module))
                for alias in node.names:
                    assert hasattr(module, alias.name), f"{page}: {node.module} has no {alias.name}"


def test_the_make_targets_that_are_shown_exist_and_demo_is_the_contract():
    makefile = (ROOT / "Makefile").read_text("utf-8")
    targets = [c.split()[1] for c in commands("README.md") if c.startswith("make ")]
    assert targets == ["demo", "test"]
    for target in targets:
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE)
    assert "-m lcrl_bench.run --method lcrl --benchmark mini" in makefile


def test_what_runs_if_nothing_else_is_said_is_shipped():
    assert RunFlags("lcrl").benchmark in list_benchmarks()


def test_the_verbs_of_the_table_in_the_readme_exist(capsys):
    text = (ROOT / "README.md").read_text("utf-8")
    shown = re.findall(r"`lcrl-bench ([a-z-]+)", text)
    assert {"doctor", "list", "show"} <= set(shown)
    for verb in shown:
        assert main([verb, "--help"]) == ExitCode.DONE
    capsys.readouterr()


def test_commands_are_shown_as_they_are_typed_in_the_activated_environment():
    # The README says once how the environment is activated, before the first command.
    before, activation, after = (
        (ROOT / "README.md").read_text("utf-8").partition("\n. .venv/bin/activate\n")
    )
    assert activation
    assert "```sh\nlcrl-bench" not in before
    assert "```sh\nlcrl-bench" in after
    programs = {"lcrl-bench", "make", "pip", "python", "rerun", "."}
    for page in LINKED:
        text = (ROOT / page).read_text("utf-8")
        assert ".venv/bin/lcrl-bench" not in text, page
        assert ".venv/bin/python" not in text, page
        assert {command.split()[0] for command in commands(page)} <= programs, page


def test_what_is_shown_with_pip_can_be_installed():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    text = (ROOT / "README.md").read_text("utf-8")
    shown = re.findall(r'pip install "?([\w./-]*lcrl[\w-]+)', text)
    assert [name.rpartition("/")[2] for name in shown] == ["lcrl_bench", project["name"]]
    # It is in no index, so its bare name is nothing that pip could install.
    for page in LINKED:
        text = (ROOT / page).read_text("utf-8")
        assert not re.search(r"pip install '?\"?lcrl-bench(?! @)", text), page


def test_the_settings_shown_for_lcrl_are_settings(workplace, capsys):
    write_benchmark(workplace / "mini", tiny_benchmark())
    for command in commands("baselines/lcrl/README.md"):
        words = shlex.split(command)[1:]
        if "--set" in words:
            extra = [*SHORT, *(word for word in words if "=" in word)]
            flags = ["--benchmark", str(workplace / "mini"), "--no-record", *extra]
            assert main(["run", "--method", "lcrl", *flags]) == ExitCode.DONE
    capsys.readouterr()


def tool_commands(page: str) -> list[str]:
    """Every `python -m tools...` of a page, in its blocks and in its sentences."""
    text = (ROOT / page).read_text("utf-8")
    inline = [" ".join(each.split()) for each in re.findall(r"(?<!`)`([^`]+)`", text)]
    return [each for each in (*commands(page), *inline) if each.startswith("python -m tools.")]


def test_the_flags_shown_for_the_tools_are_flags():
    tools = {
        "tools.speed": SpeedFlags,
        "tools.house_statistics": StatisticsFlags,
        "tools.optics": OpticsFlags,
    }
    shown = set()
    for page in (*LINKED, "CONTRIBUTING.md", "CHANGELOG.md"):
        for command in tool_commands(page):
            # The shell expands `$(seq ...)`.
            words = subprocess.check_output(
                ["sh", "-c", f"printf '%s\\n' {command}"], text=True
            ).splitlines()
            shown.add((page, words[2]))
            flags = parse_arguments(tools[words[2]], words[3:], program=" ".join(words[:3]))
            if isinstance(flags, SpeedFlags):
                assert flags.benchmark in list_benchmarks()
    assert {
        ("README.md", "tools.speed"),
        ("docs/performance.md", "tools.speed"),
        ("docs/optics.md", "tools.optics"),
        ("docs/building-a-benchmark.md", "tools.optics"),
        ("docs/building-a-benchmark.md", "tools.house_statistics"),
        ("tasks/lcrl-v1/README.md", "tools.house_statistics"),
    } <= shown


@pytest.mark.parametrize("page", LINKED)
def test_no_page_shows_a_former_verb(page):
    text = (ROOT / page).read_text("utf-8")
    former = r"lcrl-bench\s+(house\s+statistics|benchmark\s+optics)"
    assert re.search(former, text) is None


def test_the_program_about_kernels_works_as_shown(monkeypatch):
    pytest.importorskip("numba")
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "auto")  # Set back afterwards.
    (program,) = blocks("docs/kernels.md", "python")
    exec(compile(program, "docs/kernels.md", "exec"), {})


def test_the_page_on_kernels_pairs_each_with_the_module_that_it_equals():
    text = (ROOT / "docs/kernels.md").read_text("utf-8")
    kernels = [
        path.relative_to(ROOT).as_posix()
        for path in ROOT.glob("lcrl_bench/**/kernels/*.py")
        if path.name != "__init__.py"
    ]
    rows = {line.split("`")[1]: line for line in text.splitlines() if line[:3] == "| `"}
    assert set(kernels) <= set(rows)
    paired = [kernel for kernel in kernels if "tests/" in rows[kernel]]
    assert len(paired) == 5
    for kernel in paired:
        plain = kernel.replace("kernels/", "")
        assert f"`{plain}`" in rows[kernel]
        assert (ROOT / plain).exists()


def test_the_viewer_takes_the_flags_shown():
    (shown,) = commands("docs/reading-a-recording.md")
    program, flag, *_ = shlex.split(shown)
    rerun = Path(sys.executable).with_name(program)
    answer = subprocess.run([rerun, "--help"], capture_output=True, text=True)
    assert answer.returncode == 0
    assert flag in answer.stdout


def test_the_programs_about_gymnasium_work_as_shown(workplace, capsys):
    folder = workplace / "mini"
    write_benchmark(folder, replace(tiny_benchmark(), name="mini"))
    (command,) = commands("docs/gymnasium.md")
    words = [str(folder) if word == "mini" else word for word in shlex.split(command)[1:]]
    assert main([*words, "--no-record", *SHORT]) == ExitCode.DONE
    program = "\n".join(blocks("docs/gymnasium.md", "python"))
    # As above: the tiny benchmark, and a training that is short.
    assert "learn(10_000)" in program
    program = really(program).replace('"runs/tiny', '"runs/mini')
    program = program.replace('"mini"', repr(str(folder))).replace("learn(10_000)", "learn(1_100)")
    assert "learn(60_000)" in program
    program = program.replace("learn(60_000)", "learn(2_048)").replace("range(40)", "range(2)")
    exec(compile(program, "docs/gymnasium.md", "exec"), {})
    said = capsys.readouterr().out.splitlines()
    assert said[-1] == "True"
    assert re.fullmatch(r"\('(go|move) .*', '(go|move) .*'\)", said[-2])
    assert re.fullmatch(r"mean reward: \d+\.\d+", said[-3])
    assert re.fullmatch(r"reached in \d+% of the last episodes", said[-4])
    assert said[-5] == "(4, 4, 24, 32)"
    assert re.fullmatch("go to the .* (not )?reached", said[-6])
    assert (workplace / "episode.gif").stat().st_size > 10_000


def test_the_page_on_metrics_names_every_figure_and_control():
    named = set(re.findall(r"`([a-z_-]+)`", (ROOT / "docs/metrics.md").read_text("utf-8")))
    assert {*MEASURES, *Failure, *Control} <= named


@pytest.mark.parametrize("page", LINKED)
def test_links_to_files_lead_somewhere(page):
    text = (ROOT / page).read_text("utf-8")
    for target in re.findall(r"\]\(([^)#:]+)\)", text):
        assert (ROOT / page).parent.joinpath(target).exists(), f"{page} links to {target}"


@pytest.mark.parametrize("page", LINKED)
def test_a_path_into_the_repository_leads_somewhere(page):
    text = (ROOT / page).read_text("utf-8")
    named = re.findall(rf"(?<![\w./-])(?:{'|'.join(FOLDERS)})/[\w./<>*-]*\w", text)
    # An environment of Gymnasium is called like a path.
    kept = {each for each in named if not each.startswith((*MADE, "lcrl_bench/House-v"))}
    for path in kept:
        # `<source>` stands for any name.
        pattern = re.sub(r"<[^>]*>", "*", path).rstrip("/.")
        assert list(ROOT.glob(pattern)), f"{page} names {path}"


def test_the_readmes_demo_table_has_the_blocks_that_are_printed():
    text = (ROOT / "README.md").read_text("utf-8")
    part = text.partition("\n## What `make demo` prints\n")[2].partition("\n## ")[0]
    tables = [
        [line for line in block.splitlines() if line[:1] == "|"] for block in part.split("\n\n")
    ]
    tables = [table for table in tables if table and " PICK " in table[0]]
    shown = [[row.strip("| ").split(" | ") for row in table] for table in tables]
    names = ("lcrl", "random", "optimal", "constant", "lexical")
    rows = {name: Results(name, (0,), (), {"success": np.empty((1, 0))}) for name in names}
    own = rows.pop("lcrl")
    printed = table_blocks(replace(own, beside=rows))
    assert [tuple(table[0]) for table in shown] == [block.headings for block in printed]
    assert {tuple(row[0] for row in block.rows) for block in printed} == {names}
    for table in shown:
        assert [cells[0].strip("*") for cells in table[2:]] == list(names)
    assert max(len(line) for table in tables for line in table) <= 80


def test_the_readmes_table_is_the_published_one():
    published = json.loads((ROOT / "docs/results/table-1.json").read_text("utf-8"))
    lines = (ROOT / "README.md").read_text("utf-8").replace("**", "").splitlines()
    compared = 0
    for row in published["rows"]:
        figures = [
            row["figures"][f"{split}.total"] for split in ("train", "test-task", "test-house")
        ]
        for line in lines:
            if line.startswith(f"| {row['label']} |"):
                compared += 1
                assert re.findall(r"\| ([\d.]+)", line) == [
                    f"{each['mean']:.1f}" for each in figures
                ]
                intervals = [f"[{each['low']:.0f}, {each['high']:.0f}]" for each in figures]
                assert re.findall(r"\[[^]]*\]", line) in (intervals, [])
    assert compared == 9
