"""Stored programs: equal after reading, and harmless when damaged, missing or not writable."""

from __future__ import annotations

import json
import zlib

import numpy as np
import pytest

from actuator_opt.base.numeric import STEP
from actuator_opt.base.symbolic import program as programs, program_store as store
from actuator_opt.base.symbolic.recorded import RecordedFunction

pytestmark = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
POINT = np.array([0.3, 2.0])


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """An empty folder of stored programs, and an empty memory."""
    monkeypatch.setenv(store.FOLDER, str(tmp_path / "programs"))
    monkeypatch.setattr(store, "_KNOWN", {})
    return tmp_path / "programs"


def function(x):
    """A function with a guard, a constant and a root."""
    assert bool(np.all(x[0] > -1e9))
    return np.stack([x[0] * x[1] + 0.1, np.sqrt(x[1])])


def used(structure="s"):
    """A recorded function of this structure, and whether it was recorded anew."""
    before = store._KNOWN.copy()
    store._KNOWN.clear()
    made = RecordedFunction(function, ["a", "b"], POINT, structure)
    traced, new = made._traced, []
    made._traced = lambda point: new.append(1) or traced(point)
    results = made(POINT[:, None] + 1j * STEP * np.eye(2))
    store._KNOWN.update(before)
    np.testing.assert_allclose(results.real[:, 0], [0.7, np.sqrt(2.0)], rtol=1e-15)
    np.testing.assert_allclose(results.imag / STEP, [[2.0, 0.3], [0, 0.5 / np.sqrt(2.0)]])
    return made, bool(new)


def test_a_later_run_reads_the_same_program(place):
    """All arrays are equal, the answers of guards included; another structure has its own file."""
    first, new = used()
    second, again = used()
    assert new
    assert not again
    assert len(list(place.iterdir())) == 1
    for name in ("code", "extra", "outputs", "frozen", "constants"):
        mine, theirs = (getattr(made.recording.program, name) for made in (first, second))
        np.testing.assert_array_equal(mine, theirs)
        assert mine.dtype == theirs.dtype
    np.testing.assert_array_equal(first.recording.answers, second.recording.answers)
    assert used("other")[1]
    assert len(list(place.iterdir())) == 2


def test_a_structure_that_says_too_little_is_noticed(place):
    """Another function of the same key does not use the stored program: its results differ."""
    made = RecordedFunction(lambda x: np.stack([x[0] - x[1], x[1]]), ["a", "b"], POINT, "s")
    made(POINT[:, None])
    assert used()[1]


@pytest.mark.parametrize("at", [0.0, 0.3, 0.6, 0.999])
def test_a_damaged_file_costs_a_recording(place, at):
    """One changed byte anywhere, or a file cut there."""
    used()
    (path,) = place.iterdir()
    data = bytearray(path.read_bytes())
    data[int(at * len(data))] ^= 0x41
    path.write_bytes(data)
    assert used()[1]
    path.write_bytes(data[: int(at * len(data))])
    assert used()[1]
    assert not used()[1]


def rewritten(path, change):
    """Change the head and the arrays of a stored program, with a fitting checksum."""
    head, _, body = path.read_bytes().partition(b"\n")
    head, raw = change(json.loads(head), zlib.decompress(body))
    body = zlib.compress(raw)
    head["checksum"] = store.hashlib.blake2b(body, digest_size=16).hexdigest()
    path.write_bytes(json.dumps(head).encode() + b"\n" + body)


@pytest.mark.parametrize(
    "change",
    [
        lambda head, raw: (head | {"slots": 10**9}, raw),
        lambda head, raw: (head | {"slots": True}, raw),
        lambda head, raw: (head | {"inputs": 0}, raw),
        lambda head, raw: (head | {"inputs": 3}, raw),
        lambda head, raw: (head | {"sizes": [-1, *head["sizes"][1:]]}, raw),
        lambda head, raw: (head | {"sizes": [10**15]}, raw),
        lambda head, raw: (head | {"sizes": "wide"}, raw),
        lambda head, raw: (head, raw + b"0" * 100_000_000),
        lambda head, raw: (head, b"\xff" * len(raw)),
        lambda head, raw: (head, raw[:2] + b"\xff\xff" + raw[4:]),
        lambda head, raw: ({"sizes": head["sizes"]}, raw),
    ],
)
def test_a_forged_file_is_refused(place, change):
    """Sizes, slots and text that a stranger chose: no crash, and a new recording."""
    used()
    (path,) = place.iterdir()
    rewritten(path, change)
    assert used()[1]


def test_a_huge_or_foreign_file_is_refused(place):
    """A file above the largest size, a folder and a text in its place."""
    used()
    (path,) = place.iterdir()
    path.write_bytes(b"{}" + b"\n" * 5_000_000)
    assert used()[1]
    path.write_text("[" * 100_000, encoding="ascii")
    assert used()[1]
    path.unlink()
    path.mkdir()
    assert used()[1]


def test_storing_can_be_switched_off(place, monkeypatch):
    """Nothing is written; each run records."""
    monkeypatch.setenv(store.FOLDER, "0")
    assert used()[1]
    assert used()[1]
    assert not place.exists()


def test_a_folder_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    """A file stands where the folder should be."""
    (tmp_path / "file").write_text("", encoding="ascii")
    monkeypatch.setenv(store.FOLDER, str(tmp_path / "file"))
    assert used()[1]
    monkeypatch.setenv(store.FOLDER, str(tmp_path / "file" / "below"))
    assert used()[1]


def test_the_least_recently_used_files_are_deleted(place, monkeypatch):
    """A folder contains at most its largest number of files."""
    monkeypatch.setattr(store, "MOST_FILES", 3)
    for structure in "abcde":
        used(structure)
        for age, path in enumerate(sorted(place.iterdir(), key=lambda p: p.stat().st_mtime)):
            stamp = 1_000_000 + 10 * age
            store.os.utime(path, (stamp, stamp))
    assert len(list(place.iterdir())) == 3
    assert not used("e")[1]
    assert used("a")[1]


def test_memory_serves_the_same_process(place):
    """A second function of the same structure does not read the file."""
    used("m")
    made = RecordedFunction(function, ["a", "b"], POINT, "m")
    made(POINT[:, None])
    for path in place.iterdir():
        path.unlink()
    again = RecordedFunction(function, ["a", "b"], POINT, "m")
    again(POINT[:, None])
    assert again.recording is made.recording
