"""`grasp-workbench --benchmark`: how fast the workbench is, measured in a headless Chromium as a user would see it.

Times are taken inside the page: from the click or the pointer's movement to what is on the screen.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grasp_core.errors import GraspError
from grasp_core.evaluation.machine import Watch

FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
"""Of a Chromium without screen and GPU: WebGL runs in software, so that frames are slower than on a desktop."""
_START = 120.0
PLAN = "svg.gw-depth g[data-candidate]"
_DRAG = 6.0
"""Seconds of the drag."""
_FRAMES = """seconds => new Promise(done => {
  const bodies = ['gripper/base', 'gripper/left_finger', 'gripper/right_finger', 'objects/0'];
  const place = name => window.__viserMutable.nodeRefFromName['/inspect/' + name].position.toArray().join();
  const frames = new Set(), end = performance.now() + 1000 * seconds;
  const look = () => { frames.add(bodies.map(place).join(';'));
    performance.now() < end ? requestAnimationFrame(look) : done(frames.size); };
  look(); })"""
"""JavaScript: how many different frames of a replay are drawn; while the fingers close, nothing else moves."""
_CLICK = """row => new Promise(done => {
  const node = () => window.__viserMutable.nodeRefFromName['/inspect/gripper/base'];
  const start = performance.now();
  document.querySelectorAll('.gw-list tr[data-candidate]')[row].click();
  const look = () => document.querySelector('[data-outcome]') && document.querySelector('[data-playing=true]')
    ? requestAnimationFrame(() => done(performance.now() - start)) : requestAnimationFrame(look);
  look(); })"""
_MOVE = """([x, y, seconds]) => new Promise(done => {
  const canvas = document.querySelector('canvas[data-engine]'), start = performance.now(), seen = []; let last = '';
  const frame = () => {
    const now = performance.now(), image = document.querySelector('.gw-depth-image')?.getAttribute('href') ?? last;
    if (image !== last) { last = image; seen.push(now); }
    if (now - start > 1000 * seconds) return done(seen);
    canvas.dispatchEvent(new PointerEvent('pointermove', {bubbles: true, pointerId: 1, pointerType: 'mouse', buttons: 1,
      isPrimary: true, clientX: x - 30 * (1 - Math.abs((now - start) / 1000 % 2 - 1)), clientY: y}));
    requestAnimationFrame(frame); };
  frame(); })"""
"""JavaScript: moves the pressed mouse back and forth, 30 pixels a second, and says when another image was on screen.

