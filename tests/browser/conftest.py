"""Headless Chromium for the browser tests, and a workbench with a dataset of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import threading
from contextlib import contextmanager
from types import SimpleNamespace

import pytest

from workbench.benchmark import FLAGS, PLAN

START = 240
"""Seconds that the workbench may take to print its address on a busy machine."""


def missing(what: str) -> None:
    """Skip, saying why; fail instead where the browser is required."""
    told = f"browser tests need {what}"
    if os.environ.get("GRASP_REQUIRE_BROWSER") == "1":
        pytest.fail(f"{told}, and GRASP_REQUIRE_BROWSER=1 requires them")
    pytest.skip(told)


def pytest_collection_modifyitems(items):
    """Everything in this folder is a browser test."""
    for item in items:
        if "tests/browser/" in str(item.path).replace(os.sep, "/"):
            item.add_marker(pytest.mark.browser)


@pytest.fixture(scope="module")
def chromium():
    """A running headless Chromium, ended with its module: playwright keeps an event loop running in this thread."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        missing("the package playwright (extra `test`)")
    executable = next((path for name in ("chromium", "chromium-browser") if (path := shutil.which(name))), None)
    if executable is None:
        missing("Chromium (on Debian: apt-get install chromium)")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        yield browser
        browser.close()


@contextmanager
def started(dataset, port=0):
    """`grasp-workbench` as a user starts it: its address and its dataset's folder; stopped on the way out."""
    command = [sys.executable, "-m", "workbench.cli", "--port", str(port), "--no-open", "--dataset", str(dataset)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        killer = threading.Timer(START, process.kill)
        killer.start()
        line = process.stdout.readline()
        killer.cancel()
        assert "http://127.0.0.1:" in line, f"no address printed: {line!r}"
        yield SimpleNamespace(url=line.split()[-1], dataset=dataset, process=process)
        process.terminate()
        process.wait(20)


@pytest.fixture(scope="module")
def workbench(chromium, tmp_path_factory):
    """The workbench of a module's tests."""
    with started(tmp_path_factory.mktemp("browser") / "own") as found:
        yield found


@pytest.fixture
def start(tmp_path):
    """Starts another workbench on a port, to be entered with `with`."""
    return lambda port=0: started(tmp_path / "own", port)


WAIT = 90_000
"""Milliseconds that anything may take on a busy machine without a GPU."""


class Page:
    """One page on the workbench, and what the tests do with it again and again."""

    def __init__(self, page, url):
        self.raw = page
        self.url = url
        self.errors = []
        page.set_default_timeout(WAIT)
        page.on("pageerror", lambda error: self.errors.append(str(error)))

    def open(self, query=""):
        """Load the workbench and wait for its plan."""
        self.raw.goto(f"{self.url}?fixedDpr=1{query}")
        self.raw.wait_for_selector(PLAN, timeout=WAIT)
        return self

    def settled(self):
        """Wait until nothing is being made."""
        self.raw.wait_for_timeout(150)
        self.raw.wait_for_function("!document.querySelector('.gw-facts .gw-spin')", timeout=WAIT)

    def tried(self):
        """Wait until the trial of the selected candidate is complete."""
        self.raw.wait_for_selector("[data-outcome]", timeout=WAIT)
        self.raw.wait_for_selector("[data-successes]", timeout=WAIT)

    def button(self, name):
        return self.raw.get_by_role("button", name=name, exact=True)

    def tab(self, name):
        self.raw.get_by_role("tab", name=name).click()

    def until(self, condition, arg=None):
        return self.raw.wait_for_function(condition, arg=arg, timeout=WAIT)

    def row(self, label):
        """The row of a widget of viser's."""
        found = self.raw.get_by_text(label, exact=True)
        return found.locator("xpath=ancestor::div[contains(@class,'Flex-root')][1]")

    def choose(self, label, option):
        """Pick an option of a dropdown."""
        self.row(label).locator("input").first.click()
        self.raw.get_by_role("option", name=option, exact=True).click()

    def rows(self):
        return self.raw.locator(".gw-list tr[data-candidate]")

    def node(self, name):
        """Where a scene node stands."""
        return self.raw.evaluate(
            "n => { const p = window.__viserMutable.nodeRefFromName[n].position; return [p.x, p.y, p.z] }", name
        )


@pytest.fixture
def browser_page(chromium, workbench):
    """Makes pages in browsers of their own (each with its own storage)."""
    contexts, pages = [], []

    def make(width=1280, height=720):
        contexts.append(chromium.new_context(viewport={"width": width, "height": height}, accept_downloads=True))
        pages.append(Page(contexts[-1].new_page(), workbench.url))
        return pages[-1]

    yield make
    errors = [error for page in pages for error in page.errors]
    for context in contexts:
        context.close()
    assert errors == [], "scripts of the page failed"


@pytest.fixture
def page(browser_page):
    """A new browser with the first plan on screen."""
    return browser_page().open()
