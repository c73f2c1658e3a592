"""Many environments at once are the same as one by one, however their processes are started."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import signal
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from environment_samples import sample_benchmark
from gymnasium.utils.env_checker import data_equivalence

from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.errors import UsageError
from lcrl_bench.scenes.panoramas.context import describe_gl

PROGRAM = Path(__file__).with_name("vector_program.py")
SECONDS = 300
"""Until a program is taken to hang; it takes some ten."""
EVERYWHERE = multiprocessing.get_all_start_methods()
# Python from 3.12 on warns of any fork beside threads; that it works all the same is tested here.
pytestmark = pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
FORK = pytest.mark.skipif("fork" not in EVERYWHERE, reason="this system has no fork")


def run(*cell: str) -> None:
    """Run the program on two threads; kill it with its children if it hangs."""
    if "gl" in cell and describe_gl().backend is None:
        pytest.skip("no OpenGL here")
    environment = os.environ | {"OMP_NUM_THREADS": "2", "PYTHONPATH": str(PROGRAM.parents[1])}
    process = subprocess.Popen(
        [sys.executable, str(PROGRAM), *cell],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        said, _ = process.communicate(timeout=SECONDS)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        pytest.fail(f"{' '.join(cell)}: hangs")
    assert process.returncode == 0, said


def make(mode: str, **more) -> gymnasium.vector.VectorEnv:
    arguments = {"benchmark": sample_benchmark(), "renderer": "rays", "split": None}
    return gymnasium.make_vec(
        HOUSE_ID,
        num_envs=3,
        vectorization_mode=mode,
        vector_kwargs=more,
        **arguments,
        position=True,
    )


def play(vector: gymnasium.vector.VectorEnv) -> list:
    returned: list = [vector.reset(seed=7)]
    for step in range(34):
        returned.append(vector.step(np.array([0, 1, 2]) if step % 2 else np.array([3, 0, 0])))
    vector.close()
    return returned


@FORK
@pytest.mark.parametrize(
    "cell", [("cold", "true", "gl"), ("warm", "learned", "torch")], ids=" ".join
)
def test_forked_environments_work_after_opengl_and_torch(cell):
    run("fork", *cell)


@FORK
@pytest.mark.slow
@pytest.mark.parametrize("parent", ["gl", "torch"])
def test_an_environment_of_the_parent_goes_on_in_a_fork(parent):
    run("by-hand", "cold", "learned", parent)


@pytest.mark.slow
@pytest.mark.parametrize(
    "cell",
    list(
        itertools.product(
            EVERYWHERE, ("cold", "warm"), ("true", "learned"), ("nothing", "gl", "torch")
        )
    ),
    ids=" ".join,
)
def test_environments_work_however_they_are_started_and_whatever_ran_before(cell):
    run(*cell)


@pytest.mark.parametrize("autoreset_mode", ["NextStep", "SameStep"])
def test_shared_memory_or_none_or_no_process_at_all_return_the_same(autoreset_mode):
    ways = [("sync", {}), ("async", {"shared_memory": True}), ("async", {"shared_memory": False})]
    played = [play(make(mode, autoreset_mode=autoreset_mode, **more)) for mode, more in ways]
    assert data_equivalence(played[0], played[1])
    assert data_equivalence(played[0], played[2])


def test_the_command_arrives_through_shared_memory_and_changes_with_the_task():
    vector = make("async")
    seen, info = vector.reset(seed=7)
    commands = {task.id: task.command for task in sample_benchmark().tasks}
    texts = set()
    for _ in range(4):
        assert seen["text"] == tuple(commands[name] for name in info["task"])
        assert seen in vector.observation_space
        texts.add(seen["text"])
        seen, info = vector.reset()
    assert len(texts) > 1
    vector.close()


def test_without_copies_the_text_is_that_of_now():
    vector = make("async", copy=False)
    first, _ = vector.reset(options={"task": "rooms-a.go-to-the-bed"})
    text = first["text"]
    assert list(text) == ["go to the bed"] * 3
    vector.reset(options={"task": "rooms-b.move-the-cup-to-the-bed"})
    assert (len(text), text[0], text[1:]) == (
        3,
        "move the cup to the bed",
        ("move the cup to the bed",) * 2,
    )
    vector.close()


def test_several_at_once_are_the_same_as_one_by_one():
    vector = make("sync")
    alone = [
        gymnasium.make(
            HOUSE_ID, benchmark=sample_benchmark(), renderer="rays", split=None, position=True
        )
        for _ in range(3)
    ]
    seen, info = vector.reset(seed=7)
    firsts = [one.reset(seed=7 + number) for number, one in enumerate(alone)]
    assert list(info["task"]) == [each[1]["task"] for each in firsts]
    assert list(seen["text"]) == [each[0]["text"] for each in firsts]
    seen, rewards, *_ = vector.step(np.array([0, 1, 2]))
    steps = [one.step(action) for action, one in enumerate(alone)]
    for key in ("panorama", "heading", "held", "command", "tile"):
        assert (seen[key] == np.stack([each[0][key] for each in steps])).all()
    assert rewards.tolist() == [each[1] for each in steps]


# Gymnasium shows the child's traceback as a warning.
@pytest.mark.filterwarnings("ignore:.*ERROR:UserWarning")
def test_an_error_in_a_process_arrives_in_its_own_words():
    vector = make("async")
    with pytest.raises(UsageError, match=r"Did you mean 'rooms-b\.go-to-the-bed'\?"):
        vector.reset(options={"task": "rooms-b.go-to-the-bee"})
    vector.close(terminate=True)
