"""Dragging an object with the gizmo: the plan follows; settling it in DART."""

import re

from workbench.benchmark import HANDLE, PLAN


def drag(page, offset, dx, dy, steps=40):
    raw = page.raw
    x, y = raw.evaluate(HANDLE, offset)
    raw.mouse.move(x, y)
    raw.wait_for_timeout(400)
    raw.mouse.down()
    for step in range(1, steps + 1):
        raw.mouse.move(x + dx * step / steps, y + dy * step / steps)
        raw.wait_for_timeout(30)


def test_image_scores_and_candidates_follow_a_drag(page):
    raw = page.raw
    page.raw.wait_for_timeout(1500)
    raw.evaluate(
        "() => { window.seen = new Set(); window.look = setInterval(() => { const i ="
        " document.querySelector('.gw-depth-image'); if (i) window.seen.add(i.getAttribute('href')); }, 5); }"
    )
    start, link = page.node("/inspect/objects/0"), raw.url
    drag(page, [0.09, 0, 0], -60, 25)
    raw.wait_for_selector("[data-live]")
    assert re.search(r"\d+ ms behind", raw.locator("[data-live]").inner_text())
    raw.mouse.up()
    page.settled()
    page.until("l => location.href !== l", link)
    end = page.node("/inspect/objects/0")
    assert abs(end[0] - start[0]) > 0.01 and abs(end[2] - start[2]) < 0.002, "it slid along the table"
    assert raw.evaluate("clearInterval(window.look), window.seen.size") >= 3, "the depth image followed"
    assert "at=" in raw.url and "loose" not in raw.url
    page.rows().first.click()
    page.tried()


def test_what_lies_on_its_side_slides_along_the_table_and_keeps_its_pose(browser_page):
    page = browser_page().open("&object=bottle_003&pose=1")
    raw = page.raw
    raw.wait_for_timeout(1500)
    rests = re.search(r"pose \d+/\d+", raw.locator(".gw-facts").inner_text())[0]
    for offset in ([0.09, 0, 0], [0, 0.09, 0]):
        start, link = page.node("/inspect/objects/0"), raw.url
        (u, v), (x, y) = raw.evaluate(HANDLE, [0, 0, 0]), raw.evaluate(HANDLE, offset)
        drag(page, offset, 0.6 * (x - u), 0.6 * (y - v))
        raw.mouse.up()
        page.settled()
        page.until("l => location.href !== l", link)
        end = page.node("/inspect/objects/0")
        assert abs(end[2] - start[2]) < 0.001 and max(abs(end[0] - start[0]), abs(end[1] - start[1])) > 0.01
    assert rests in raw.locator(".gw-facts").inner_text() and "loose" not in raw.url


def test_without_a_gpu_the_scene_is_drawn_coarser_while_it_moves(browser_page, workbench):
    page = browser_page()
    raw = page.raw
    raw.goto(workbench.url)
    raw.wait_for_selector(PLAN)
    raw.wait_for_timeout(1500)
    share = "(() => { const c = document.querySelector('canvas[data-engine]'); return c.width / c.clientWidth })()"
    drag(page, [0.09, 0, 0], -30, 12)
    page.until(f"{share} < 0.5")
    raw.mouse.up()
    page.until(f"{share} === 1")


def test_a_lifted_object_is_settled_before_it_is_tried(page):
    raw = page.raw
    page.button("Move freely").click()
    raw.wait_for_selector("button[aria-pressed=true]:text('Move freely')")
    raw.wait_for_timeout(1000)
    drag(page, [0, 0, 0.09], 0, -60, steps=15)
    raw.mouse.up()
    page.until("document.querySelector('.gw-facts').innerText.includes('not at rest')")
    high = page.node("/inspect/objects/0")[2]
    page.rows().first.click()
    raw.get_by_text("The object is not at rest").first.wait_for()
    page.button("Settle in DART").click()
    page.until("!document.querySelector('.gw-facts').innerText.includes('not at rest')")
    page.settled()
    assert page.node("/inspect/objects/0")[2] < high - 0.005, "it fell onto the table"
    page.rows().first.click()
    page.tried()
