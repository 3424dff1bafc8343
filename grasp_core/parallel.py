"""One map over scenes: local processes by default, a Ray cluster when one is named; the same results either way.

Local processes are spawned, use one thread each, and may die: an item whose process was killed (out of memory, a crash
of the engine) is given to a new one. Results come in the order of completion, with the index of their item.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import re
import signal
import socket
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any, TypeVar

from grasp_core.errors import Cancelled, GraspError

T = TypeVar("T")
R = TypeVar("R")

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")
_TRIES = 3
_POLL = 0.2
"""Seconds between looks at `cancelled`."""


@dataclass(frozen=True)
class Executor:
    """Where work runs.

    Attributes:
        workers: local processes; None takes one per core, 0 works in this process.
        ray: address of a Ray cluster ("auto", "host:port", "ray://host:10001"), or None for local processes.
    """

    workers: int | None = None
    ray: str | None = None

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 0:
            raise GraspError(f"the number of workers is 0 (this process) or above, not {self.workers}")


def cores() -> int:
    """How many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        return os.cpu_count() or 1


def map_scenes(
    work: Callable[[T], R],
    items: Sequence[T],
    executor: Executor | None = None,
    *,
    cancelled: Callable[[], bool] | None = None,
) -> Iterator[tuple[int, R]]:
    """Yield (index, work(item)) for every item, in the order of completion.

    Args:
        work: a picklable callable that depends on nothing but its item.
        items: picklable.
        executor: where it runs.
        cancelled: asked a few times a second; true ends the map.

    Raises:
        Cancelled: `cancelled` said so; results yielded before stand.
        GraspError: an item's process ended again and again, or there is no cluster at the address.
        Exception: whatever `work` raised, at its first raise.
    """
    executor = executor or Executor()
    stop = cancelled or (lambda: False)
    if executor.ray is not None:
        yield from _on_ray(work, items, executor.ray, stop)
    elif executor.workers == 0:
        for index, item in enumerate(items):
            if stop():
                raise Cancelled("cancelled; what was finished is kept")
            yield index, work(item)
    elif items:
        count = min(executor.workers or cores(), len(items))
        yield from _LocalPool(work, items, count).run(stop)


class _Worker:
    """One spawned process and the item it works on."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        # not daemonic: work may have child processes of its own (mesh decomposition)
        self.process: SpawnProcess = context.Process(target=_serve, args=(work, theirs), daemon=False)
        with _SingleThreaded():
            self.process.start()
        theirs.close()
        self.item: int | None = None
        self.ready = False

    def stop(self) -> None:
        self.pipe.close()
        if self.process.is_alive():
            self.process.terminate()
        self.process.join(2)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()


class _LocalPool:
    def __init__(self, work: Callable[[Any], Any], items: Sequence[Any], count: int) -> None:
        self._work = work
        self._items = items
        self._waiting = deque(range(len(items)))
        self._deaths: dict[int | None, int] = {}
        self._workers = [_Worker(work) for _ in range(count)]

    def run(self, stop: Callable[[], bool]) -> Iterator[tuple[int, Any]]:
        left = len(self._items)
        try:
            while left:
                if stop():
                    raise Cancelled("cancelled; what was finished is kept")
                ready = wait([worker.pipe for worker in self._workers], _POLL)
                for worker in [w for w in self._workers if w.pipe in ready]:
                    for index, result in self._listen(worker):
                        left -= 1
                        yield index, result
        finally:
            for worker in self._workers:
                worker.stop()

    def _listen(self, worker: _Worker) -> Iterator[tuple[int, Any]]:
        """Take what one worker says: ready, a result, an error, or its end; then give it the next item."""
        try:
            kind, value = worker.pipe.recv()
        except (EOFError, OSError):
            self._replace(worker)
            return
        if kind == "error":
            raise value
        index = worker.item
        worker.ready, worker.item = True, None
        self._feed(worker)
        if kind == "result" and index is not None:
            yield index, value

    def _feed(self, worker: _Worker) -> None:
        if not self._waiting:
            return
        worker.item = self._waiting.popleft()
        try:
            worker.pipe.send(self._items[worker.item])
        except OSError:
            self._replace(worker)

    def _replace(self, worker: _Worker) -> None:
        """A worker died: its item goes back to the front, a new process takes its place."""
        worker.stop()
        item = worker.item
        self._deaths[item] = self._deaths.get(item, 0) + 1
        if self._deaths[item] >= _TRIES:
            code = worker.process.exitcode
            if not worker.ready:
                raise GraspError(
                    f"worker processes end as they start (exit status {code}); a script that generates needs its calls"
                    " below `if __name__ == '__main__':`, or --workers 0"
                )
            raise GraspError(
                f"item {item} ended its process {_TRIES} times (exit status {code}), perhaps for want of memory; run"
                " with --workers 1 to leave it more, or leave that object out"
            )
        if item is not None:
            self._waiting.appendleft(item)
        self._workers[self._workers.index(worker)] = _Worker(self._work)


class _SingleThreaded:
    """While it holds, processes that start get one thread each."""

    _lock = threading.Lock()

    def __enter__(self) -> None:
        self._lock.acquire()
        self._before = {name: os.environ.get(name) for name in _THREADS}
        os.environ.update(dict.fromkeys(_THREADS, "1"))

    def __exit__(self, *_: object) -> None:
        for name, value in self._before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
        self._lock.release()


def _serve(work: Callable[[Any], Any], pipe: Connection) -> None:
    """The loop of a worker process: receive an item, send its result; end with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:

        def follow() -> None:
            parent.join()
            os._exit(1)

        threading.Thread(target=follow, daemon=True).start()
    pipe.send(("ready", None))
    while True:
        try:
            item = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            answer: tuple[str, Any] = ("result", work(item))
        except Exception as error:
            answer = ("error", _portable(error))
        try:
            pipe.send(answer)
        except OSError:
            return


