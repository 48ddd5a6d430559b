"""Syntax trees of the whole package are hundreds of megabytes: they go after their last test."""

from cases.sources import parsed


def pytest_runtest_teardown(item, nextitem):
    """Forget them when the next test is of another folder."""
    if nextitem is None or nextitem.path.parent != item.path.parent:
        parsed.cache_clear()
