import html
import re

import pytest

from workbench.page import asset, run, style


def test_the_style_sheet_is_there():
    assert style().startswith("<style>") and ".gw-list" in style()


@pytest.mark.parametrize(("name", "defines"), [("page.js", ("gwSend", "gwAt", "gwHeld")), ("pace.js", ("gwPace",))])
def test_the_scripts_define_what_html_calls(name, defines):
    script = asset(name)
    assert all(f"window.{function} = " in script for function in defines)


def test_scripts_and_their_data_are_escaped_and_leave_nothing_behind():
    page = run("go(\"<b>\", 'x')\n// done\n", query='"><script>', place="here")
    assert "<b>" not in page and "<script>" not in page and page.count("<") == 1
    told = dict(re.findall(r'([a-z-]+)="([^"]*)"', page))
    assert html.unescape(told["data-query"]) == '"><script>' and told["data-place"] == "here"
    assert html.unescape(told["onerror"]) == "go(\"<b>\", 'x')\n// done\n;this.remove()"
