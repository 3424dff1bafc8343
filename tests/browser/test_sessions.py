"""Links, what a browser keeps, reloads, and browsers beside each other."""

import msgspec

from workbench.inspector.setup import DEFAULT


def test_a_link_restores_scene_settings_and_selection(browser_page):
    first = browser_page().open("&object=mug_003&place=5&threshold=0.3&planner=antipodal")
    first.rows().nth(1).click()
    first.tried()
    first.until("location.search.includes('select=0.1')")
    second = browser_page()
    second.raw.goto(first.raw.url)
    second.raw.wait_for_selector("svg.gw-depth g[data-candidate]")
    assert second.rows().all_inner_texts()[0].split()[1] == first.rows().all_inner_texts()[0].split()[1]
    assert "mug_003" in second.raw.locator(".gw-facts").inner_text()
    assert "candidate 2" in second.raw.locator("[data-trial]").inner_text()
    second.tab("Settings")
    assert second.row("t least").locator("input").first.input_value() == "0.3"
    assert msgspec.structs.replace(DEFAULT).threshold != 0.3


def test_the_bad_part_of_a_link_is_told_and_the_rest_followed(browser_page):
    page = browser_page().open("&object=mug_003&threshold=<script>alert(1)</script>")
    page.raw.get_by_text("A part of this link was left out").first.wait_for()
    page.settled()
    assert "object=mug_003" in page.raw.url and "script" not in page.raw.url


def test_a_browser_keeps_its_settings_and_theme(page):
    raw = page.raw
    raw.mouse.click(640, 60)  # empty scene: the keys are for the page
    raw.keyboard.press("l")
    raw.wait_for_selector(".gw-theme[data-theme=light]", state="attached")
    page.button("frames").click()
    raw.wait_for_selector("[data-layer=frames][aria-pressed=true]")
    raw.wait_for_timeout(500)
    raw.evaluate("for (const k of Object.keys(localStorage)) if (k.includes('session')) localStorage.removeItem(k)")
    page.open()
    raw.wait_for_selector(".gw-theme[data-theme=light]", state="attached")
    raw.wait_for_selector("[data-layer=frames][aria-pressed=true]")


def test_a_reload_in_the_middle_of_a_trial_finds_it(page):
    page.rows().nth(1).click()
    page.raw.wait_for_selector("[data-trial] .gw-spin, [data-outcome]")
    facts = page.raw.locator(".gw-facts").inner_text()
    page.raw.reload()
    page.tried()
    assert page.raw.locator(".gw-facts").inner_text() == facts
    assert "candidate 2" in page.raw.locator("[data-trial]").inner_text()


def test_a_page_says_that_its_workbench_was_stopped_and_comes_back_with_the_next(browser_page, start):
    told = "getComputedStyle(document.body, '::after')"
    page = browser_page()
    with start() as first:
        page.url = first.url
        page.open("&object=mug_003&place=5")
        rows = page.rows().all_inner_texts()
        assert page.raw.evaluate(f"{told}.content") == "none"
    page.until(f"{told}.content.includes('does not answer') && {told}.opacity === '1'")
    page.raw.evaluate("document.querySelectorAll('tr[data-candidate]').forEach(row => row.remove())")
    with start(int(first.url.rstrip("/").rsplit(":", 1)[1])):
        page.until(f"{told}.content === 'none'")
        page.raw.wait_for_selector("tr[data-candidate]")
        page.settled()
        assert page.rows().all_inner_texts() == rows


def test_two_browsers_are_independent(page, browser_page):
    other = browser_page().open()
    other.button("Random").click()
    other.until("!location.search.includes('toy_plane_000')")
    other.settled()
    assert "toy_plane_000" in page.raw.url and "toy_plane_000" in page.raw.locator(".gw-facts").inner_text()
    page.rows().first.click()
    page.tried()
    assert other.raw.locator("[data-outcome]").count() == 0


def test_every_hotkey_is_listed(page):
    page.raw.mouse.click(640, 60)  # empty scene: the keys are for the page
    page.raw.keyboard.press("h")
    page.raw.wait_for_selector(".gw-keylist")
    assert page.raw.locator(".gw-keylist kbd").count() > 15
    page.button("Close").click()
    page.raw.wait_for_selector(".gw-keylist", state="detached")
    page.raw.keyboard.press("h")
    page.raw.wait_for_selector(".gw-keylist")
    page.raw.wait_for_timeout(500)
    page.raw.keyboard.press("Escape")
    page.raw.wait_for_selector(".gw-keylist", state="detached")
    page.raw.keyboard.press("Control+k")
    page.raw.get_by_text("Settle in DART").last.wait_for()
