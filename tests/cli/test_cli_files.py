"""Files, streams and signals: nothing half written, nothing lost, no traceback in any shell."""

from __future__ import annotations

import concurrent.futures
import hashlib
import os
import signal
import subprocess
import time

import pytest
from cases.digests import digests
from cli_runner import BENCH, bench, command, one_object, run, spawn, surroundings


@pytest.fixture
def design(tmp_path):
    """The bench design as a file."""
    path = tmp_path / "bench.yaml"
    path.write_text(BENCH)
    return path


def files(folder):
    """Names and contents of a folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_report_writes_pdf_and_pages(tmp_path):
    """The files named are the files there are, with their hashes; from stdin they bear its name."""
    out = tmp_path / "new" / "folder"
    result = run("report", "-", "--out", out, "--json", stdin=BENCH.encode())
    assert result.code == 0
    found = files(out)
    assert {row["path"] for row in result.json["files"]} == {str(out / name) for name in found}
    for row in result.json["files"]:
        content = found[os.path.basename(row["path"])]
        assert hashlib.sha256(content).hexdigest() == row["sha256"]
    assert found["test_bench.pdf"].startswith(b"%PDF")
    assert found["test_bench.png"].startswith(b"\x89PNG")


@pytest.mark.long
def test_same_input_same_bytes(design, tmp_path, monkeypatch):
    """Two runs write the same bytes, whatever the clock, the hash seed and the folder's content."""
    monkeypatch.chdir(tmp_path)
    written = []
    for seed in ("1", "7"):
        done = spawn("report", design.name, "--out", "out", environment={"PYTHONHASHSEED": seed})
        assert done.returncode == 0
        written.append(digests(tmp_path / "out"))
    assert len(written[0]) == 2
    assert written[0] == written[1]


def test_dates(design, tmp_path, monkeypatch):
    """A date is printed when asked for, by option or SOURCE_DATE_EPOCH; others are refused."""
    monkeypatch.chdir(tmp_path)

    def pdf(*words, **environment):
        result = run("report", design, "--out", "out", *words, environment=environment)
        assert result.code == 0, result.err
        return (tmp_path / "out" / "bench.pdf").read_bytes()

    undated = pdf()
    assert pdf("--date", "2023-11-14") != undated
    assert pdf(SOURCE_DATE_EPOCH="1700000000") != undated  # 2023-11-14T22:13:20Z
    for wrong in ("1e9", "-1", "9" * 17, "²", "yesterday"):
        result = run("report", design, "--json", environment={"SOURCE_DATE_EPOCH": wrong})
        assert result.code == 2
        assert "SOURCE_DATE_EPOCH" in result.errors[0]["message"]
    for wrong in ("2024-02-30", "14.11.2023", "2023-W46-2", "20231114", ""):
        assert run("report", design, "--date", wrong).code == 2


@pytest.mark.parametrize("verb", ["report", "optimise"])
def test_places_that_cannot_be_written(verb, design, tmp_path):
    """A file in the way of a folder, or a folder of a file, is told before the work."""
    blocked = tmp_path / "blocked"
    blocked.write_text("mine")
    report = ("--report",) if verb == "optimise" else ()
    for out in (blocked, blocked / "below", "/dev/null"):
        result = run(verb, design, "--out", out, "--json", *report)
        assert result.code == 3
        assert result.errors[0]["file"] == str(out)
    assert blocked.read_text() == "mine"


def test_a_folder_in_the_way_of_a_page(design, tmp_path):
    """Where one file of a report cannot be written, none of them is."""
    out = tmp_path / "out"
    (out / "bench.png").mkdir(parents=True)
    result = run("report", design, "--out", out)
    assert result.code == 3
    assert "Traceback" not in result.err
    assert files(out) == {}


