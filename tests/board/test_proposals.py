"""What a pull request's rows go through: the suite's own code runs, the proposal's never."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from board_samples import Desk

ROOT = Path(__file__).parents[2]
WORKFLOW = ROOT / ".github" / "workflows" / "submission.yml"
SCRIPT = ROOT / "scripts" / "verify_submissions.sh"


def propose(base: Path, desk: Desk) -> tuple[int, str]:
    """Run the script as the workflow does; its exit status, and what it said."""
    program = Path(sys.executable).with_name("lcrl-bench")
    flags = ["--benchmark", str(desk.benchmark), "--renderer", "rays", "--no-record"]
    words = [str(base), str(desk.home), str(base / "found"), *flags]
    done = subprocess.run(
        [SCRIPT, *words],
        env={**os.environ, "LCRL_BENCH": str(program)},
        capture_output=True,
        text=True,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.fixture
def base(tmp_path) -> Path:
    folder = tmp_path / "base"
    folder.mkdir()
    return folder


def test_an_honest_row_passes_and_its_verification_is_kept(base, spoilt):
    status, said = propose(base, spoilt)
    assert status == 0, said
    assert "verified: " in said
    assert [path.name for path in (base / "found").iterdir()] == ["tiny-lcrl.verified.json"]


def test_a_row_that_is_there_already_is_not_run_again(base, spoilt):
    shutil.copytree(spoilt.home / "leaderboard", base / "leaderboard")
    assert propose(base, spoilt) == (0, "no row is added or changed\n")


def test_a_tampered_row_fails_with_the_reason(base, spoilt):
    document = spoilt.document()
    document["controls"]["lexical"]["train"]["total"] -= 2
    spoilt.rewrite(document)
    status, said = propose(base, spoilt)
    assert status == 1
    assert "controls.lexical.train.total" in said


def test_a_verification_can_not_be_brought_along(base, spoilt):
    spoilt.verify_and_keep()
    status, said = propose(base, spoilt)
    assert (status, "only who runs one may" in said) == (1, True)


def test_the_proposals_code_is_not_run(base, spoilt):
    spoilt.rewrite({**spoilt.document(), "method": "theirs", "registered": True})
    proof = spoilt.home / "was-run"
    trap = f"#!/bin/sh\ntouch {proof}\n"
    for name in (".venv/bin/lcrl-bench", "scripts/verify_submissions.sh", "lcrl_bench/__init__.py"):
        path = spoilt.home / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(trap)
    status, said = propose(base, spoilt)
    assert (status, "not registered here" in said) == (2, True)
    assert not proof.exists()


def test_the_workflow_can_read_and_nothing_else():
    text = WORKFLOW.read_text("utf-8")
    assert re.search(r"^permissions:\n  contents: read\n\n", text, flags=re.MULTILINE)
    assert "pull_request_target" not in text
    assert "secrets" not in re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE)
    checkouts = text.count("uses: actions/checkout")
    assert text.count("persist-credentials: false") == checkouts == 2
    # No text of the pull request becomes part of a command.
    programs = re.findall(r"run: (?:\|\n((?:          .*\n)+)|(.+))", text)
    assert len(programs) == 3
    assert not any("${{" in part for program in programs for part in program)


def test_the_workflow_runs_the_script_of_the_base():
    assert "base/scripts/verify_submissions.sh base proposed found" in WORKFLOW.read_text("utf-8")
    assert SCRIPT.stat().st_mode & 0o111
