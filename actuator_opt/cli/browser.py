"""The browser of this desktop."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import webbrowser


def graphical_browser() -> webbrowser.BaseBrowser | None:
    """The browser of this desktop; None without one, and for a text browser.

    A text browser would take the terminal.
    """
    import webbrowser

    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return None
    return None if type(browser) is webbrowser.GenericBrowser else browser
