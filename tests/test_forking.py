"""A forked process knows that it is one, however it was forked."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from lcrl_bench.forking import is_forked, refuse_opengl_if_forked
from lcrl_bench.scenes.panoramas import backends, context

PROGRAM = '''
import json, multiprocessing, os
{imports}

def tell(queue):
    from lcrl_bench.forking import is_forked
    queue.put(is_forked())

def tell_of_a_fork(queue):
    """Forked by hand, in a process that multiprocessing started."""
    from lcrl_bench.forking import is_forked
    if os.fork() == 0:
        queue.put(is_forked())
        queue.close()
        queue.join_thread()
        os._exit(0)
    os.wait()

if __name__ == "__main__":
    found = {{}}
    for method in multiprocessing.get_all_start_methods():
        context = multiprocessing.get_context(method)
        queue = context.Queue()
        child = context.Process(target=tell, args=(queue,))
        child.start()
        found[method] = queue.get()
        child.join()
    context = multiprocessing.get_context("spawn")
    queue = context.Queue()
    child = context.Process(target=tell_of_a_fork, args=(queue,))
    child.start()
    found["fork in spawn"] = queue.get()
    child.join()
    print(json.dumps(found))
'''
UNIX = pytest.mark.skipif(sys.platform == "win32", reason="no fork")


def test_this_process_is_not_forked():
    assert not is_forked()
    refuse_opengl_if_forked()


@UNIX
@pytest.mark.parametrize("imports", ["", "import lcrl_bench.forking"], ids=["child", "parent"])
def test_a_fork_is_one_whoever_imported_the_module(imports, tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.format(imports=imports))
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    expected = {"fork": True, "spawn": False, "forkserver": False, "fork in spawn": True}
    assert json.loads(done.stdout) == expected


@UNIX
def test_a_fork_renders_with_rays_and_refuses_opengl(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(
        "import os\n"
        "from lcrl_bench.errors import UsageError\n"
        f"from {backends.__name__} import choose_backend\n"
        f"from {context.__name__} import open_context\n"
        "if os.fork() == 0:\n"
        "    print(choose_backend('auto'), choose_backend('gl'))\n"
        "    try:\n"
        "        open_context(8, 8)\n"
        "    except UsageError as error:\n"
        "        print(error, flush=True)\n"
        "    os._exit(0)\n"
        "os.wait()\n"
    )
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True)
    assert done.stdout.startswith("rays gl\n"), done.stderr
    assert "context='spawn'" in done.stdout
