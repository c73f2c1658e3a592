"""The page in a browser: it sorts, filters, opens rows, plays a recording, and requests nothing."""

from __future__ import annotations

import copy
import io
import math
import time
from pathlib import Path

import pytest
from board_samples import HOSTILE, Desk, benchmark_of
from browser import PATIENCE, Page, chromium, find_chromium
from PIL import Image

from lcrl_bench.board import entries
from lcrl_bench.board.exhibits import record_exhibits
from lcrl_bench.board.player import web_viewer
from lcrl_bench.board.site import write_site
from lcrl_bench.storage import write_json

PROGRAM = find_chromium()
TITLE = HOSTILE[:80]
ROWS = "[...document.querySelectorAll('.results > tbody')].filter(b => b.offsetParent)"
"""The rows that are seen, from above."""
pytestmark = pytest.mark.skipif(PROGRAM is None, reason="no Chromium: see scripts/browser.sh")


def raised(desk: Desk, name: str, title: str, points: float) -> None:
    """A further row, better in new houses than the honest one."""
    document = copy.deepcopy(desk.document())
    document["title"] = title
    figures = document["figures"]["test-house"]
    for column, figure in figures.items():
        figure["mean"] = min(figure["mean"] + points, 100)
        figure["high"] = max(figure["high"], figure["mean"])
        for seed in document["seeds"]:
            seed["splits"]["test-house"][column] = figure["mean"]
    write_json(desk.file.with_name(f"{name}.json"), document)


def on_another_benchmark(desk: Desk) -> None:
    twin = benchmark_of("twin")
    document = {**desk.document(), "benchmark": twin.name, "fingerprint": twin.fingerprint}
    write_json(desk.file.with_name("twin-lcrl.json"), {**document, "title": "On the twin"})


@pytest.fixture(scope="module")
def site(desk, tmp_path_factory) -> Path:
    """A verified row with its recording, a better one that nobody ran again, and a hostile one."""
    own = desk.copy(tmp_path_factory.mktemp("site") / "desk")
    recordings = own.home / "leaderboard" / "recordings"
    digest = own.collection().boards[0].entries[0].digest

    def show(run, session):
        record_exhibits(run, session, recordings / own.file.stem, submission=digest)

    own.verify_and_keep(show=show)
    raised(own, "better", "Better", 20)
    raised(own, "hostile", TITLE, 10)
    on_another_benchmark(own)
    out = own.home / "leaderboard" / "site"
    with pytest.MonkeyPatch.context() as patch:
        # A row of one pass has not learned to listen, which would cost it its rank.
        patch.setattr(entries, "MAX_SHARE_KEPT", math.inf)
        write_site(own.collection(), out, recordings=recordings, viewer=web_viewer())
    return out


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    assert PROGRAM is not None
    with chromium(PROGRAM, tmp_path_factory.mktemp("profile")) as page:
        yield page


@pytest.fixture
def page(browser, site) -> Page:
    """The page, opened from its file at 1280 pixels; in the end nothing was said or asked."""
    browser.resize(1280, 900)
    browser.open(site / "index.html")
    browser.complaints.clear()
    browser.requests.clear()
    yield browser
    assert [each for each in browser.complaints if each.startswith("error")] == []
    assert [each for each in browser.requests if not each.startswith("file:")] == []


def titles(page: Page) -> list[str]:
    named = "(b.querySelector('.open') || b.querySelector('.name')).firstChild.textContent.trim()"
    return page.run(f"{ROWS}.map(b => {named})")


def enter(page: Page, field: str, value: str) -> None:
    found = f"document.getElementById({field!r})"
    page.run(f"{found}.value = {value!r}")
    page.run(f"{found}.dispatchEvent(new Event('input', {{ bubbles: true }}))")


def click(page: Page, selector: str) -> None:
    page.run(f"document.querySelector({selector!r}).click()")


def test_it_begins_with_the_best_in_new_houses(page):
    seen = titles(page)
    assert seen[0] == "optimal"
    assert seen.index("Better") < seen.index(TITLE) < seen.index("LC-RL")
    assert "LC-RL (ours)" not in seen


def test_only_the_row_that_was_run_again_has_a_rank(page):
    ranks = page.run(
        "Object.fromEntries([...document.querySelectorAll('.results > tbody')].map("
        "b => [b.id, b.querySelector('.rank').textContent]))"
    )
    assert {name: rank for name, rank in ranks.items() if rank} == {"row-tiny-tiny-lcrl": "1"}


def test_a_click_on_a_heading_sorts_and_another_turns_it_round(page):
    click(page, "th[data-column=title] button")
    seen = titles(page)
    assert seen == sorted(seen, key=str.lower)
    click(page, "th[data-column=title] button")
    assert titles(page) == seen[::-1]
    order = page.run("document.querySelector('th[data-column=title]').getAttribute('aria-sort')")
    assert order == "descending"
    click(page, "th[data-column=train] button")
    mean = "Number(b.querySelectorAll('td')[2].querySelector('.total b').textContent)"
    means = page.run(f"{ROWS}.map(b => {mean})")
    assert means == sorted(means, reverse=True)


def test_it_sorts_by_the_kind_of_task_that_is_shown(page):
    click(page, "input[name=kind][value=nav]")
    kinds = "[...b.querySelector('td').children].filter(s => s.offsetParent).map(s => s.className)"
    shown = page.run(f"{ROWS}.map(b => {kinds})")
    assert shown
    assert all(each == ["nav"] for each in shown)


