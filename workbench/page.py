"""This app's own files for the page, and how JavaScript is run there."""

from __future__ import annotations

from importlib import resources

from workbench.casting import text


def asset(name: str) -> str:
    """A text file of `workbench/assets`."""
    return (resources.files("workbench") / "assets" / name).read_text()


def style() -> str:
    """The style sheet of everything that this app shows, as HTML."""
    return f"<style>{asset('workbench.css')}</style>"


def run(script: str, **data: str) -> str:
    """HTML that runs JavaScript once it is put on the page, where viser leaves script elements alone.

    Args:
        script: made by this app.
        data: texts that it finds in `this.dataset`.
    """
    more = "".join(f' data-{name}="{text(value)}"' for name, value in data.items())
    return f'<img src="data:,"{more} onerror="{text(script)};this.remove()" hidden>'
