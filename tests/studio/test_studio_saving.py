"""Files of the studio: plain names only, beside the design, never over a file unasked."""

from __future__ import annotations

import hashlib
import os
import stat

import pytest

from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.studio import saving
from actuator_opt.studio.saving import digest, require_name, save_text


def sha(text):
    """SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


@pytest.mark.parametrize("name", ["a.yaml", "knee_2.studio.yaml", "-.yaml", "K" * 80 + ".yaml"])
def test_plain_names_are_taken(name):
    """Letters, digits, and the three signs."""
    assert require_name(name) == name


@pytest.mark.parametrize(
    "name",
    [
        "", ".yaml", "..yaml", "../a.yaml", "a/b.yaml", "/etc/a.yaml", "a\\b.yaml", "C:a.yaml",
        "a.yml", "a.yaml\n", "a.yaml.py", "a b.yaml", "ä.yaml", "a\0.yaml", "K" * 81 + ".yaml",
        "~.yaml", "%2e.yaml", None, 3, ["a.yaml"],
    ],
)  # fmt: skip
def test_all_other_names_are_refused(name, tmp_path):
    """No folder, drive, other suffix, control or foreign letter."""
    with pytest.raises(UsageError):
        save_text(tmp_path, name, "x")
    assert not os.listdir(tmp_path)


def test_a_new_file_is_written_whole_with_usual_permissions(tmp_path):
    """Nothing else stays in the folder."""
    saved = save_text(tmp_path, "a.yaml", "µ: 1\n")
    assert (saved.written, saved.sha256) == (True, sha("µ: 1\n"))
    assert (tmp_path / "a.yaml").read_text("utf-8") == "µ: 1\n"
    assert os.listdir(tmp_path) == ["a.yaml"]
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE((tmp_path / "a.yaml").stat().st_mode) == 0o666 & ~mask


def test_an_existing_file_needs_its_hash(tmp_path):
    """Without the hash, or with an old one, the file stays; with it, it is replaced."""
    (tmp_path / "a.yaml").write_text("mine\n")
    for replacing in (None, sha("older\n")):
        saved = save_text(tmp_path, "a.yaml", "new\n", replacing)
        assert (saved.written, saved.sha256) == (False, sha("mine\n"))
        assert (tmp_path / "a.yaml").read_text() == "mine\n"
    assert save_text(tmp_path, "a.yaml", "new\n", sha("mine\n")).written
    assert (tmp_path / "a.yaml").read_text() == "new\n"
    assert os.listdir(tmp_path) == ["a.yaml"]


def test_a_file_made_at_the_last_moment_stays(tmp_path, monkeypatch):
    """The look at the folder is too early; the name is still taken by nobody else's file."""
    (tmp_path / "a.yaml").write_text("mine\n")
    monkeypatch.setattr(saving.os.path, "lexists", lambda path: False)
    saved = save_text(tmp_path, "a.yaml", "new\n")
    assert (saved.written, saved.sha256) == (False, sha("mine\n"))
    assert os.listdir(tmp_path) == ["a.yaml"]


def test_links_and_folders_are_not_followed(tmp_path):
    """A link, even with the hash of its target, leads nowhere; neither does a dead link."""
    inside, target = tmp_path / "inside", tmp_path / "secret.yaml"
    inside.mkdir()
    target.write_text("secret\n")
    (inside / "a.yaml").symlink_to(target)
    (inside / "dead.yaml").symlink_to(tmp_path / "made.yaml")
    (inside / "folder.yaml").mkdir()
    os.mkfifo(inside / "pipe.yaml")
    for name in ("a.yaml", "dead.yaml", "folder.yaml", "pipe.yaml"):
        for replacing in (None, sha("secret\n")):
            with pytest.raises(InputError):
                save_text(inside, name, "new\n", replacing)
    assert target.read_text() == "secret\n"
    assert not (tmp_path / "made.yaml").exists()
    assert len(os.listdir(inside)) == 4


def test_a_huge_file_is_no_design(tmp_path, monkeypatch):
    """It is not read into memory."""
    monkeypatch.setattr(saving, "LARGEST", 3)
    (tmp_path / "a.yaml").write_text("four")
    with pytest.raises(InputError, match="too large"):
        digest(tmp_path / "a.yaml")


def test_a_full_disk_leaves_no_part(tmp_path, monkeypatch):
    """The fault is one line."""

    def full(file):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(saving.files, "publish", full)
    with pytest.raises(InputError, match="No space left"):
        save_text(tmp_path, "a.yaml", "x")
    assert not os.listdir(tmp_path)
