"""`list` and `show` answer from the registries, quickly, as a table or as one JSON object."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from lcrl_bench.benchmarks.catalogue import list_benchmarks
from lcrl_bench.cli import main as door
from lcrl_bench.cli.inventory import KINDS, entries
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.sources import house_sources
from lcrl_bench.methods.registry import method_registry

NAMES = {
    "methods": [entry.name for entry in method_registry()],
    "benchmarks": list(list_benchmarks()),
    "sources": [entry.name for entry in house_sources()],
}

IMPORTED = """
import json, sys
from lcrl_bench.cli.main import main
status = main(["list", sys.argv[1], "--json"])
print(json.dumps([status, sorted(sys.modules)]), file=sys.stderr)
"""


@pytest.mark.parametrize("kind", KINDS)
def test_a_json_list_is_one_object_of_all_registered_names(
    kind: str, capsys: pytest.CaptureFixture[str]
):
    assert door.main(["list", kind, "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert list(answer) == [kind]
    assert [row["name"] for row in answer[kind]] == NAMES[kind]
    assert all(row["summary"] for row in answer[kind])


@pytest.mark.parametrize("kind", KINDS)
def test_a_table_has_a_row_for_every_name(kind: str, capsys: pytest.CaptureFixture[str]):
    assert door.main(["list", kind]) == ExitCode.DONE
    rows = capsys.readouterr().out.splitlines()[2:]
    assert [row.split()[0] for row in rows] == NAMES[kind]


@pytest.mark.parametrize("kind", KINDS)
def test_listing_imports_no_torch_and_no_physics(kind: str):
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED, kind], capture_output=True, text=True, check=True
    )
    status, modules = json.loads(done.stderr.splitlines()[-1])
    assert status == 0
    assert not {"torch", "mujoco", "dm_control", "rerun", "matplotlib"} & set(modules)


def test_an_unknown_kind_is_a_usage_error_that_lists_the_kinds(
    capsys: pytest.CaptureFixture[str],
):
    assert door.main(["list", "datasets"]) == ExitCode.USAGE
    shown = capsys.readouterr()
    assert shown.out == ""
    assert all(kind in shown.err for kind in KINDS)


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, entry.name) for kind in KINDS for entry in entries(kind)]
)
def test_everything_listed_can_be_shown(kind: str, name: str, capsys: pytest.CaptureFixture[str]):
    assert door.main(["show", name, "--kind", kind, "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert (answer["kind"], answer["name"]) == (kind.removesuffix("s"), name)
    assert door.main(["show", name, "--kind", kind]) == ExitCode.DONE
    assert name in capsys.readouterr().out


def test_a_method_shows_its_readme(capsys: pytest.CaptureFixture[str], repository: Path):
    assert door.main(["show", "lcrl"]) == ExitCode.DONE
    readme = (repository / "baselines" / "lcrl" / "README.md").read_text()
    assert readme.strip() in capsys.readouterr().out


def test_a_benchmark_shows_the_counts_of_its_files(
    capsys: pytest.CaptureFixture[str], repository: Path
):
    assert door.main(["show", "mini", "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    rows = json.loads((repository / "tasks" / "mini" / "tasks.json").read_text())["tasks"]
    assert sum(answer["splits"].values()) == answer["pick"] + answer["nav"] == len(rows)
    recorded = json.loads((repository / "tasks" / "mini" / "benchmark.json").read_text())
    assert answer["fingerprint"] == recorded["fingerprint"]


def test_a_mistyped_name_suggests_the_nearest(capsys: pytest.CaptureFixture[str]):
    assert door.main(["show", "procthr"]) == ExitCode.USAGE
    assert "Did you mean 'procthor'?" in capsys.readouterr().err
