"""Trials in DART: replay, compare, all candidates, a replay as one file, verdicts."""

from grasp_core.dataset.store import DatasetStore

HEIGHT = "window.__viserMutable.nodeRefFromName['/inspect/gripper/base'].position.z"
CAMERA = "window.__viserMutable.camera.position.toArray()"


def test_from_a_click_to_a_stored_verdict(page, workbench):
    raw = page.raw
    raw.locator("svg.gw-depth g.gw-c0-0 polygon").click(force=True)
    page.tried()
    outcome = raw.locator("[data-outcome]").get_attribute("data-outcome")
    assert outcome in {"SUCCESS", "COLLISION", "MISSED", "SLIPPED"}
    assert len(raw.locator("[data-words]").inner_text()) > 10 and raw.locator(".gw-try").count() == 5
    assert "predicted" in raw.locator(".gw-tries").inner_text()

    raw.wait_for_selector("[data-playing=false]")
    slider = page.row("Time s").get_by_role("slider")
    end = float(slider.get_attribute("aria-valuenow"))
    assert end > 0.2, "the replay ran to its end"
    lifted = raw.evaluate(HEIGHT)
    slider.focus()
    slider.press("Home")
    page.until(f"Math.abs({HEIGHT} - {lifted}) > 0.01")
    start, camera = raw.evaluate(HEIGHT), raw.evaluate(CAMERA)
    for _ in range(10):
        slider.press("ArrowRight", delay=20)
    page.until(f"{HEIGHT} < {start} - 0.005")  # on the way down to the grasp
    assert raw.evaluate(CAMERA) == camera, "the arrows are the slider's while it has the focus"
    at = raw.evaluate(HEIGHT)
    page.button("one frame on (M)").click()
    page.until(f"Math.abs({HEIGHT} - {at}) > 1e-4")
    raw.get_by_label("speed").select_option("4")
    page.button("loop").click()
    page.button("▶ Play").click()
    raw.wait_for_selector("[data-playing=true]")
    raw.wait_for_timeout(1500)
    assert raw.locator("[data-playing=true]").count() == 1, "it starts over"
    page.button("loop").click()
    page.until(f"Math.abs({HEIGHT} - {lifted}) < 1e-3")

    page.button("✓ Good grasp").click()
    raw.wait_for_selector("[data-stored=good]")
    with DatasetStore.open(workbench.dataset, readonly=True) as store:
        event = store.events()[-1]
        assert (event.kind, event.value, event.source) == ("value", 1.0, "human")
        attempts = store.attempts(event.grasp)
        assert len(attempts) == 5 and attempts[0].outcome == outcome


def test_two_attempts_are_compared(page):
    raw = page.raw
    page.rows().nth(0).click()
    page.tried()
    page.button("Pin as A").click()
    raw.wait_for_selector("[data-compare]")
    page.rows().nth(1).click()
    raw.wait_for_selector("[data-compare] div:nth-child(2) .gw-badge")
    assert raw.locator("[data-compare] h4").count() == 2
    assert raw.evaluate("window.__viserMutable.nodeRefFromName['/inspect/compared/gripper/base'].visible")


def test_all_candidates_are_tried_and_the_job_is_cancelled(page):
    raw = page.raw
    count = page.rows().count()
    assert count > 2
    page.button("Try all in DART").click()
    raw.wait_for_selector("[data-done]")
    page.until("document.querySelector('.gw-list td:nth-child(7) span')")
    # The button is drawn anew with every candidate: it is clicked where it stands.
    x, y = raw.evaluate(
        "(box => [box.x + box.width / 2, box.y + box.height / 2])"
        "(document.querySelector(\"button[title='stop trying']\").getBoundingClientRect())"
    )
    raw.mouse.click(x, y)
    raw.wait_for_selector("[data-done]", state="detached")
    raw.wait_for_timeout(2500)
    done = raw.locator(".gw-list td:nth-child(7) span").count()
    assert 1 <= done < count, "what was tried stays, the others are left"
    assert raw.locator("button[aria-pressed=true]:text('DART')").count() == 1, "coloured by what physics said"


def test_a_replay_is_one_file_that_opens_in_another_page(page, tmp_path):
    page.rows().nth(0).click()
    page.tried()
    with page.raw.expect_download() as download:
        page.button("Save as HTML").click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    assert path.name.endswith(".html") and path.stat().st_size > 100_000
    other = page.raw.context.new_page()
    requests = []
    other.on("request", lambda request: requests.append(request.url))
    other.goto(path.as_uri())
    other.wait_for_selector("canvas[data-engine]", timeout=90_000)
    assert other.get_by_text("attempt 1").count() >= 1
    assert not [url for url in requests if url.startswith("http")], "it needs nobody"
    other.close()


def test_noise_is_a_setting_of_trials(page):
    raw = page.raw
    page.tab("Settings")
    for label in ("σ_p mm", "σ_φ °"):
        page.row(label).locator("input:not([type=hidden])").first.fill("0")
        page.row(label).locator("input:not([type=hidden])").first.press("Enter")
    page.until("location.search.includes('sigma_phi=0') && location.search.includes('sigma_p=0')")
    page.tab("Grasps")
    page.rows().nth(0).click()
    page.tried()
    outcomes = set(raw.locator(".gw-try").evaluate_all("all => all.map(e => e.title.split(': ')[1])"))
    assert len(outcomes) == 1, "without noise all attempts are one"


def test_hotkeys_go_through_the_candidates(page):
    page.raw.mouse.click(640, 60)  # empty scene: the keys are for the page
    page.raw.keyboard.press("j")
    page.until("document.querySelector('[data-trial]').innerText.includes('andidate 2')")
    page.raw.keyboard.press("k")
    page.until("document.querySelector('[data-trial]').innerText.includes('andidate 1')")
