"""Contents of files as digests: pytest would compare two PDF files line by line for minutes."""

from __future__ import annotations

import hashlib
from pathlib import Path


def digest(path: str | Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def digests(folder: str | Path) -> dict[str, str]:
    """Digest of every file in a folder, by name."""
    return {path.name: digest(path) for path in sorted(Path(folder).iterdir()) if path.is_file()}
