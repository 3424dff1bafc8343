import functools
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from grasp_core.errors import Cancelled, GraspError
from grasp_core.parallel import Executor, cores, map_scenes


def write(path: Path, body: str) -> Path:
    """Worker processes import `work` by name, so it stands in a script of its own."""
    path.write_text(
        "import os, sys, time, signal\nfrom pathlib import Path\n"
        "from grasp_core.parallel import Executor, map_scenes\nfrom grasp_core.errors import *\n"
        + textwrap.dedent(body)
    )
    return path


def script(path: Path, *arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, str(path), *arguments], capture_output=True, text=True, timeout=60)


def test_in_this_process_and_in_others_the_same():
    square = functools.partial(pow, exp=2)
    here = dict(map_scenes(square, range(7), Executor(workers=0)))
    there = dict(map_scenes(square, range(7), Executor(workers=2)))
    assert here == there == {i: i * i for i in range(7)}


def test_workers_have_one_thread_each_and_leave_the_parent_alone():
    before = os.environ.get("OMP_NUM_THREADS")
    assert dict(map_scenes(os.getenv, ["OMP_NUM_THREADS"], Executor(workers=1))) == {0: "1"}
    assert os.environ.get("OMP_NUM_THREADS") == before


def test_no_items():
    assert list(map_scenes(abs, [])) == []


def test_a_killed_worker_costs_nothing(tmp_path):
    path = write(
        tmp_path / "killed.py",
        """
        def work(item):
            mark = Path(sys.argv[1]) / str(item)
            if item == 2 and not mark.exists():
                mark.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            return item * 10

        if __name__ == "__main__":
            print(sorted(map_scenes(work, range(5), Executor(workers=2))))
        """,
    )
    done = script(path, str(tmp_path))
    assert done.stdout.strip() == str([(i, i * 10) for i in range(5)]), done.stderr


def test_an_item_that_always_kills_is_named(tmp_path):
    path = write(
        tmp_path / "deadly.py",
        """
        def work(item):
            os.kill(os.getpid(), signal.SIGKILL)

        if __name__ == "__main__":
            try:
                list(map_scenes(work, [1], Executor(workers=1)))
            except GraspError as error:
                print(error)
        """,
    )
    assert "item 0 ended its process 3 times" in script(path).stdout


def test_errors_of_work_come_back_as_they_are():
    with pytest.raises(ZeroDivisionError):
        list(map_scenes((1).__truediv__, [1, 0], Executor(workers=0)))
    with pytest.raises(TypeError):
        list(map_scenes(len, [3], Executor(workers=1)))


@pytest.mark.parametrize("workers", [0, 1])
def test_cancel(workers):
    begin = time.monotonic()
    seen = []
    with pytest.raises(Cancelled, match="kept"):
        for index, _ in map_scenes(time.sleep, [0.0] + [20.0] * 3, Executor(workers=workers), cancelled=lambda: seen):
            seen.append(index)
    assert seen == [0]
    assert time.monotonic() - begin < 15


def test_workers_end_with_a_killed_parent(tmp_path):
    path = write(
        tmp_path / "orphan.py",
        """
        def work(item):
            (Path(sys.argv[1]) / f"pid{os.getpid()}").touch()
            time.sleep(60)

        if __name__ == "__main__":
            list(map_scenes(work, [1, 2], Executor(workers=2)))
        """,
    )
    process = subprocess.Popen([sys.executable, str(path), str(tmp_path)])
    try:
        deadline = time.monotonic() + 30
        while len(list(tmp_path.glob("pid*"))) < 2 and time.monotonic() < deadline:
            time.sleep(0.05)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    pids = [int(file.name[3:]) for file in tmp_path.glob("pid*")]
    assert len(pids) == 2
    deadline = time.monotonic() + 10
    while any(Path(f"/proc/{pid}/cmdline").exists() for pid in pids) and time.monotonic() < deadline:
        time.sleep(0.05)
    alive = [p for p in pids if Path(f"/proc/{p}/cmdline").exists() and Path(f"/proc/{p}/cmdline").read_bytes()]
    assert alive == []


def test_settings():
    assert cores() >= 1
    with pytest.raises(GraspError, match="-1"):
        Executor(workers=-1)
