"""A disk that is full: files that `store` opens take half of what is written, then fail."""

from __future__ import annotations

import io

import pytest

from actuator_opt.base import files as store


class _Full(io.FileIO):
    """Takes half of the bytes, then says ENOSPC."""

    def write(self, data: bytes) -> int:
        super().write(data[: len(data) // 2])
        raise OSError(28, "No space left on device")


def fill(monkeypatch: pytest.MonkeyPatch, *, after: int = 0) -> list[int]:
    """Make the disk full after so many files; the list counts those opened."""
    opened: list[int] = []

    def limited(file: int, mode: str, *, closefd: bool) -> io.FileIO:
        opened.append(file)
        return (io.FileIO if len(opened) <= after else _Full)(file, mode, closefd=closefd)

    monkeypatch.setattr(store, "open", limited, raising=False)
    return opened
