import re

from workbench.inspector.setup import DEFAULT
from workbench.inspector.worker.pages import replay_page


def test_a_replay_is_one_page_with_everything_inside(opened, attempt):
    page = replay_page(opened.scene, DEFAULT, attempt(0, "SLIPPED"), "box <script>alert(1)</script>").decode()
    assert page.lstrip().lower().startswith("<!doctype html") and "__VISER_EMBED_DATA__" in page
    assert "SLIPPED: held to the end" in page
    assert "<script>alert(1)" not in page, "names are escaped"
    head = page[: page.index("<body>")]
    assert head.count("<title>box &lt;script&gt;") == head.count("</title>") == 1
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=[\"']https?:", page), "nothing is fetched"
