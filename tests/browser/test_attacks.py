"""What a hostile page, a forged message or a dying worker can do: nothing but be reported."""

import http.server
import os
import signal
import threading
import time
from pathlib import Path

import pytest

SEND = "message => window.__viserMutable.sendMessage(message)"


@pytest.fixture
def hostile():
    """Another web site on this machine."""

    class Site(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<h1>Win a prize</h1>")

        def log_message(self, *args):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Site)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()


def test_a_page_of_another_origin_gets_no_socket_and_no_frame(browser_page, workbench, hostile):
    page = browser_page().raw
    page.goto(hostile)
    address = workbench.url.replace("http", "ws")
    ended = page.evaluate(
        "address => new Promise(done => { const s = new WebSocket(address, ['viser-v1.1.1']);"
        " s.onopen = () => done('open'); s.onerror = () => done('refused'); })",
        address,
    )
    assert ended == "refused"
    frame = "u => { const f = document.createElement('iframe'); f.src = u; document.body.append(f) }"
    page.evaluate(frame, workbench.url)
    page.wait_for_timeout(1500)
    assert page.frames[-1].evaluate("document.querySelector('#root') === null")


def uuid(page, label):
    found = page.raw.get_by_text(label, exact=True).locator("xpath=ancestor-or-self::label").first
    return found.get_attribute("for")


def test_forged_widget_values_are_refused_and_harm_nobody(page, browser_page):
    other = browser_page().open()
    page.tab("Settings")
    for label, value in (("t least", 99.0), ("Planner", "rm -rf"), ("Tilt °", "a"), ("σ_p mm", -5.0)):
        page.raw.evaluate(SEND, {"type": "GuiUpdateMessage", "uuid": uuid(page, label), "updates": {"value": value}})
    page.raw.get_by_text("That did not work").first.wait_for()
    for message in ("launch:1:1", "select:<b>:1", "x" * 10_000):
        box = page.raw.evaluate("document.querySelector('div:has(> div > div > p > label) label').htmlFor")
        page.raw.evaluate(SEND, {"type": "GuiUpdateMessage", "uuid": box, "updates": {"value": message}})
    page.raw.wait_for_timeout(500)
    for one in (page, other):
        one.tab("Grasps")
        assert one.rows().count() >= 1
        one.button("Another pose").click()
        one.settled()
        assert "threshold" not in one.raw.url


def test_a_killed_worker_is_reported_and_replaced(page, workbench):
    mine = [pid for pid in children(workbench.process.pid) if "spawn_main" in Path(f"/proc/{pid}/cmdline").read_text()]
    assert len(mine) >= 2, "planning and physics"
    for pid in mine:
        os.kill(pid, signal.SIGKILL)
    page.rows().nth(1).click()
    page.raw.get_by_text("Worker replaced").first.wait_for()
    deadline = time.monotonic() + 60
    while page.raw.locator("[data-outcome]").count() == 0 and time.monotonic() < deadline:
        page.rows().nth(1).click()
        page.raw.wait_for_timeout(3000)
    page.tried()
    page.button("Another pose").click()
    page.settled()
    assert page.raw.locator(".gw-facts .gw-error").count() == 0


def children(pid):
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if int(fields[1]) == pid:
                found.append(int(entry.name))
    return found