def _portable(error: Exception) -> Exception:
    """The error itself when it survives the way to another process, with the traceback as a note, else its text."""
    error.add_note(traceback.format_exc())
    try:
        pickle.loads(pickle.dumps(error))
        return error
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}\n{traceback.format_exc()}")


def _call(work: Callable[[Any], Any], item: Any) -> Any:
    return work(item)


def _refuse_silence(address: str) -> None:
    """Ray itself waits for minutes for a cluster that is not there."""
    found = re.fullmatch(r"(?:ray://)?\[?([^\[\]/]+)\]?:(\d+)", address)
    if found is None:
        return
    try:
        socket.create_connection((found.group(1), int(found.group(2))), timeout=5).close()
    except OSError as error:
        raise GraspError(
            f"no Ray cluster answers at '{address}' ({error}); start one with `ray start --head`"
        ) from error


def _on_ray(
    work: Callable[[Any], Any], items: Sequence[Any], address: str, stop: Callable[[], bool]
) -> Iterator[tuple[int, Any]]:
    try:
        import ray
    except ImportError as error:
        raise GraspError("Ray is not installed; pip install 'grasp-workbench[cluster]'") from error
    _refuse_silence(address)
    ours = not ray.is_initialized()
    try:
        ray.init(address=address, ignore_reinit_error=True, log_to_driver=False, logging_level=logging.ERROR)
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise GraspError(
            f"no Ray cluster answers at '{address}' ({error}); start one with `ray start --head`"
        ) from error
    task = ray.remote(num_cpus=1, max_retries=_TRIES)(_call)
    shared = ray.put(work)
    waiting = deque(range(len(items)))
    pending: dict[Any, int] = {}
    lost: dict[int, int] = {}
    try:
        while waiting or pending:
            if stop():
                raise Cancelled("cancelled; what was finished is kept")
            room = 2 * max(1, int(ray.cluster_resources().get("CPU", 1)))
            while waiting and len(pending) < room:
                index = waiting.popleft()
                pending[task.remote(shared, items[index])] = index
            done, _ = ray.wait(list(pending), timeout=_POLL)
            for reference in done:
                index = pending.pop(reference)
                try:
                    result = ray.get(reference)
                except ray.exceptions.RayTaskError as error:
                    raise error.cause if isinstance(error.cause, GraspError) else error from None
                except ray.exceptions.RayError as error:  # its worker, its node or its result is gone
                    lost[index] = lost.get(index, 0) + 1
                    if lost[index] >= _TRIES:
                        raise GraspError(f"item {index} was lost {_TRIES} times by the cluster ({error})") from error
                    waiting.appendleft(index)
                    continue
                yield index, result
    finally:
        for reference in pending:
            ray.cancel(reference, force=True)
        if ours:
            ray.shutdown()
