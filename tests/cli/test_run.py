"""`lcrl-bench run`, end to end on a tiny benchmark: answer, files, repetition, interruption."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from benchmark_samples import tiny_benchmark
from rerun.chunk import RrdReader

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode

SHORT = ("--set", "passes=2", "least_steps=1", "--renderer", "rays")
FOLDER = "lcrl-least_steps-1-passes-2"
TEXT = "TextDocument:text"


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


def run(benchmark: Path, out: Path, *flags: str) -> int:
    base = ("run", "--method", "lcrl", "--benchmark", str(benchmark), "--out", str(out), "--json")
    return main([*base, *SHORT, *flags])


@pytest.fixture(scope="module")
def finished(benchmark, tmp_path_factory):
    """One run by the module form, in a process of its own: (answer, folder)."""
    out = tmp_path_factory.mktemp("runs")
    words = ("--method", "lcrl", "--benchmark", str(benchmark), "--seeds", "0", "--out", str(out))
    command = [sys.executable, "-m", "lcrl_bench.run", *words, "--json", *SHORT]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), out / "tiny" / FOLDER / "seed0"


def test_the_answer_is_the_documented_object(finished, benchmark):
    answer, folder = finished
    wanted = {"benchmark", "fingerprint", "method", "seeds", "splits", "controls", "recording"}
    assert wanted | {"wall_s"} <= set(answer)
    assert answer["fingerprint"] == tiny_benchmark().fingerprint
    assert set(answer["splits"]) == {"train", "test-task", "test-house"}
    for row in answer["splits"].values():
        assert set(row) == {"pick", "nav", "total", "n"}
        assert all(0 <= row[key] <= 100 for key in ("pick", "nav", "total") if row[key] is not None)
    assert sum(row["n"] for row in answer["splits"].values()) == len(tiny_benchmark().tasks)
    assert set(answer["controls"]) == {"random", "optimal", "constant", "lexical"}
    assert answer["controls"]["random"] <= 3
    assert answer["controls"]["optimal"] == 100
    assert answer["controls"]["constant"] == pytest.approx(answer["controls"]["random"])
    assert answer["recording"] == str(folder / "recording.rrd")


def test_the_answer_tells_what_else_is_measured(finished):
    answer, _ = finished
    for split, row in answer["splits"].items():
        columns = {key: value for key, value in row.items() if key != "n"}
        measures, failures = answer["measures"][split], answer["failures"][split]
        assert measures["success"] == columns
        assert set(measures) == {"success", "final", "path_weighted", "regret"}
        assert row["pick"] + sum(failures.values()) == pytest.approx(100, abs=1e-3)
        for column, (low, high) in answer["intervals"][split].items():
            assert low <= row[column] <= high
    assert set(answer["language"]) == {"blank", "shuffled", "wrong-target", "paraphrase"}
    assert answer["language"]["blank"]["train"]["n"] == answer["splits"]["train"]["n"]


def test_the_folder_holds_the_run(finished):
    answer, folder = finished
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["splits"] == answer["splits"]
    assert (folder / "DONE").exists()
    rows = pq.read_table(folder / "episodes.parquet").to_pylist()
    assert len(rows) == len(tiny_benchmark().tasks)
    measured = {"path_weighted", "regret", "failure_held_at_b", "success_wrong_target"}
    assert measured <= set(rows[0])
    train = [row["success"] for row in rows if row["split"] == "train"]
    assert 100 * sum(train) / len(train) == pytest.approx(
        summary["splits"]["train"]["total"], abs=1e-3
    )
    assert (folder / "model" / "config.json").exists()
    assert json.loads((folder / "environment.json").read_text())["device"] == "cpu"
    lines = (folder / "metrics.jsonl").read_text().splitlines()
    steps = [json.loads(line)["step"] for line in lines]
    assert steps == list(range(1, len(steps) + 1))


def test_the_recording_verifies(finished):
    rerun = Path(sys.executable).with_name("rerun")
    done = subprocess.run(
        [rerun, "rrd", "verify", finished[1] / "recording.rrd"], capture_output=True
    )
    assert done.returncode == 0, done.stderr


def test_the_table_does_not_wait_for_the_recordings(benchmark, tmp_path, capsys):
    words = ("run", "--method", "cloning", "--benchmark", str(benchmark), "--out", str(tmp_path))
    assert main([*words, *SHORT, "--no-record"]) == ExitCode.DONE
    table = capsys.readouterr().out
    assert "cloning" in table
    # A folder where the recording should be written makes recording fail.
    folder = tmp_path / "tiny" / FOLDER.replace("lcrl", "cloning") / "seed0"
    (folder / "recording.rrd" / "kept").mkdir(parents=True)
    assert main([*words, *SHORT]) != ExitCode.DONE
    assert capsys.readouterr().out == table


def test_a_policy_is_recorded_too_and_says_that_it_has_no_reward(benchmark, tmp_path, capsys):
    words = ("run", "--method", "cloning", "--benchmark", str(benchmark), "--out", str(tmp_path))
    assert main([*words, *SHORT, "--record", "first", "--json"]) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out)["recording"] is not None
    folder = tmp_path / "tiny" / FOLDER.replace("lcrl", "cloning") / "seed0"
    index = json.loads((folder / "episodes" / "index.json").read_text())
    assert index["selections"] == ["showcase", "first"]
    shown = [row for row in index["episodes"] if "recording" in row["files"]]
    assert len({(row["split"], row["kind"]) for row in shown}) == len(shown) >= 4
    for row in shown:
        recording = folder / "episodes" / row["files"]["recording"]["path"]
        assert recording.stat().st_size == row["files"]["recording"]["bytes"] < 1_500_000
        assert "learned a policy and no reward" in documents(recording)
    assert (folder / "curves.png").exists()


def documents(recording: Path) -> str:
    """The texts of a recording, whose bytes are compressed."""
    batches = [chunk.to_record_batch() for chunk in RrdReader(recording).stream().to_chunks()]
    texts = [batch[TEXT] for batch in batches if TEXT in batch.schema.names]
    return "\n".join(str(text.to_pylist()) for text in texts)


def weights(folder: Path) -> bytes:
    (file,) = (folder / "model").glob("*.safetensors")
    return file.read_bytes()


def timeless(folder: Path) -> dict:
    summary = json.loads((folder / "summary.json").read_text())
    return {key: value for key, value in summary.items() if key != "wall_s"}


def test_the_same_command_gives_the_same_bits_and_another_seed_others(
    finished, benchmark, tmp_path, capsys
):
    assert run(benchmark, tmp_path, "--seeds", "0", "1", "--no-record") == ExitCode.DONE
    again = tmp_path / "tiny" / FOLDER / "seed0"
    assert timeless(again) == timeless(finished[1])
    assert weights(again) == weights(finished[1])
    assert (again / "episodes.parquet").read_bytes() == (
        finished[1] / "episodes.parquet"
    ).read_bytes()
    assert weights(again) != weights(tmp_path / "tiny" / FOLDER / "seed1")
    assert json.loads(capsys.readouterr().out)["recording"] is None
    words = ("run", "--method", "lcrl", "--benchmark", str(benchmark), "--out", str(tmp_path))
    assert main([*words, *SHORT, "--seeds", "0", "1", "--no-record"]) == ExitCode.DONE
    assert "95 % interval" in capsys.readouterr().out


def test_a_run_that_is_done_is_read_back_not_repeated(finished, benchmark, capsys):
    folder = finished[1]
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}
    assert run(benchmark, folder.parents[2]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer["splits"] == finished[0]["splits"]
    after = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}
    assert after == before


def test_another_run_does_not_overwrite_a_finished_one(finished, benchmark, capsys):
    out = finished[1].parents[2]
    code = run(benchmark, out, "--threads", "2")
    assert code == ExitCode.USAGE
    assert "holds another run" in capsys.readouterr().err


def test_every_choice_of_settings_has_a_folder_of_its_own(benchmark, tmp_path, capsys):
    base = ("run", "--method", "lcrl", "--benchmark", str(benchmark), "--out", str(tmp_path))
    base = (*base, "--renderer", "rays", "--no-record", "--json")
    brief = ("least_steps=2", "passes=1")
    long = ("fusion=concat", "hidden=16", "image=pooling", "learning_rate=0.001", *brief)
    for settings in (brief, (*brief, "size=32"), (*long, "views=max"), (*long, "views=sum")):
        assert main([*base, "--set", *settings]) == ExitCode.DONE, capsys.readouterr().err
        answer = json.loads(capsys.readouterr().out)
        assert answer["read_back"] == {}
    first, second, *others = sorted(path.parent.parent.name for path in tmp_path.rglob("DONE"))
    assert len({first, second, *others}) == 4
    assert others == ["lcrl-least_steps-2-passes-1", "lcrl-least_steps-2-passes-1-size-32"]
    assert main([*base, "--set", *reversed(settings)]) == ExitCode.DONE
    again = json.loads(capsys.readouterr().out)
    assert list(again["read_back"]) == ["0"], "settings in another order are the same run"
    assert again["splits"] == answer["splits"]


def test_a_killed_run_goes_on_to_the_same_bits(finished, benchmark, tmp_path, capsys, monkeypatch):
    from lcrl_bench.evaluation.run_folder import RunFolder

    log = RunFolder.log

    def kill(self, row):
        log(self, row)
        if row["step"] == 3:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(RunFolder, "log", kill)
        assert run(benchmark, tmp_path, "--no-record") == ExitCode.INTERRUPTED
    assert "Resume with: lcrl-bench run --method lcrl" in capsys.readouterr().err
    assert run(benchmark, tmp_path, "--no-record") == ExitCode.DONE
    resumed = tmp_path / "tiny" / FOLDER / "seed0"
    assert weights(resumed) == weights(finished[1])
    assert timeless(resumed) == timeless(finished[1])
    assert (resumed / "metrics.jsonl").read_text() == (finished[1] / "metrics.jsonl").read_text()


def test_without_json_a_table_is_printed_with_the_controls(finished, benchmark, capsys):
    out = str(finished[1].parents[2])
    words = ("run", "--method", "lcrl", "--benchmark", str(benchmark), "--out", out, *SHORT)
    assert main(words) == ExitCode.DONE
    shown = capsys.readouterr()
    for name in ("lcrl", "random", "optimal", "constant", "lexical", "test-house: success, %"):
        assert name in shown.out
    told = ("blank", "shuffled", "wrong-target", "paraphrase")
    places = [shown.out.index(f"lcrl, {control}") for control in told]
    assert places == sorted(places)
    assert places[-1] < shown.out.index("random")
    assert max(map(len, shown.out.splitlines())) <= 80
    assert "recording.rrd" in shown.err


@pytest.mark.parametrize(
    ("flags", "code", "message"),
    [
        (("--method", "lcrll"), ExitCode.USAGE, "Did you mean 'lcrl'?"),
        (("--method", "lcrl", "--benchmark", "nowhere"), ExitCode.USAGE, "Unknown benchmark"),
        (("--method", "lcrl", "--device", "tpu9"), ExitCode.USAGE, "--device tpu9"),
        (("--method", "lcrl", "--set", "speed=9"), ExitCode.USAGE, "Unknown setting 'speed'"),
        (("--method", "lcrl", "--seeds"), ExitCode.USAGE, "--seeds: give at least one value"),
        (("--method", "lcrl", "--seeds", "1", "2", "1"), ExitCode.USAGE, "1 is repeated"),
        (("--method", "lcrl", "--seeds", "-1"), ExitCode.USAGE, "--seeds -1"),
        (("--method", "lcrl", "--threads", "0"), ExitCode.USAGE, "--threads 0"),
        (("--method", "lcrl", "--preset", "papre"), ExitCode.USAGE, "papre"),
        (("--method", "lcrl", "--renderer", "eyes"), ExitCode.USAGE, "Unknown renderer"),
    ],
)
def test_a_mistake_is_named_before_any_work(flags, code, message, benchmark, tmp_path, capsys):
    named = flags if "--benchmark" in flags else (*flags, "--benchmark", str(benchmark))
    assert main(["run", *named, "--out", str(tmp_path / "runs")]) == code
    assert message in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()


def test_a_learned_reward_is_optimised_again_by_dqn_in_a_row_of_its_own(
    benchmark, finished, capsys
):
    out = finished[1].parents[2]
    flags = ("--optimizer", "dqn-shaping", "--dqn-tasks", "1")
    assert run(benchmark, out, *flags) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer["optimizer"]["name"] == "dqn-shaping"
    assert [row["n"] for row in answer["optimizer"]["splits"].values()] == [1, 1, 1]
    file = finished[1] / "dqn-shaping.json"
    before = file.stat().st_mtime_ns
    assert run(benchmark, out, *flags) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out)["optimizer"] == answer["optimizer"]
    assert file.stat().st_mtime_ns == before


def test_a_preset_is_a_run_of_its_own(benchmark, tmp_path, capsys):
    assert run(benchmark, tmp_path, "--preset", "paper", "--no-record") == ExitCode.DONE
    folder = tmp_path / "tiny" / FOLDER.replace("lcrl", "lcrl-paper") / "seed0"
    config = json.loads((folder / "config.json").read_text())
    assert config["preset"] == "paper"
    assert config["resolved"]["learning_rate"] == 5e-4
    capsys.readouterr()
    assert run(benchmark, tmp_path, "--preset", "ours") == ExitCode.USAGE
    assert "paper" in capsys.readouterr().err
