"""Worker processes: they run planning and DART, so that the page never waits for them.

A crash of the worker fails the jobs that were in it, is reported, and the worker is replaced at once.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import ParamSpec, TypeVar

from grasp_core.errors import GraspError

log = logging.getLogger("workbench")

P = ParamSpec("P")
R = TypeVar("R")


class WorkerLost(GraspError):
    """The worker process died while it had this job."""


def _begin(prepare: Callable[[], None] | None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the parent, which then ends this process
    parent = multiprocessing.parent_process()
    assert parent is not None

    def follow() -> None:
        parent.join()
        os._exit(0)

    threading.Thread(target=follow, daemon=True, name="follow-parent").start()
    if prepare is not None:
        prepare()


class Jobs:
    """One worker process that is always there.

    Args:
        name: what the worker is for, for people.
        prepare: what the worker does first (imports, loading weights); a module-level function.
        on_lost: called with one line when the worker died and was replaced, from another thread.
    """

    def __init__(
        self,
        name: str,
        prepare: Callable[[], None] | None = None,
        on_lost: Callable[[str], None] = lambda text: None,
    ) -> None:
        self._name = name
        self._prepare = prepare
        self._on_lost = on_lost
        self._lock = threading.Lock()
        self._closed = False
        self._pool = self._start()

    def _start(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(
            1, mp_context=multiprocessing.get_context("spawn"), initializer=_begin, initargs=(self._prepare,)
        )

    def submit(
        self,
        done: Callable[[R], None],
        failed: Callable[[str], None],
        work: Callable[P, R],
        *args: P.args,
        **kwargs: P.kwargs,
    ) -> None:
        """Run `work` in the worker, then `done` with its result or `failed` with one line, on another thread.

        Args:
            done: takes what `work` returned.
            failed: takes the reason: the message of a `GraspError`, else type and message.
            work: a module-level function.
            args: of it; they and the result must be picklable.
            kwargs: of it.
        """
        for last in (False, True):
            with self._lock:
                if self._closed:
                    return
                pool = self._pool
                try:
                    future = pool.submit(work, *args, **kwargs)
                    break
                except BrokenProcessPool as error:
                    future = Future()
                    future.set_exception(error)
            if not last:  # it died while it had nothing to do: the next one takes the job
                self._replace(pool)

        def finished(job: Future[R]) -> None:
            try:
                error = job.exception()
            except CancelledError:
                return
            if error is None:
                done(job.result())
            elif isinstance(error, BrokenProcessPool):
                self._replace(pool)
                failed("the worker process died while it worked on this; it was replaced, try again")
            elif isinstance(error, GraspError):
                failed(str(error))
            else:
                log.error("a job failed", exc_info=error)
                failed(f"{type(error).__name__}: {error}")

        future.add_done_callback(finished)

    def _replace(self, broken: ProcessPoolExecutor) -> None:
        with self._lock:
            if self._closed or self._pool is not broken:
                return
            self._pool = self._start()
            self._pool.submit(os.getpid)  # starts the process now, not with the next job
        broken.shutdown(wait=False)
        log.warning("the %s worker died and was replaced", self._name)
        self._on_lost(f"The {self._name} worker died; a new one takes over.")

    def close(self) -> None:
        """End the worker; jobs that wait are dropped."""
        with self._lock:
            self._closed = True
            processes = list((self._pool._processes or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()