@pytest.mark.parametrize("place", ["missing/best.yaml", ".", "file/best.yaml"])
def test_write_to_impossible_places(place, design, tmp_path, monkeypatch):
    """--write is checked before the search starts."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("mine")
    monkeypatch.setattr("actuator_opt.optimisation.run.solve", None)
    result = run("optimise", design, "--json", "--write", place)
    assert result.code == 3
    assert result.errors[0]["file"] == place


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder(design, tmp_path):
    """A folder without permission is told before the work."""
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    assert run("report", design, "--out", locked).code == 3
    assert run("optimise", design, "--write", locked / "x.yaml").code == 3


@pytest.mark.parametrize(
    "data",
    [b"", b"\n\n", b"# only a comment\n", b"\xff\xfe\x00", b"\x00", b"name: \xff\n", b"42", b"[]",
     b"name: x\n---\nname: y\n", b"\tname: x\n", b"name: 'x\n", b"a: &x 1\nb: *x\n", b"%PDF-1.7\n",
     b"a: b: c\n", b"{" * 100, b"- " * 2000, b"x" * 1_100_000, b"name: x\rname: y\r"],
    ids=lambda data: repr(data[:12]),
)  # fmt: skip
@pytest.mark.parametrize("verb", ["check", "evaluate"])
def test_what_is_no_design(verb, data):
    """Anything else on stdin is refused in lines of text, and as one JSON object."""
    plain = run(verb, "-", stdin=data)
    assert (plain.code, plain.out) == (3, "")
    assert plain.err.startswith("<stdin>")
    assert len(plain.err) < 30_000
    assert run(verb, "-", "--json", stdin=data).errors


def test_a_reader_who_leaves(design):
    """`| head -1` ends the printing; the exit status stays the command's own."""
    for words, code in (((), 0), (("--set", "requirements.mass.max=1 g"), 1)):
        with subprocess.Popen(
            command("evaluate", design, *words),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=surroundings(),
            text=True,
        ) as process:
            process.stdout.close()
            assert process.stderr.read() == ""
            assert process.wait(30) == code


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_and_a_closed_stream(design):
    """Data that cannot be printed is a fault with a line; a closed stream is nobody's fault."""
    words = command("evaluate", "nope", "--json")
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            words, stdout=full, stderr=subprocess.PIPE, env=surroundings(), text=True
        )
    assert done.returncode == 3
    assert "no such file" in done.stderr
    assert "No space left" in done.stderr
    assert "Traceback" not in done.stderr
    for words in (("evaluate", design, "--json"), ("--help",)):
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                command(*words), stdout=full, stderr=subprocess.PIPE, env=surroundings(), text=True
            )
        assert done.returncode == 3, words
        assert len(done.stderr.splitlines()) == 1
        assert "No space left" in done.stderr
    shell = 'exec "$@" >&- 2>&-'
    done = subprocess.run(
        ["sh", "-c", shell, "sh", *command("evaluate", design)], env=surroundings()
    )
    assert done.returncode == 0


def test_ascii_terminals(design):
    """Without Unicode every sign has its plain form; nothing fails."""
    text = bench(("name: test bench", "name: Knie α β 膝"))
    for words in (("evaluate", "-", "-v"), ("sensitivity", "-")):
        result = run(*words, stdin=text.encode(), encoding="ascii")
        assert result.code == 0
        assert result.out.isascii()
        assert "stiffness_min" in result.out
    assert run("evaluate", "-", "--json", stdin=text.encode()).out.isascii()
    done = spawn("evaluate", design, environment={"LC_ALL": "C", "PYTHONIOENCODING": "ascii"})
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.isascii()


@pytest.mark.parametrize("columns", ["1", "40", "60", "100", "200", "0", "wide"])
def test_widths(columns):
    """COLUMNS is kept to, down to what a table needs; a pipe has no colour."""
    result = run("evaluate", "-", stdin=BENCH.encode(), environment={"COLUMNS": columns})
    assert result.code == 0
    assert "\x1b" not in result.out
    longest = max(map(len, result.out.splitlines()))
    limit = int(columns) if columns.isdecimal() and int(columns) else 100
    assert longest <= max(limit, 70)