A moving mouse reaches a page once a frame, so that is when it moves; movements from outside would wait for each other.
"""
HANDLE = """offset => {
  const node = window.__viserMutable.nodeRefFromName['/inspect/gizmo'], camera = window.__viserMutable.camera;
  node.updateWorldMatrix(true, true);
  const p = node.position.clone().set(...offset).applyMatrix4(node.matrixWorld).project(camera);
  const box = document.querySelector('canvas[data-engine]').getBoundingClientRect();
  return [box.left + (p.x + 1) / 2 * box.width, box.top + (1 - p.y) / 2 * box.height]; }"""
"""JavaScript: where a point of the gizmo (metres, its own frame) is on the page."""


@dataclass(frozen=True)
class Result:
    """What was measured.

    Attributes:
        first_plan_s: from the start of the program to the first plan on screen.
        click_to_frame_s: from a click on a candidate to the first frame of its replay; median of several.
        expected_click_to_frame_s: the same for the best candidate, which the workbench tries ahead of the click.
        drag_updates_per_s: plans on screen a second while an object is dragged.
        drag_latency_ms: that the page itself shows, at the end of the drag.
        replay_frames: different frames shown in a second of a replay.
        changes: scenes that were opened for the memory.
        memory_mb: of the program with its workers after a quarter, a half, three quarters and all of them.
    """

    first_plan_s: float
    click_to_frame_s: float
    expected_click_to_frame_s: float
    drag_updates_per_s: float
    drag_latency_ms: float
    replay_frames: float
    changes: int
    memory_mb: tuple[float, ...]


def chromium() -> str:
    """The Chromium of this machine.

    Raises:
        GraspError: there is none.
    """
    found = next((path for name in ("chromium", "chromium-browser") if (path := shutil.which(name))), None)
    if found is None:
        raise GraspError("--benchmark needs Chromium on the PATH (on Debian: apt-get install chromium)")
    return found


@contextmanager
def _workbench() -> Iterator[tuple[subprocess.Popen[str], str]]:
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "workbench.cli", "--port", "0", "--no-open", "--dataset", f"{folder}/own"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            try:
                assert process.stdout is not None
                line = process.stdout.readline()
                if "http://" not in line:
                    raise GraspError("the workbench did not start; run grasp-workbench --debug")
                yield process, line.split()[-1]
            finally:
                process.terminate()


def memory_mb(pid: int) -> float:
    """Resident memory of a process and all that it started, 10⁶ bytes (proc(5)).

    Raises:
        GraspError: this system has no /proc.
    """
    parents: dict[int, list[int]] = {}
    try:
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit():
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                parents.setdefault(int(fields[1]), []).append(int(entry.name))
    except FileNotFoundError:
        pass  # one that just ended
    except OSError as error:
        raise GraspError("the memory is read from /proc, which this system does not have") from error
    total, left = 0, [pid]
    while left:
        one = left.pop()
        left += parents.get(one, [])
        try:
            pages = int(Path(f"/proc/{one}/statm").read_text().split()[1])
        except (OSError, IndexError):
            continue
        total += pages * 4096
    return round(total / 1e6, 1)


def run(changes: int, watch: Watch) -> Result:
    """Measure everything; takes some minutes, most of them for the scene changes.

    Args:
        changes: scenes that are opened for the memory.
        watch: of the machine; it is stopped before browser and workbench end, whose processes nobody waits for.

    Raises:
        GraspError: no Chromium, no playwright, or the workbench does not start.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise GraspError("--benchmark needs the package playwright: pip install 'grasp-workbench[test]'") from error
    executable = chromium()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        start = time.perf_counter()
        with _workbench() as (process, url):
            page = browser.new_context(viewport={"width": 1280, "height": 720}).new_page()
            page.goto(url)
            page.wait_for_selector(PLAN, timeout=1000 * _START)
            first = time.perf_counter() - start
            page.wait_for_timeout(4000)
            rate, latency = _drag(page)
            page.wait_for_timeout(3000)
            expected = float(page.evaluate(_CLICK, 0)) / 1000
            frames = float(page.evaluate(_FRAMES, 1.0))
            clicks = [
                _click(page, row) for row in range(1, min(5, page.locator(".gw-list tr[data-candidate]").count()))
            ]
            clicks.sort()
            memory = _change(page, process.pid, changes)
            watch.stop()
        browser.close()
    middle = clicks[len(clicks) // 2] if clicks else float("nan")
    return Result(
        round(first, 2), round(middle, 3), round(expected, 3), round(rate, 1), latency, frames, changes, memory
    )


def _click(page: Any, row: int) -> float:
    page.wait_for_selector("[data-successes]", timeout=60_000)  # the trial before has ended
    page.wait_for_selector("[data-playing=false]", timeout=60_000)
    return float(page.evaluate(_CLICK, row)) / 1000


def _drag(page: Any) -> tuple[float, float]:
    """Plans a second on screen while the object is dragged back and forth, and the latency that the page shows."""
    x, y = page.evaluate(HANDLE, [0.09, 0, 0])
    page.mouse.move(x, y)
    page.wait_for_timeout(300)
    page.mouse.down()
    page.mouse.move(x - 5, y + 2)
    page.wait_for_timeout(1000)
    seen = page.evaluate(_MOVE, [x - 5, y + 2, _DRAG])
    told = page.locator("[data-live]").inner_text() if page.locator("[data-live]").count() else "0 ms"
    page.mouse.up()
    rate = (len(seen) - 1) / (seen[-1] - seen[0]) * 1000 if len(seen) > 1 else 0.0
    return rate, float(told.split("ms")[0].split()[-1])


def _change(page: Any, pid: int, changes: int) -> tuple[float, ...]:
    """Memory after each quarter of so many scene changes: other objects and other poses in turn."""
    found: list[float] = []
    for number in range(1, changes + 1):
        before = page.url
        page.get_by_role("button", name="Another object" if number % 4 == 1 else "Another pose").click()
        page.wait_for_timeout(50)
        page.wait_for_function("!document.querySelector('.gw-facts .gw-spin')", timeout=120_000)
        if page.url == before:
            page.wait_for_timeout(150)  # one that rests in one way only
        if number % max(changes // 4, 1) == 0 and len(found) < 4:
            found.append(memory_mb(pid))
    return tuple(found)
