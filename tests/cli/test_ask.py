"""`lcrl-bench ask`: any sentence, in a benchmark's house and in one's own."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark
from house_samples import two_rooms
from run_samples import write_run

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import write_house


@pytest.fixture(scope="module")
def flags(tmp_path_factory) -> list[str]:
    folder = tmp_path_factory.mktemp("ask")
    write_benchmark(folder / "tiny", tiny_benchmark())
    run = write_run(folder / "run")
    return ["--run", str(run), "--benchmark", str(folder / "tiny"), "--renderer", "rays"]


def sample_task(kind: Kind) -> Task:
    return tiny_benchmark().select(split=Split.TEST_HOUSE, kind=kind)[0]


@pytest.fixture
def ask(flags, tmp_path, capsys):
    """Asks, and returns the JSON answer and what was said."""

    def answer(sentence: str, *more: str) -> tuple[dict, str]:
        words = ["ask", sentence, *flags, "--out", str(tmp_path / "out"), "--json", *more]
        code = main(words)
        shown = capsys.readouterr()
        assert code == ExitCode.DONE, shown.err
        return json.loads(shown.out), shown.err

    return answer


def test_a_command_of_the_benchmark_is_that_very_task(ask):
    task = sample_task(Kind.PICK)
    answer, _ = ask(task.command, "--house", task.house)
    assert answer["kind"] == "pick"
    assert answer["start"]["tile"] == task.start_tile
    assert answer["optimal_length"] == task.proof.optimal_length
    assert answer["success"] in (True, False)
    assert answer["success"] == (answer["reached_at"] is not None)
    assert answer["unknown_words"] == {}
    assert {"tile", "room", "when", "score"} == set(answer["best"][0])
    scores = [place["score"] for place in answer["best"]]
    assert scores == sorted(scores, reverse=True)
    assert Path(answer["picture"]).read_bytes().startswith(b"\x89PNG")
    assert Path(answer["recording"]).read_bytes().startswith(b"RRF")


def test_the_steps_of_the_plan_follow_each_other_from_the_start(ask):
    answer, _ = ask(sample_task(Kind.NAV).command, "--house", sample_task(Kind.NAV).house)
    numbers = [k for leg in answer["plan"] for k in range(leg["first"], leg["last"] + 1)]
    assert numbers == list(range(1, len(numbers) + 1))
    assert len(numbers) == sum(len(leg["actions"]) for leg in answer["plan"])
    assert answer["rooms"][0] == answer["start"]["room"]


def test_other_words_are_named_and_the_truth_is_left_open(ask):
    answer, said = ask("wander to the bedroon, please $x$ été", "--start", "0")
    assert answer["success"] is None
    assert answer["optimal_length"] is None
    assert answer["kind"] == "nav"
    assert answer["unknown_words"]["wander"] is None
    assert "unknown word 'wander'." in said
    assert answer["start"]["tile"] == 0
    assert any("neither" in note for note in answer["notes"])


def test_a_house_of_ones_own_is_asked_about_like_any_other(ask, tmp_path):
    file = tmp_path / "own.json"
    write_house(file, two_rooms())
    answer, _ = ask("move the cup to the bed", "--house", str(file))
    assert answer["house"] == two_rooms().id
    assert answer["kind"] == "pick"
    assert answer["success"] in (True, False)
    assert 0 < answer["optimal_length"] <= answer["horizon"]
    answer, _ = ask("move the cup to the bathtub", "--house", str(file))
    assert answer["success"] is None
    assert any("no bathtub" in note for note in answer["notes"])


def test_a_policy_is_shown_by_where_it_is_and_a_person_reads_lines(flags, tmp_path, capsys):
    run = write_run(tmp_path / "cloning", "cloning")
    task = sample_task(Kind.NAV)
    words = ["--run", str(run), *flags[2:], "--house", task.house, "--out", str(tmp_path / "out")]
    assert main(["ask", task.command, *words]) == ExitCode.DONE
    shown = capsys.readouterr()
    assert "most visited places (visits)" in shown.out
    assert f'"{task.command}" in {task.house} of tiny' in shown.out
    assert "the shortest path takes" in shown.out
    assert "ask.rrd" in shown.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("go to the bed", "--house", "nowhere"), "neither a house of tiny nor a file"),
        (("go to the bed", "--start", "99999"), "--start 99999: no such tile"),
        (("",), "A sentence needs 1 to 200 characters"),
    ],
)
def test_mistakes_are_named(flags, words, message, capsys):
    assert main(["ask", *words, *flags]) == ExitCode.USAGE
    assert message in capsys.readouterr().err


def test_a_folder_without_a_run_is_refused_with_the_next_step(tmp_path, capsys):
    assert main(["ask", "go to the bed", "--run", str(tmp_path)]) == ExitCode.EMPTY
    assert "Train one: lcrl-bench run" in capsys.readouterr().err


def test_a_run_of_ones_own_benchmark_asks_for_its_folder(flags, capsys):
    assert main(["ask", "go to the bed", "--run", flags[1]]) == ExitCode.USAGE
    assert "learned on a benchmark 'tiny'" in capsys.readouterr().err


def test_the_newest_run_is_asked_if_none_is_named(flags, tmp_path, monkeypatch, capsys):
    run = Path(flags[1])
    place = tmp_path / "runs" / "tiny" / "lcrl" / "seed0"
    shutil.copytree(run, place)
    (place / "DONE").touch()
    monkeypatch.chdir(tmp_path)
    task = sample_task(Kind.NAV)
    assert main(["ask", task.command, *flags[2:], "--house", task.house]) == ExitCode.DONE
    shown = capsys.readouterr()
    assert f"run: {place.relative_to(tmp_path)}" in shown.err
    assert (tmp_path / "ask" / "ask.png").exists()


def test_a_sentence_the_model_knows_nothing_of_is_said_to_say_nothing(ask):
    answer, said = ask("去卧室 🙂", "--house", sample_task(Kind.NAV).house)
    assert answer["best"] == []
    assert "the map is noise" in said
    assert answer["unknown_words"] == {"去卧室": None}


def test_what_a_learned_reward_likes_is_named_a_tile_once(ask):
    task = sample_task(Kind.PICK)
    answer, _ = ask(task.command, "--house", task.house)
    tiles = [place["tile"] for place in answer["best"]]
    assert len(tiles) == 3
    assert sorted(set(tiles)) == sorted(tiles)
