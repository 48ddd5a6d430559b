"""Files attached to a PDF: attaches them by an incremental update, and reads them back."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.files import read_bytes, read_json

MOST_BYTES = 50_000_000
"""Largest accepted attachment in bytes (our choice, far above the size of any input)."""
MOST_FILES = 16
"""Maximum number of attachments (our choice: a report has two, an editor may add some)."""
NEAR = 4096
"""Maximum distance in bytes from the type entry in a PDF dictionary to either end of the dictionary
(our choice; our own reports need 200)."""
_MARK, _OBJECT = b"/EmbeddedFile", b" obj"
_STREAM = re.compile(rb">>\s{0,16}stream\r?\n")
_STEP = 1_000_000
"""Number of bytes that are unpacked in one step."""
_DAMAGED = Diagnostic("its attachment is damaged", "use the original file")

_MOST_PDF_BYTES = 200_000_000
_OURS = "give a PDF that actuator-opt wrote"


@dataclass(frozen=True, slots=True)
class Attachment:
    """The files attached to a report: the text of the design, and data of the run."""

    source: str
    run: Mapping[str, Any]


def embed(pdf: bytes, files: Sequence[tuple[str, str, bytes]], timestamp: int = 0) -> bytes:
    """Attach files (name, media type, content) to a PDF by ISO 32000-1, 7.5.6 and 7.11.4.

    The PDF must have a plain cross-reference table, as PDFs by matplotlib do.
    """
    start = int(pdf.rsplit(b"startxref", 1)[1].split()[0])
    trailer = pdf.rsplit(b"trailer", 1)[1]
    size = int(re.search(rb"/Size (\d+)", trailer)[1])  # type: ignore[index]
    root = int(re.search(rb"/Root (\d+) 0 R", trailer)[1])  # type: ignore[index]
    catalogue = re.search(rb"(?:^|\n)%d 0 obj\s*<<(.*?)>>\s*endobj" % root, pdf, re.DOTALL)
    if catalogue is None:
        raise InputError("cannot attach the input: the PDF has no catalogue")
    day = datetime.fromtimestamp(timestamp, UTC).strftime("D:%Y%m%d%H%M%SZ").encode()
    objects: dict[int, bytes] = {}
    names = []
    for index, (name, kind, content) in enumerate(files):
        stream, record = size + 2 * index, size + 2 * index + 1
        packed = zlib.compress(content, 9)
        subtype = kind.replace("/", "#2F").encode()
        objects[stream] = (
            b"<</Length %d/Type/EmbeddedFile/Filter/FlateDecode/Subtype/%s"
            b"/Params<</Size %d/ModDate(%s)>>>>\nstream\n%s\nendstream"
            % (len(packed), subtype, len(content), day, packed)
        )
        name_hex = b"<FEFF" + name.encode("utf-16-be").hex().upper().encode() + b">"
        objects[record] = (
            b"<</Type/Filespec/F%s/UF%s/EF<</F %d 0 R/UF %d 0 R>>/AFRelationship/Source>>"
            % (name_hex, name_hex, stream, stream)
        )
        names.append((name_hex, record))
    listed = b" ".join(b"%s %d 0 R" % entry for entry in sorted(names))
    refs = b" ".join(b"%d 0 R" % record for _, record in names)
    extra = b"/Names<</EmbeddedFiles<</Names[%s]>>>>/AF[%s]" % (listed, refs)
    objects[root] = b"<<" + catalogue[1].strip() + extra + b">>"
    return pdf + _update(objects, len(pdf), size + 2 * len(files), root, start)


def _update(objects: dict[int, bytes], offset: int, size: int, root: int, previous: int) -> bytes:
    """Objects, cross-reference section and trailer of an incremental update."""
    body, table = b"\n", b"xref\n"
    for number in sorted(objects):
        table += b"%d 1\n%010d 00000 n \n" % (number, offset + len(body))
        body += b"%d 0 obj\n%s\nendobj\n" % (number, objects[number])
    trailer = b"trailer\n<</Size %d/Root %d 0 R/Prev %d>>\nstartxref\n%d\n%%%%EOF\n"
    return body + table + trailer % (size, root, previous, offset + len(body))


def extract(pdf: bytes, kinds: Sequence[str]) -> dict[str, bytes]:
    """Attached files by media type, as written by `embed`, the Typst report and most editors.

    Streams are located by their own dictionaries, without the cross-reference table. A PDF may be
    malicious, so the search has limits: it passes the file once, reads at most `MOST_FILES`
    dictionaries within `NEAR` bytes of their type entries, and unpacks at most `MOST_BYTES` of
    content each.

    Parameters
    ----------
    pdf : the file
    kinds : media types to read; others are ignored

    Raises
    ------
    InputError : a damaged or too large attachment, or several of the same kind
    """
    contents: dict[str, bytes] = {}
    for about, begin in streams(pdf):
        kind = re.search(rb"/Subtype\s*/([\w#.+-]+)", about)
        if kind is None:
            continue
        name = kind[1].replace(b"#2F", b"/").replace(b"#2f", b"/").decode("ascii", "replace")
        if name not in kinds:
            continue
        content = _content(pdf, begin, about)
        if contents.setdefault(name, content) != content:
            message = f"has several attachments of type {name}"
            raise InputError(Diagnostic(message, "give the report of one design"))
    return contents


def streams(pdf: bytes) -> Iterator[tuple[bytes, int]]:
    """Dictionaries of embedded files, each with the start of its stream."""
    count, place = 0, pdf.find(_MARK)
    while place >= 0:
        end = place + len(_MARK)
        if count == MOST_FILES:
            raise InputError(f"has more than {MOST_FILES} attachments")
        if not pdf[end : end + 1].isalnum():  # another word
            count += 1
            begin = pdf.rfind(_OBJECT, max(place - NEAR, 0), place)
            opened = _STREAM.search(pdf, end, end + NEAR)
            if begin >= 0 and opened is not None and pdf.find(b"endobj", begin, opened.start()) < 0:
                yield pdf[begin + len(_OBJECT) : opened.start()], opened.end()
        place = pdf.find(_MARK, end)


def _content(pdf: bytes, begin: int, about: bytes) -> bytes:
    """Content of an embedded file; its size must equal the stated size."""
    if re.search(rb"/Filter\s*(?:\[\s*)?/FlateDecode\s*\]?", about):
        content, whole = _unpacked(pdf, begin)
    elif b"/Filter" in about:
        raise InputError("its attachment is compressed by an unknown method")
    else:
        length = re.search(rb"/Length\s+(\d{1,12})(?!\d|\s+\d+\s+R)", about)
        end = begin + int(length[1]) if length else pdf.find(b"endstream", begin)
        whole = begin <= end <= len(pdf)
        if end - begin > MOST_BYTES:
            raise _too_large()
        content = pdf[begin:end] if length else pdf[begin:end].removesuffix(b"\n")
    size = re.search(rb"/Size\s+(\d{1,12})(?!\d)", about)
    if not whole or (size is not None and int(size[1]) != len(content)):
        raise InputError(_DAMAGED)
    return content


def _unpacked(pdf: bytes, begin: int) -> tuple[bytes, bool]:
    """The content of a packed stream, and whether its end was reached."""
    packed, parts, room = zlib.decompressobj(), list[bytes](), MOST_BYTES
    for place in range(begin, min(len(pdf), begin + MOST_BYTES), _STEP):
        try:
            parts.append(packed.decompress(pdf[place : place + _STEP], room + 1))
        except zlib.error:
            raise InputError(_DAMAGED) from None
        room -= len(parts[-1])
        if room < 0:
            raise _too_large()
        if packed.eof:
            break
    return b"".join(parts), packed.eof


def _too_large() -> InputError:
    return InputError(f"its attachment is larger than {MOST_BYTES // 1_000_000} MB")


def read_attachment(path: Path) -> Attachment:
    """The design file and the command that are attached to a report of this program.

    Raises
    ------
    InputError : no such file, not a PDF, encrypted, damaged, or not written by this program
    """
    content = read_bytes(path, most=_MOST_PDF_BYTES, kinds=(".pdf",), what="PDF")
    try:
        if b"%PDF-" not in content[:1024]:
            raise InputError(Diagnostic("is not a PDF", _OURS))
        if re.search(rb"/Encrypt\s+\d+\s+\d+\s+R", content):
            raise InputError(Diagnostic("is encrypted", "save it without a password"))
        contents = extract(content, ("application/yaml", "application/json"))
        source, run = contents["application/yaml"].decode(), read_json(contents["application/json"])
        if not isinstance(run, dict) or "actuator_opt" not in run:
            raise KeyError("actuator_opt")
    except KeyError:
        raise InputError(Diagnostic(_no_input(content), _OURS, str(path))) from None
    except ValueError:
        raise InputError(replace(_DAMAGED, file=str(path))) from None
    except InputError as error:
        raise InputError([replace(x, file=str(path)) for x in error.diagnostics]) from None
    return Attachment(source, run)


def _no_input(content: bytes) -> str:
    """Message on why a PDF has no input attached: written without it, or the file is truncated."""
    complete = b"%%EOF" in content[-2048:]
    return (
        "has no input (design file) to run again" if complete else "is truncated and has no input"
    )
