"""Headless Chromium for the browser tests, and a workbench with a dataset of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import threading
from types import SimpleNamespace

import pytest

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
START = 60
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
        browser = playwright.chromium.launch(executable_path=executable, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def workbench(chromium, tmp_path_factory):
    """`grasp-workbench` as a user starts it: its address and its dataset's folder."""
    dataset = tmp_path_factory.mktemp("browser") / "own"
    command = [sys.executable, "-m", "workbench.cli", "--port", "0", "--no-open", "--dataset", str(dataset)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        killer = threading.Timer(START, process.kill)
        killer.start()
        line = process.stdout.readline()
        killer.cancel()
        assert "http://127.0.0.1:" in line, f"no address printed: {line!r}"
        yield SimpleNamespace(url=line.split()[-1], dataset=dataset, process=process)
        process.terminate()
        process.wait(20)


@pytest.fixture
def page(chromium, workbench):
    """A new browser (its own storage) on the workbench, with the first plan on screen."""
    context = chromium.new_context(viewport={"width": 1440, "height": 900})
    opened = context.new_page()
    opened.errors = []
    opened.on("pageerror", lambda error: opened.errors.append(str(error)))
    opened.goto(f"{workbench.url}?fixedDpr=1")
    opened.wait_for_selector("svg.gw-depth g[data-candidate]", timeout=90_000)
    yield opened
    assert opened.errors == [], "scripts of the page failed"
    context.close()
