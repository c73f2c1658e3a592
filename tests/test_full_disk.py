"""A disk that is full: whatever writes names its file, and leaves nothing half-written.

A limit on the size of files stands in for the full disk: the operating system refuses to write for
real, with EFBIG where a full disk says ENOSPC.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
LIMIT = 3000

PREPARE = """
import resource, sys
from pathlib import Path

sys.path[:0] = ["{tests}", "{tests}/recording"]
import numpy as np
import torch

out = Path("out")

def limited(write):
    resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
    from lcrl_bench.errors import EnvironmentMissingError
    try:
        write()
    except EnvironmentMissingError as error:
        print(error)
    else:
        print("no error")

def episode():
    from episode_samples import SeenReward, make_episode, sample_benchmark
    from lcrl_bench.benchmarks.task import Kind
    from lcrl_bench.benchmarks.task_sets import load_task_sets
    benchmark = sample_benchmark()
    sets = load_task_sets(benchmark, device=torch.device("cpu"), renderer="rays")
    return make_episode(SeenReward(), sets, benchmark, Kind.NAV)
"""

WRITERS = {
    "file.json": """
from lcrl_bench.storage import write_json
limited(lambda: write_json(out / "file.json", list(range(9000))))
""",
    "weights.safetensors": """
from safetensors.torch import save
from lcrl_bench.storage import write_bytes
data = save({"w": torch.zeros(9000)})
limited(lambda: write_bytes(out / "weights.safetensors", data))
""",
    "table.parquet": """
import pyarrow, pyarrow.parquet
from lcrl_bench.storage import atomic_path
table = pyarrow.table({"a": np.random.default_rng(0).random(9000)})
def write():
    with atomic_path(out / "table.parquet") as temporary:
        pyarrow.parquet.write_table(table, temporary)
limited(write)
""",
    "picture.png": """
from matplotlib.figure import Figure
from lcrl_bench.recording.figures import save_figure
figure = Figure()
figure.subplots().imshow(np.random.default_rng(0).random((90, 90)))
limited(lambda: save_figure(out / "picture.png", figure))
""",
    "go.npz": """
from lcrl_bench.recording.episode import write_episode
one = episode()
limited(lambda: write_episode(out, "go", one))
""",
    "go.rrd": """
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.storyboard import storyboard_of
board = storyboard_of(episode())
limited(lambda: record_episodes(out / "go.rrd", [board]))
""",
    "houses": """
from benchmark_samples import tiny_benchmark
from lcrl_bench.benchmarks.document import write_benchmark
benchmark = tiny_benchmark()
limited(lambda: write_benchmark(out / "tiny", benchmark))
""",
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_writer_names_its_file_and_leaves_nothing(name, tmp_path):
    prepare = PREPARE.replace("{tests}", str(TESTS)).replace("{limit}", str(LIMIT))
    done = subprocess.run(
        [sys.executable, "-c", prepare + WRITERS[name]],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "can't be written: " in done.stdout
    assert f"{name}" in done.stdout.partition(":")[0]
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_a_line_that_does_not_fit_is_not_there_by_half(tmp_path):
    program = f"""
import resource
from pathlib import Path
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import append_text
resource.setrlimit(resource.RLIMIT_FSIZE, ({LIMIT}, {LIMIT}))
try:
    while True:
        append_text(Path("rows.jsonl"), '{{"step": 1, "loss": 0.123456}}\\n')
except EnvironmentMissingError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.stdout.startswith("rows.jsonl: can't be written: File too large"), done.stderr
    lines = (tmp_path / "rows.jsonl").read_text().splitlines()
    assert len(lines) > 50
    assert all(json.loads(line)["step"] == 1 for line in lines)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_an_answer_that_can_not_be_written_is_the_disks_fault_and_no_bug():
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "lcrl_bench", "list", "methods"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 4
    assert done.stderr.endswith("error: No space left on device: standard output.\n")
