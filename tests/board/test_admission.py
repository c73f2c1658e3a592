"""What is refused before anything is run, each with its reason."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import pytest

from lcrl_bench.board.admission import MAX_BYTES, read_submission
from lcrl_bench.board.document import Submission
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.language import Control
from lcrl_bench.storage import write_json

ROOT = Path(__file__).parents[2]


def without_seeds(document):
    del document["seeds"]


def with_no_seed(document):
    document["seeds"] = []


def without_count(document):
    del document["figures"]["test-house"]["total"]["n"]


def without_interval(document):
    del document["figures"]["test-house"]["total"]["low"]


def without_controls(document):
    del document["controls"]


def without_a_control(document):
    del document["controls"]["random"]


def without_a_language_control(document):
    del document["language"][Control.BLANK.value]


def without_a_split(document):
    del document["figures"]["test-task"]


def with_two_seeds(document):
    document["seeds"].pop()


def with_a_seed_twice(document):
    document["seeds"][1]["seed"] = document["seeds"][0]["seed"]


def with_a_copied_checkpoint(document):
    document["seeds"][1]["files"] = document["seeds"][0]["files"]


def with_two_points_more(document):
    figure = document["figures"]["train"]["total"]
    figure["mean"] += 2


def with_an_interval_elsewhere(document):
    figure = document["figures"]["train"]["total"]
    figure["low"], figure["high"] = figure["mean"] + 1, figure["mean"] + 2


def with_more_tasks(document):
    document["figures"]["train"]["total"]["n"] += 1


def with_no_figure(document):
    document["figures"]["train"]["total"] = None


def with_infinite_success(document):
    document["figures"]["train"]["total"]["high"] = 1e999


def with_over_all(document):
    document["figures"]["train"]["total"]["high"] = 101.0


def with_a_file_outside(document):
    document["seeds"][0]["files"][0]["path"] = "../../config.json"


def with_an_absolute_folder(document):
    document["checkpoints"] = "/etc"


def with_a_field_of_its_own(document):
    document["rank"] = 1


def with_a_line_break(document):
    document["title"] = "LC-RL\nbest"


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (without_seeds, "Field required at seeds"),
        (with_no_seed, "at least 1 item"),
        (without_count, "Field required at figures.test-house.total.n"),
        (without_interval, "Field required at figures.test-house.total.low"),
        (without_controls, "Field required at controls"),
        (without_a_control, "at least 4 items"),
        (without_a_language_control, "at least 4 items"),
        (without_a_split, "at least 3 items"),
        (with_two_seeds, "2 of 3 seeds at seeds"),
        (with_a_seed_twice, "a seed stands there twice"),
        (with_a_copied_checkpoint, "seeds 0 and 1 have the same checkpoint"),
        (with_two_points_more, "is not the mean of its seeds"),
        (with_an_interval_elsewhere, "is outside its interval"),
        (with_more_tasks, "its seeds have 42 tasks"),
        (with_no_figure, "tasks and no figure"),
        (with_over_all, "less than or equal to 100"),
        (with_a_file_outside, "a path inside the checkpoint's folder is wanted"),
        (with_an_absolute_folder, "should match pattern"),
        (with_a_field_of_its_own, "Extra inputs are not permitted"),
        (with_a_line_break, "should match pattern"),
    ],
    ids=lambda value: value.__name__ if callable(value) else "",
)
def test_a_spoilt_submission_is_refused_with_the_reason(spoil, reason, desk, tmp_path):
    document = copy.deepcopy(desk.document())
    spoil(document)
    file = tmp_path / "spoilt.json"
    write_json(file, document)
    with pytest.raises(InvalidFileError, match=r"spoilt\.json: ") as refusal:
        read_submission(file)
    assert reason in str(refusal.value)


def test_no_number_and_no_end_of_text_are_refused(desk, tmp_path):
    file = tmp_path / "spoilt.json"
    document = copy.deepcopy(desk.document())
    with_infinite_success(document)
    file.write_text(json.dumps(document))
    with pytest.raises(InvalidFileError, match="finite"):
        read_submission(file)
    file.write_text(desk.file.read_text() + " " * MAX_BYTES)
    with pytest.raises(InvalidFileError, match="over the limit"):
        read_submission(file)


def test_a_draft_may_have_fewer_seeds(desk, tmp_path):
    document = copy.deepcopy(desk.document())
    document["draft"] = True
    document["seeds"] = document["seeds"][:1]
    for split, columns in document["figures"].items():
        for column, figure in columns.items():
            mean = document["seeds"][0]["splits"][split][column]
            figure.update(mean=mean, low=0.0, high=100.0, n=figure["n"] // 3)
    write_json(tmp_path / "draft.json", document)
    assert read_submission(tmp_path / "draft.json").draft


def test_an_honest_submission_is_admitted_and_comes_back_as_it_was(desk):
    assert read_submission(desk.file).model_dump(mode="json") == desk.document()


def test_the_schema_in_the_tree_is_the_models():
    shown = json.loads((ROOT / "leaderboard" / "schema.json").read_text("utf-8"))
    assert shown == Submission.model_json_schema()
