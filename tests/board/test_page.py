"""The page: what it shows of a collection, and what no submission can do to it."""

from __future__ import annotations

import base64
import copy
import hashlib
import json
import math
import re
from collections import Counter
from dataclasses import asdict, replace
from html.parser import HTMLParser
from importlib import resources

import pytest
from board_samples import HOSTILE, benchmark_of
from jinja2 import UndefinedError
from markupsafe import escape

from lcrl_bench.board import entries
from lcrl_bench.board.details import Media, Picture
from lcrl_bench.board.entries import Collection, Entry, read_collection
from lcrl_bench.board.page import page
from lcrl_bench.board.table_rows import COLUMN_TITLES, table_rows
from lcrl_bench.storage import write_json


def shown(collection: Collection) -> str:
    stems = [entry.stem for board in collection.boards for entry in board.entries]
    return page(collection, dict.fromkeys(stems, Media()))


class Elements(HTMLParser):
    """Every element with its attributes, and the content of scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.content: list[tuple[str, str]] = []
        self._open = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        self._open = tag

    def handle_data(self, data):
        if self._open in ("script", "style") and data.strip():
            self.content.append((self._open, data))

    def handle_endtag(self, tag):
        self._open = ""


def with_success(spoilt, own: float, **others: float) -> Entry:
    """The entry of the desk's row with another success in new houses, under some commands."""
    (entry,) = spoilt.collection().boards[0].entries
    document = entry.submission.model_dump(mode="json")
    document["figures"]["test-house"]["total"].update(mean=own, low=0, high=100)
    for control, success in {"blank": 0.0, "shuffled": 0.0, "wrong_target": 0.0, **others}.items():
        document["language"][control.replace("_", "-")]["test-house"]["total"] = success
    row = type(entry.submission).model_validate(document)
    return replace(entry, submission=row, mark="verified")


@pytest.mark.parametrize("control", ["blank", "shuffled", "wrong_target"])
def test_a_row_that_succeeds_whatever_is_said_is_marked_and_bears_no_rank(spoilt, control):
    assert with_success(spoilt, 60.0, **{control: 30.0}).rankable
    deaf = with_success(spoilt, 60.0, **{control: 55.0})
    assert deaf.ignores_language
    assert not deaf.rankable
    board = replace(spoilt.collection().boards[0], entries=(deaf,))
    (line, *_) = table_rows(board)
    assert "ignores language" in line.tags


def test_a_row_that_knows_other_words_too_is_not_marked(spoilt):
    assert with_success(spoilt, 60.0, paraphrase=60.0).rankable


def test_only_a_row_that_was_run_again_bears_a_rank(spoilt, monkeypatch):
    # A row of one pass has not learned to listen: here the question is who ran it.
    monkeypatch.setattr(entries, "MAX_SHARE_KEPT", math.inf)
    (entry,) = spoilt.collection().boards[0].entries
    assert (entry.mark, entry.rankable) == ("unverified", False)
    spoilt.verify_and_keep()
    (entry,) = spoilt.collection().boards[0].entries
    assert (entry.mark, entry.rankable) == ("verified", True)
    for spoil in ({"draft": True}, {"oracle": True}, {"expert": True}):
        row = entry.submission.model_copy(update=spoil)
        assert not replace(entry, submission=row).rankable
    document = spoilt.document()
    document["title"] = "Another"
    spoilt.rewrite(document)
    (entry,) = spoilt.collection().boards[0].entries
    assert (entry.mark, entry.rankable) == ("unverified", False)
    assert "changed after it was verified" in entry.note


def test_a_disputed_row_says_by_how_much(spoilt):
    document = spoilt.document()
    document["controls"]["lexical"]["train"]["total"] -= 2
    spoilt.rewrite(document)
    spoilt.verify_and_keep()
    (entry,) = spoilt.collection().boards[0].entries
    assert (entry.mark, entry.rankable) == ("disputed", False)
    assert "1 figures differ" in entry.note
    assert "controls.lexical.train.total" in shown(spoilt.collection())


def test_what_is_refused_is_shown_with_the_reason_and_without_the_path(spoilt):
    document = copy.deepcopy(spoilt.document())
    document["fingerprint"] = "0" * 64
    write_json(spoilt.file.with_name("older.json"), document)
    document["benchmark"] = "nowhere"
    write_json(spoilt.file.with_name("elsewhere.json"), document)
    spoilt.file.with_name("Bad name.json").write_bytes(spoilt.file.read_bytes())
    spoilt.file.with_name("torn.json").write_text("{")
    collection = spoilt.collection()
    assert [entry.stem for entry in collection.boards[0].entries] == ["tiny-lcrl"]
    assert len(collection.refused) == 4
    text = shown(collection)
    for name, reason in (
        ("older.json", "made on tiny 000000000000"),
        ("elsewhere.json", "Unknown benchmark"),
        ("Bad name.json", "is not valid"),
        ("torn.json", "not valid JSON"),
    ):
        (line,) = (line for line in collection.refused if name in line)
        assert reason in line
        assert escape(line) in text
    assert str(spoilt.home) not in text


def test_controls_and_the_papers_rows_are_marked_and_never_ranked(desk):
    (board,) = desk.collection().boards
    lines = {line.id: line for line in table_rows(board)}
    controls = [line for line in lines.values() if line.type == "control"]
    assert {line.title for line in controls} == {"random", "optimal", "constant", "lexical"}
    papers = [line for line in lines.values() if line.type == "paper"]
    assert all("paper" in line.tags for line in papers)
    assert all("control" in line.tags for line in controls)
    assert not any(line.rankable for line in (*controls, *papers))
    (ours,) = (line for line in papers if line.title == "LC-RL (ours)")
    assert ours.figures["total"]["test-house"].mean == 36.4
    assert ours.figures["total"]["gap"].mean == pytest.approx(66.9 - 36.4)
    (optimal,) = (line for line in controls if line.title == "optimal")
    assert optimal.figures["total"]["train"].mean == 100
    for line in lines.values():
        assert all(list(row) == list(COLUMN_TITLES) for row in line.figures.values())


