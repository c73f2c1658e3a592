"""A row is run again: what was raised, swapped or made elsewhere is found."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import pytest
from benchmark_samples import tiny_benchmark, tiny_session
from board_samples import SETTINGS

from lcrl_bench.board.admission import TOLERANCE, read_submission
from lcrl_bench.board.collection import Statement, collect
from lcrl_bench.board.verdict import compare
from lcrl_bench.board.verification import Claim, trusted_method, verify
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.run import RunSpec, run
from lcrl_bench.evaluation.session import Session, Workplace
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.storage import write_json


def raise_by(document, points: float) -> None:
    """Raise a figure everywhere it stands, so that nothing contradicts it."""
    figure = document["figures"]["train"]["total"]
    figure["mean"] += points
    figure["high"] = max(figure["high"], figure["mean"])
    document["measures"]["train"]["success"]["total"] += points
    for seed in document["seeds"]:
        seed["splits"]["train"]["total"] += points
        seed["measures"]["train"]["success"]["total"] += points


def rename_files(document) -> None:
    """Say that other checkpoints were submitted, as from another machine."""
    for number, seed in enumerate(document["seeds"]):
        for file in seed["files"]:
            file["sha256"] = f"{number:064x}"


def test_an_honest_row_is_verified(desk):
    found = desk.verify()
    assert (found.verdict, found.evaluated, found.differences) == ("verified", True, [])


def test_the_first_seeds_run_is_shown_as_it_was_submitted(desk):
    shown = []
    desk.verify(show=lambda run, session: shown.append((run, session)))
    ((run, session),) = shown
    assert (run.spec.seed, dict(run.spec.settings)) == (0, desk.document()["changed"])
    assert run.results.tables()["splits"] == desk.document()["seeds"][0]["splits"]
    assert set(session.controls()) == set(desk.document()["controls"])


def test_a_row_of_smaller_views_is_evaluated_with_them(tmp_path):
    spec = RunSpec.of("lcrl", SETTINGS, image_size=(16, 12))
    folder = run(spec, tiny_session(tmp_path / "runs")).folder.path
    file = tmp_path / "leaderboard" / "submissions" / "tiny-small.json"
    submission = collect((folder,), tiny_benchmark(), Statement(draft=True), out=file)
    assert submission.image_size == (16, 12)
    write_json(file, submission.model_dump(mode="json"))
    claim = Claim(read_submission(file), file, resolve_method("lcrl"))
    assert verify(claim, tiny_session(tmp_path / "again")).verdict == "verified"


def test_a_score_raised_by_two_points_is_disputed_with_the_difference(spoilt):
    document = spoilt.document()
    raise_by(document, 2)
    spoilt.rewrite(document)
    found = spoilt.verify()
    assert found.verdict == "disputed"
    apart = {each.where: each.submitted - each.found for each in found.differences}
    assert apart["figures.train.total.mean"] == pytest.approx(2)
    assert {f"seed {seed}.splits.train.total" for seed in range(3)} <= set(apart)


def test_a_raised_control_is_disputed(spoilt):
    document = spoilt.document()
    document["controls"]["lexical"]["train"]["total"] -= 2
    spoilt.rewrite(document)
    assert [each.where for each in spoilt.verify().differences] == ["controls.lexical.train.total"]


def test_a_swapped_checkpoint_is_disputed_and_never_loaded(spoilt, monkeypatch):
    def load(folder):
        raise AssertionError("a checkpoint that was not submitted was loaded")

    monkeypatch.setattr(NetworkReward, "load", load)
    models = [spoilt.home / f"leaderboard/checkpoints/tiny-lcrl/seed{k}/model" for k in (0, 1)]
    shutil.rmtree(models[0])
    shutil.copytree(models[1], models[0])
    found = spoilt.verify()
    assert (found.verdict, found.evaluated) == ("disputed", False)
    assert [each.where for each in found.differences] == ["seed 0.files.reward.safetensors"]


def test_a_file_more_than_submitted_is_disputed(spoilt):
    folder = spoilt.home / "leaderboard/checkpoints/tiny-lcrl/seed0/model"
    (folder / "extra.py").write_text("print()")
    assert spoilt.verify().verdict == "disputed"


def test_a_link_in_a_checkpoint_is_refused(spoilt):
    folder = spoilt.home / "leaderboard/checkpoints/tiny-lcrl/seed0/model"
    (folder / "config.json").unlink()
    (folder / "config.json").symlink_to("/etc/hostname")
    with pytest.raises(InvalidFileError, match="a symbolic link"):
        spoilt.verify()


def test_a_row_of_another_benchmark_is_refused(spoilt):
    document = spoilt.document()
    document["fingerprint"] = "0" * 64
    spoilt.rewrite(document)
    with pytest.raises(InvalidFileError, match="made on tiny 000000000000, not on tiny"):
        spoilt.verify()


def test_a_missing_checkpoint_is_named_with_the_ways_to_have_it(spoilt):
    shutil.rmtree(spoilt.home / "leaderboard" / "checkpoints")
    with pytest.raises(InvalidFileError, match=r"no checkpoint there.*--retrain"):
        spoilt.verify()
    assert spoilt.verify(runs=spoilt.runs).verdict == "verified"
    assert spoilt.verify(runs=spoilt.home / "runs").verdict == "verified"


def test_training_again_on_the_same_machine_gives_the_same_bits(spoilt):
    shutil.rmtree(spoilt.home / "leaderboard" / "checkpoints")
    found = spoilt.verify(retrain=True)
    assert (found.verdict, found.trained) == ("verified", True)


def test_training_to_other_bits_reproduces_a_row_within_its_intervals(spoilt):
    document = spoilt.document()
    rename_files(document)
    spoilt.rewrite(document)
    assert spoilt.verify(retrain=True).verdict == "reproduced"
    figure = document["figures"]["train"]["total"]
    raise_by(document, 2)
    figure["low"] = figure["mean"] - 1
    spoilt.rewrite(document)
    found = spoilt.verify(retrain=True)
    assert found.verdict == "disputed"
    assert [each.where for each in found.differences] == ["figures.train.total"]


def test_training_again_takes_the_rows_settings_not_the_defaults_of_today(spoilt):
    document = spoilt.document()
    assert document["settings"]["learning_rate"] != 0.5
    document["settings"]["learning_rate"] = 0.5
    spoilt.rewrite(document)
    spoilt.verify(retrain=True)
    (config,) = spoilt.again.glob("tiny/*/seed0/config.json")
    assert json.loads(config.read_text())["resolved"] == document["settings"]
    document["settings"]["of-another-version"] = 1
    spoilt.rewrite(document)
    with pytest.raises(InvalidFileError, match=r"other settings here: of-another-version"):
        spoilt.verify(retrain=True)


def test_a_method_handed_true_rewards_must_say_so(spoilt):
    document = spoilt.document()
    document["oracle"] = True
    spoilt.rewrite(document)
    assert [each.where for each in spoilt.verify().differences] == ["oracle"]


def test_the_code_of_an_unknown_method_is_not_run_until_it_is_named(spoilt):
    document = spoilt.document()
    document.update(method="theirs", registered=False, code="https://example.org/theirs.py")
    spoilt.rewrite(document)
    submission = read_submission(spoilt.file)
    with pytest.raises(UsageError, match=r"read it first, then name it: --method"):
        trusted_method(submission, None, spoilt.file)
    assert trusted_method(submission, "lcrl", spoilt.file) is resolve_method("lcrl")


def test_a_registered_name_is_not_believed(spoilt):
    document = spoilt.document()
    document.update(method="theirs", registered=True)
    spoilt.rewrite(document)
    with pytest.raises(UsageError, match="not registered here"):
        spoilt.verify()


def test_a_verification_is_of_the_benchmark_that_is_given(desk, tmp_path):
    submission = read_submission(desk.file)
    claim = Claim(submission, desk.file, trusted_method(submission, None, desk.file))
    other = replace(tiny_benchmark(), name="other")
    with pytest.raises(InvalidFileError, match="made on tiny"):
        verify(claim, Session(other, Workplace(tmp_path)))


def test_only_what_is_beyond_the_tolerance_differs():
    near, far = 50 + TOLERANCE / 2, 50 + 2 * TOLERANCE
    assert list(compare({"a": 50.0}, {"a": near})) == []
    (difference,) = compare({"a": {"b": 50.0}}, {"a": {"b": far}})
    assert (difference.where, difference.submitted, difference.found) == ("a.b", 50.0, far)
    for other in (None, float("nan"), "50"):
        assert len(list(compare({"a": 50.0}, {"a": other}))) == 1
    assert len(list(compare({"a": 1}, {"b": 1}))) == 2
