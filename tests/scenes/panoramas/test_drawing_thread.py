"""One renderer, many threads: the same panoramas, whoever asks, and a clear error after a fork."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from house_samples import two_rooms
from panorama_samples import BACKENDS, need_gl, standing_points

from lcrl_bench.errors import UsageError
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.panoramas import movable_objects, open_renderer
from lcrl_bench.scenes.panoramas.drawing_thread import DrawingThread

THREADS = 4


@pytest.mark.parametrize("backend", BACKENDS)
def test_threads_that_share_a_renderer_see_what_one_sees(backend: str):
    need_gl(backend)
    house = two_rooms()
    points = standing_points(house)
    arrangements = [Arrangement("cup") if number % 2 else Arrangement() for number in range(12)]
    with open_renderer(
        house_surfaces(house), movable=movable_objects(house), backend=backend
    ) as renderer:
        alone = [renderer.render(points, each) for each in arrangements]
        with ThreadPoolExecutor(THREADS) as pool:
            shared = list(pool.map(lambda each: renderer.render(points, each), arrangements))
    assert (alone[0] != alone[1]).any()
    for one, other in zip(alone, shared, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_renderer_opened_in_a_thread_outlives_it(backend: str):
    need_gl(backend)
    house = two_rooms()
    points, surfaces = standing_points(house, 4), house_surfaces(house)
    with ThreadPoolExecutor(1) as pool:
        renderer = pool.submit(open_renderer, surfaces, backend=backend).result()
    with renderer, open_renderer(surfaces, backend=backend) as other:
        np.testing.assert_array_equal(renderer.render(points), other.render(points))


def test_a_renderer_dropped_in_another_thread_leaves_others_unharmed():
    need_gl()
    house = two_rooms()
    points, surfaces = standing_points(house, 4), house_surfaces(house)
    with open_renderer(surfaces, backend="gl") as kept:
        before = kept.render(points)
        dropped = [open_renderer(surfaces, backend="gl")]
        alive = weakref.ref(dropped[0])
        dropped[0].render(points)
        with ThreadPoolExecutor(1) as pool:
            pool.submit(dropped.clear).result()
        gc.collect()
        assert alive() is None
        np.testing.assert_array_equal(kept.render(points), before)


def test_a_closed_renderer_leaves_no_thread_behind():
    need_gl()
    with open_renderer([], backend="gl"):
        (worker,) = (each for each in threading.enumerate() if each.name == "lcrl-drawing")
    worker.join(timeout=600)
    assert not worker.is_alive()


def test_functions_run_in_one_thread_and_raise_where_they_were_asked_for():
    thread = DrawingThread()
    with ThreadPoolExecutor(THREADS) as pool:
        found = set(pool.map(lambda _: thread.run(threading.get_ident), range(20)))
    assert len(found) == 1
    assert found != {threading.get_ident()}
    with pytest.raises(ZeroDivisionError):
        thread.run(divmod, 1, 0)
    assert thread.run(lambda: thread.run(divmod, 7, 2)) == (3, 1)
    thread.stop()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_renderer_carried_into_a_fork_is_refused_not_hung():
    need_gl()
    script = (
        "import os, sys\n"
        "import numpy as np\n"
        "from lcrl_bench.errors import UsageError\n"
        "from lcrl_bench.scenes.panoramas import open_renderer\n"
        "renderer = open_renderer([], backend='gl')\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    try:\n"
        "        renderer.render(np.zeros((1, 2)))\n"
        "    except UsageError as error:\n"
        "        os._exit(7 if 'forked' in str(error) else 8)\n"
        "    os._exit(9)\n"
        "_, status = os.waitpid(child, 0)\n"
        "renderer.render(np.zeros((1, 2)))\n"
        "print(os.waitstatus_to_exitcode(status))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout.strip()) == (0, "7"), done.stderr


def test_a_thread_of_another_process_is_refused(monkeypatch: pytest.MonkeyPatch):
    thread = DrawingThread()
    with monkeypatch.context() as patch:
        patch.setattr(os, "getpid", lambda: -1)
        with pytest.raises(UsageError, match=r'forked process.*context="spawn"'):
            thread.run(print)
        thread.stop()
    assert thread.run(divmod, 7, 2) == (3, 1)
    thread.stop()