def test_it_filters_by_words_and_by_sort(page):
    enter(page, "text", "newcomer better")
    assert titles(page) == ["Better"]
    assert page.run("document.getElementById('count').textContent").startswith("1 of ")
    enter(page, "text", "")
    enter(page, "show", "ranked")
    assert titles(page) == ["LC-RL"]
    enter(page, "show", "all")
    assert {"LC-RL (ours)", "random", "LC-RL"} <= set(titles(page))


def test_benchmarks_are_chosen_from_and_never_mixed(page):
    assert "On the twin" not in titles(page)
    click(page, "input[name=benchmark][value=twin]")
    seen = titles(page)
    assert "On the twin" in seen
    assert "Better" not in seen
    page.run("location.hash = 'row-tiny-better'")
    page.wait("document.getElementById('row-tiny-better-details').offsetParent !== null")
    assert "On the twin" not in titles(page)


def test_html_in_a_title_is_text(page):
    assert TITLE in titles(page)
    assert page.run("document.querySelectorAll('img[src=x]').length") == 0


def test_a_row_opens_and_closes_by_keyboard_alone(page):
    for _ in range(60):
        page.press("Tab")
        if page.run("document.activeElement.matches('#row-tiny-tiny-lcrl .open')"):
            break
    else:
        pytest.fail("the row is not reached by Tab")
    details = "document.getElementById('row-tiny-tiny-lcrl-details').offsetParent !== null"
    assert not page.run(details)
    page.press("Enter")
    assert page.run(details)
    text = page.run("document.getElementById('row-tiny-tiny-lcrl-details').innerText")
    for part in (
        "Play the recording",
        "How PICK fails",
        "Training loss",
        "95 % interval",
        "per seed",
    ):
        assert part in text
    page.wait("[...document.querySelectorAll('#row-tiny-tiny-lcrl img')].every(i => i.complete)")
    widths = page.run(
        "[...document.querySelectorAll('#row-tiny-tiny-lcrl img')].map(i => i.naturalWidth)"
    )
    assert len(widths) >= 2
    assert widths[0] > 100
    page.press(" ")
    assert not page.run(details)


def test_an_address_opens_its_row(page, site):
    page.run("location.hash = 'row-tiny-better'")
    page.wait("document.getElementById('row-tiny-better-details').offsetParent !== null")


@pytest.mark.parametrize("dark", [False, True])
def test_it_is_usable_at_380_pixels(page, dark):
    page.resize(380, 800, dark=dark)
    click(page, "#row-tiny-tiny-lcrl .open")
    assert page.run("document.documentElement.scrollWidth") <= 380
    wide = page.run(
        "[...document.querySelectorAll('#row-tiny-tiny-lcrl-details section')].map("
        "s => s.getBoundingClientRect().right)"
    )
    assert max(wide) <= 380
    small = page.run(
        "[...document.querySelectorAll('button, select, input[type=search]')].filter(b => "
        "b.offsetParent && b.getBoundingClientRect().height < 24).length"
    )
    assert small == 0


def test_a_command_is_copied_or_marked(page):
    click(page, "#row-tiny-tiny-lcrl .open")
    click(page, "#row-tiny-tiny-lcrl .copy")
    page.wait(
        "['Copied', 'Selected'].includes("
        "document.querySelector('#row-tiny-tiny-lcrl .copy').textContent)"
    )


def test_a_recording_plays_in_the_page_and_closes(page):
    page.run("void (window.told = new Promise(d => addEventListener('message', e => d(e.data))))")
    click(page, "#row-tiny-tiny-lcrl .open")
    click(page, "#row-tiny-tiny-lcrl .play")
    assert page.run("told") == "playing"
    assert any(each.endswith("rows/tiny-lcrl/recording.js") for each in page.requests)
    assert page.run("document.querySelector('#player iframe').title") == "Recording of LC-RL"
    # The viewer draws: more is seen than its empty ground.
    until = time.monotonic() + PATIENCE
    while len(colours(page)) <= 200:
        assert time.monotonic() < until, "the viewer draws nothing"
        time.sleep(0.2)
    click(page, "#close")
    assert page.run("document.querySelector('#player iframe') === null")
    assert page.run("document.activeElement.matches('#row-tiny-tiny-lcrl .play')")
    # The next plays too, however soon.
    page.run("void (window.told = new Promise(d => addEventListener('message', e => d(e.data))))")
    click(page, "#row-tiny-tiny-lcrl .play")
    assert page.run("told") == "playing"
    click(page, "#close")


def colours(page: Page) -> set[object]:
    """The colours of the middle of what is seen."""
    picture = Image.open(io.BytesIO(page.picture())).convert("RGB").crop((300, 150, 980, 750))
    return {colour for _, colour in picture.getcolors(1 << 20) or ()}


def test_the_page_alone_is_light_and_loads_no_viewer(page, site):
    page.open(site / "index.html")
    assert not any("player" in each for each in page.requests)
    assert (site / "index.html").stat().st_size < 400_000
    assert (site / "player" / "program.js").stat().st_size < 25_000_000


def test_the_player_plays_nothing_but_a_rows_recording(page):
    for name in ("../../../etc/passwd.js", "a/b/c.js", "https://example.org/x.js", "a/..js", ""):
        page.run(f"window.address = 'player/player.html#' + encodeURIComponent({name!r})")
        told = page.run(
            "new Promise(done => { const frame = document.createElement('iframe');"
            "addEventListener('message', e => { frame.remove(); done(e.data); }, { once: true });"
            "frame.src = address; document.body.append(frame); })"
        )
        assert told == "failed"
    assert [each for each in page.requests if "/player/" not in each] == []