def test_every_figure_of_a_row_is_the_submissions(desk):
    row = desk.document()
    (board,) = desk.collection().boards
    line = table_rows(board)[0]
    for kind in ("pick", "nav", "total"):
        shown_row = line.figures[kind]
        for split in ("train", "test-task", "test-house"):
            figure = row["figures"][split][kind]
            assert asdict(shown_row[split]) == figure
        blank = row["language"]["blank"]["test-house"][kind]
        assert shown_row["blank"].mean == blank


def test_html_in_a_submission_is_shown_as_text(spoilt):
    plain = Elements(shown(spoilt.collection()))
    document = spoilt.document()
    for key in ("title", "summary", "author"):
        document[key] = HOSTILE[:80]
    document["code"] = "javascript:alert(1)"
    document["weights"] = 'https://example.org/"onclick="alert(1)'
    document["changed"] = {HOSTILE: HOSTILE}
    document["settings"] = {HOSTILE: HOSTILE}
    document["seeds"][0]["machine"]["device"] = HOSTILE
    spoilt.rewrite(document)
    text = shown(spoilt.collection())
    hostile = Elements(text)
    assert escape(HOSTILE) in text
    # Two lines more, on code and weights, one of them a link; and nothing that runs.
    assert added(plain, hostile) == {"dt": 2, "dd": 2, "a": 1}
    check_nothing_runs(hostile)


def test_html_in_reasons_notes_and_pictures_is_shown_as_text(spoilt):
    collection = spoilt.collection()
    (board,) = collection.boards
    (entry,) = board.entries
    picture = Media("a", "b", (Picture("c", "d"),))
    plain = Elements(page(replace(collection, refused=("why",)), {entry.stem: picture}))
    entries_ = (replace(entry, note=HOSTILE, mark="disputed"),)
    boards = (replace(board, benchmark=HOSTILE, fingerprint=HOSTILE, entries=entries_),)
    media = Media(HOSTILE, HOSTILE, (Picture(HOSTILE, HOSTILE),))
    hostile = Elements(page(Collection(boards, (HOSTILE,)), {entry.stem: media}))
    assert added(plain, hostile) == {}
    check_nothing_runs(hostile)


def test_what_looks_like_a_template_in_a_submission_is_shown_as_it_is(spoilt):
    text = "{{ 7 * 7 }} {% raw %} {# gone #}"
    spoilt.rewrite({**spoilt.document(), "title": text})
    assert shown(spoilt.collection()).count(text) > 1


def test_only_the_pages_own_sheet_and_script_are_not_escaped():
    templates = resources.files("lcrl_bench.leaderboard").joinpath("templates")
    texts = [each.read_text("utf-8") for each in templates.iterdir()]
    assert len(texts) > 1
    words = re.findall(r"(\w+) *\| *safe\b", "".join(texts))
    assert sorted(words) == ["script", "style"]
    assert not re.search(r"autoescape|Markup", "".join(texts))


def test_what_a_template_is_not_given_is_an_error(desk):
    with pytest.raises(UndefinedError):
        page(desk.collection(), {})


def test_data_in_the_page_can_not_end_its_element(spoilt):
    spoilt.rewrite({**spoilt.document(), "title": HOSTILE[:80]})
    elements = Elements(shown(spoilt.collection()))
    (data,) = (text for tag, text in elements.content if tag == "script" and text[0] == "{")
    assert not {"<", ">", "&"} & set(data)
    assert json.loads(data)["tiny"][0]["title"] == HOSTILE[:80].lower()


def added(plain: Elements, other: Elements) -> dict[str, int]:
    """How many elements of each kind a page has more than another."""
    counts = Counter(tag for tag, _ in other.found)
    counts.subtract(tag for tag, _ in plain.found)
    return {tag: count for tag, count in counts.items() if count}


def check_nothing_runs(elements: Elements) -> None:
    names = {name for _, attributes in elements.found for name in attributes}
    assert not {name for name in names if name.startswith("on")} | {"style"} & names
    links = [each.get("href") or "" for tag, each in elements.found if tag == "a"]
    assert not any(link.startswith("javascript:") for link in links)


def test_the_policy_allows_the_pages_own_sheet_and_program_alone(desk):
    elements = Elements(shown(desk.collection()))
    metas = [each for tag, each in elements.found if tag == "meta"]
    (policy,) = (each["content"] or "" for each in metas if "http-equiv" in each)
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == rules["connect-src"] == "'none'"
    for tag, rule in (("script", "script-src"), ("style", "style-src")):
        allowed = re.findall(r"'sha256-([^']+)'", rules[rule])
        texts = [text for name, text in elements.content if name == tag]
        hashes = [
            base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in texts
        ]
        assert set(allowed) <= set(hashes)
        assert "unsafe" not in rules[rule]
    scripts = [each for tag, each in elements.found if tag == "script"]
    assert [each for each in scripts if "src" in each] == []


def test_an_empty_folder_makes_a_page_that_says_so(tmp_path):
    collection = read_collection(tmp_path, benchmark_of)
    assert collection == Collection((), ())
    assert "No submission yet." in shown(collection)