def pseudo_terminal(design, **environment):
    """What `evaluate` prints on a terminal of 90 columns."""
    import fcntl
    import pty
    import struct
    import termios

    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 90, 0, 0))
    process = subprocess.Popen(
        command("evaluate", design), stdout=slave, stderr=slave, env=surroundings(**environment)
    )
    os.close(slave)
    text = b""
    try:
        while part := os.read(master, 65536):
            text += part
    except OSError:
        pass
    os.close(master)
    assert process.wait(30) == 0
    return text.decode()


@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo-terminal")
def test_colour_on_terminals_only(design):
    """A terminal gets colour unless NO_COLOR is set, whatever it is set to."""
    assert "\x1b[" in pseudo_terminal(design, TERM="xterm")
    assert "\x1b[" not in pseudo_terminal(design, TERM="xterm", NO_COLOR="")


HARD = bench(("min: 6 kN/mm", "min: 600 kN/mm"))
"""Infeasible, so that the search takes a while."""


def _hears_interrupts():
    """A process started behind a shell's `&` ignores SIGINT, and its children with it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_an_interrupt(tmp_path):
    """Ctrl-C, in the search or before: exit 130, said in words, no file, as nothing fits yet."""
    design = tmp_path / "hard.yaml"
    design.write_text(HARD)
    out, best = tmp_path / "out", tmp_path / "best.yaml"
    process = subprocess.Popen(
        command("optimise", design, "--starts", "500", "--out", out, "--write", best),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=surroundings(),
        text=True,
        preexec_fn=_hears_interrupts,
    )
    time.sleep(0.8)
    process.send_signal(signal.SIGINT)
    shown, said = process.communicate(timeout=30)
    assert process.returncode == 130, (shown, said)
    assert "\nInterrupted before any design" in shown or (shown, said) == ("", "interrupted\n")
    assert "Traceback" not in said
    assert not out.exists()
    assert not best.exists()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs the pipes of Linux")
def test_an_interrupt_while_printing():
    """Ctrl-C in the middle of a long object: it is written whole, and the exit status is 130."""
    import fcntl
    import struct
    import termios

    process = subprocess.Popen(
        command("schema"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=surroundings(),
        preexec_fn=_hears_interrupts,
    )
    waiting, end = 0, time.monotonic() + 30
    while waiting < 1 << 16 and time.monotonic() < end:  # a pipe holds 64 KiB
        time.sleep(0.02)
        held = fcntl.ioctl(process.stdout, termios.FIONREAD, b"    ")
        (waiting,) = struct.unpack("i", held)
    process.send_signal(signal.SIGINT)
    time.sleep(0.2)
    shown, said = process.communicate(timeout=30)
    assert (process.returncode, said) == (130, b"interrupted\n")
    assert "properties" in one_object(shown.decode())


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_a_kill_leaves_whole_files_or_none(design, tmp_path):
    """However early a report is killed, every file under its own name is whole."""
    whole = tmp_path / "whole"
    assert run("report", design, "--out", whole).code == 0
    sizes = {name: len(content) for name, content in files(whole).items()}
    for delay in (0.5,):
        out = tmp_path / f"out{delay}"
        process = subprocess.Popen(
            command("report", design, "--out", out), stderr=subprocess.DEVNULL, env=surroundings()
        )
        time.sleep(delay)
        process.kill()
        process.wait(30)
        if out.exists():
            for name, content in files(out).items():
                if not name.startswith("."):
                    assert abs(len(content) - sizes[name]) < 200  # the command line differs


@pytest.mark.long
def test_runs_at_the_same_time(design, tmp_path):
    """Two reports into one folder at once: whole files, each run's exit status its own."""
    out = tmp_path / "out"
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        jobs = [pool.submit(spawn, "report", design, "--out", out) for _ in range(2)]
        done = [job.result() for job in jobs]
    assert [job.returncode for job in done] == [0, 0], [job.stderr for job in done]
    together = files(out)
    assert not [name for name in together if name.startswith(".")]
    assert run("report", design, "--out", out, "--quiet").code == 0
    assert set(files(out)) == set(together)
