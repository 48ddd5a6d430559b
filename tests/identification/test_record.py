"""Records as benches write them: any dialect reads to the same SI numbers, any fault is one line.

Expected values are the numbers written, times the definition of the unit.
"""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

from actuator_opt.base.errors import InputError
from actuator_opt.base.sheets import decode_sheet
from actuator_opt.identification.record import CHANNELS, parse_record

PLAIN = "t [s],p1 [bar],p2 [bar],x [mm]\n0,10,2,5\n0.001,11,3,6\n"
INCH, POUND, GRAVITY = 0.0254, 0.45359237, 9.80665
PSI = POUND * GRAVITY / INCH**2
"""Pound-force per square inch by the international pound and inch of 1959 [Pa]."""
ATMOSPHERE = 101325.0
"""Standard atmosphere, ISO 2533 [Pa]."""


def faults(text, **choices):
    """The lines with which a text is refused."""
    with pytest.raises(InputError) as caught:
        parse_record(text, name="r.csv", **choices)
    for one in caught.value.diagnostics:
        assert one.file == "r.csv"
        assert one.remedy
        assert "\n" not in str(one)
        assert len(str(one)) < 500
    return [str(one) for one in caught.value.diagnostics]


def fault(text, **choices):
    """The one line with which a text is refused."""
    (line,) = faults(text, **choices)
    return line


def same(record):
    """Whether a record holds the numbers of PLAIN."""
    np.testing.assert_allclose(record.time, [0, 1e-3], rtol=1e-15)
    for name, values in {"p1": [1e6, 1.1e6], "p2": [2e5, 3e5], "x": [5e-3, 6e-3]}.items():
        np.testing.assert_allclose(record[name], values, rtol=1e-15)
    return True


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        PLAIN.replace(",", ";"),
        PLAIN.replace(",", "\t"),
        PLAIN.replace(",", " , "),
        PLAIN.replace(",", ";").replace(".", ","),
        PLAIN.replace(",", "\t").replace(".", ","),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\r"),
        PLAIN.rstrip("\n"),
        "\ufeff" + PLAIN,
        PLAIN + "\n\n \n,,,\n",
        PLAIN.replace("\n", ",\n"),
        PLAIN.replace("\n", ";\n").replace(",", ";"),
        PLAIN.replace("\n", ",\n", 1),
        PLAIN.replace("\n0", ",,\n0", 1),
        "# bench 7\n\n#\n" + PLAIN.replace("\n0.", "\n# stop\n\n0."),
        "# t [s],p1 [bar],p2 [bar],x [mm]\n" + PLAIN.partition("\n")[2],
        '"t [s]","p1 [bar]","p2 [bar]","x [mm]"\n"0","10","2","5"\n"0.001","11","3","6"\n',
        '"t [s]","p1, cap (bar)","p2 [bar]","x [mm]"\n0,10,2,5\n0.001,11,3,6\n'.replace(
            ", cap", ""
        ),
        't [s],p1 [bar],p2 [bar],x [mm]\n"0,000","10,0","2,0","5,0"\n"0,001","11","3","6"\n',
        "T,P1,P2,X\nS,BAR,BAR,MM\n0,10,2,5\n0.001,11,3,6\n",
        "Time (s),P_1 (bar),P_2 (bar),X (mm)\n0,10,2,5\n0.001,11,3,6\n",
        "t / s;p1 / bar;p2 / bar;x / mm\n0;10;2;5\n0,001;11;3;6\n",
        "t,p1,p2,x\n[s],[bar],[bar],[mm]\n0,10,2,5\n0.001,11,3,6\n",
        "t;p1;p2;x;;\n(s);(bar);(bar);(mm);;\n0;10;2;5;;\n0,001;11;3;6;;\n",
        "x [mm],note,t [ms],p1 [barg],day,p2 [bar(g)]\n5,run,0,10,3.4.2024,2\n6,,1,11,-,3\n",
        "t [s],p1 [bar],p2 [bar],x [mm],Speed [rpm],Temp [V]\n0,10,2,5,1,1\n0.001,11,3,6,?,?\n",
        "t [s], p1 [bar gauge],p2 [bar g],x [ mm ]\n0,10,2,5\n0.001,11,3,6\n",
    ],
)
def test_dialects_read_to_the_same_record(text):
    """Separators, decimals, quotes, units, line ends, comments and empty lines change nothing."""
    assert same(parse_record(text))


@pytest.mark.parametrize(
    ("channel", "unit", "factor"),
    [
        ("x", "µm", 1e-6),
        ("x", "μm", 1e-6),
        ("x", "Âµm", 1e-6),
        ("x", "MM", 1e-3),
        ("x", "in", INCH),
        ("v", "µm/s", 1e-6),
        ("v", "mm / s", 1e-3),
        ("p1", "MPA", 1e6),
        ("p1", "PSI", PSI),
        ("p1", "psig", PSI),
        ("p1", "N / mm^2", 1e6),
        ("p1", "N/mm²", 1e6),
        ("p1", "kPa gauge", 1e3),
        ("F_L", "KN", 1e3),
        ("F_L", "kN", 1e3),
        ("t", "sec", 1.0),
        ("t", "msec", 1e-3),
    ],
)
def test_units_as_benches_write_them(channel, unit, factor):
    """Greek and Latin micro, capitals, gauge marks and blanks in units are understood."""
    record = parse_record(
        f"{channel} [{unit}],{'x [m]' if channel == 't' else 't [s]'}\n3.5,1\n4.5,2\n"
    )
    values = record.time if channel == "t" else record[channel]
    np.testing.assert_allclose(values, [3.5 * factor, 4.5 * factor], rtol=1e-14)


@pytest.mark.parametrize("unit", ["°C", "degC", "deg C", "° C", "Â°C", "℃", "ºC"])
def test_degrees_celsius_are_read_to_kelvin(unit):
    """20 and 40 degrees Celsius are 293.15 and 313.15 K, however the degree is written."""
    record = parse_record(f"t [s],T [{unit}]\n0,20\n1,40\n")
    np.testing.assert_allclose(record["T"], [293.15, 313.15], rtol=1e-14)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("bara", 1e5), ("bar abs", 1e5), ("bar(a)", 1e5), ("psia", PSI), ("kPa absolute", 1e3)],
)
def test_absolute_pressures_become_gauge_and_say_so(unit, factor):
    """Gauge is absolute less the standard atmosphere, 101 325 Pa; the record notes it."""
    record = parse_record(f"t [s],p1 [{unit}]\n0,200\n1,300\n")
    expected = [200 * factor - ATMOSPHERE, 300 * factor - ATMOSPHERE]
    np.testing.assert_allclose(record["p1"], expected, rtol=1e-13)
    assert record.notes == (
        "p1 is an absolute pressure; it was converted to gauge with the standard atmosphere of "
        "1.01325 bar",
    )


@pytest.mark.parametrize(
    "cell",
    ["", " ", "NaN", "nan", "#N/A", "N/A", "NULL", "-", "inf", "-inf", "1e999", "-1e999", "3.4e38"],
)
def test_missing_samples_are_nan(cell):
    """Empty cells, words for none and the largest float of a logger are missing samples."""
    record = parse_record(f"t [s],p1 [bar],x [mm]\n0,1,2\n1,{cell},3\n2,2,4\n")
    np.testing.assert_array_equal(np.isnan(record["p1"]), [False, True, False])
    np.testing.assert_allclose(record["x"], [2e-3, 3e-3, 4e-3])


def test_a_missing_first_cell_is_no_comment():
    """A line that begins with #N/A is a sample, not a comment that is left out."""
    record = parse_record("x [mm],t [s]\n1,0\n#N/A,1\n# note,9\n3,2\n")
    np.testing.assert_allclose(record["x"], [1e-3, np.nan, 3e-3])
    assert [record.line(k) for k in range(3)] == [2, 3, 5]


def test_lines_of_samples_count_comments_and_blank_lines():
    """A sample's line is that of the file, also between comments, blank lines and old line ends."""
    for end in ("\n", "\r\n", "\r"):
        text = end.join(["# a", "", "t,x", "s,mm", "0,1", "", "# b", "1,2", ",", "2,3"])
        record = parse_record(text)
        assert [record.line(k) for k in range(3)] == [5, 8, 10]
    plain = parse_record(PLAIN)
    assert [plain.line(0), plain.line(1)] == [2, 3]


def test_time_or_temperature_by_its_unit():
    """A column T is the time where its unit is one, else the temperature."""
    record = parse_record("T [s],X [mm]\n0,1\n2,3\n")
    np.testing.assert_allclose(record.time, [0, 2])
    record = parse_record("t [s],T [K]\n0,300\n2,301\n")
    np.testing.assert_allclose(record["T"], [300, 301])


def test_huge_and_negative_numbers_stay():
    """Numbers keep sign and size."""
    record = parse_record("t [s],x [m],F_L [N]\n-5,-1e-12,1e20\n-4.5,+.5,-2.5E+3\n")
    np.testing.assert_allclose(record.time, [-5, -4.5])
    np.testing.assert_allclose(record["x"], [-1e-12, 0.5])
    np.testing.assert_allclose(record["F_L"], [1e20, -2500])


def test_unused_columns_are_noted():
    """Columns that are no channel are named once, text among them read without harm."""
    record = parse_record("t [s],state,x [mm],,valve [V]\n0,run;go,1,,2\n1,#,2,,\n")
    (note,) = record.notes
    words, _, channels = note.partition("; channels are ")
    assert words == 'columns ignored, as they are not channels: "state", "valve [V]"'
    assert channels == "p1, p2, x, v, F_L, T, w"


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("a [s],Channel 3 [bar]", {"t": "a", "p1": "Channel 3"}),
        ("a,Channel 3", {"t": "a [s]", "p1": "Channel 3 [bar]"}),
        ("a [ms],Channel 3 [psi]", {"t": "a [s]", "p1": "Channel 3 [bar]"}),
        ("a [s],Channel 3 [bar]", {"t": "a [s]", "p1": "Channel 3 [bar]"}),
        ("a [s],AI(3)", {"t": "a", "p1": "AI(3) [bar]"}),
        ("a [s],p=q [bar]", {"t": "a", "p1": "p=q"}),
        ("a [s],a/b [bar]", {"t": "a", "p1": "a/b [bar]"}),
        ("p1 [s],t [bar]", {"t": "p1 [s]", "p1": "t [bar]"}),
        ('a [s],"p (cap) [bar]"', {"t": "a", "p1": "p (cap)"}),
    ],
)
def test_columns_named_by_the_caller(header, columns):
    """A column may be named without or with its unit, which then counts before the header's."""
    record = parse_record(f"{header}\n1,20\n2,30\n", columns=columns)
    np.testing.assert_allclose(record.time, [1, 2])
    np.testing.assert_allclose(record["p1"], [2e6, 3e6])


@pytest.mark.parametrize(
    ("text", "columns", "says"),
    [
        ("", {}, "r.csv: the record is empty; give a CSV file"),
        ("\n \n# only\n", {}, "r.csv: the record is empty"),
        ("t [s],x [mm]\n", {}, "r.csv: no samples below the header"),
        ("t,x\ns,mm\n\n", {}, "r.csv: no samples below the header"),
        ("0,1\n1,2\n", {}, "r.csv:1: no header"),
        ("x [mm],v [m/s]\n1,2\n", {}, 'columns are "x", "v"; name it with --column "t=NAME [s]"'),
        (
            "Bench 7\nt [s],x [mm]\n1,2\n",
            {},
            'r.csv:1: no column t; columns are "Bench 7"; separate',
        ),
        ("t [s] x [mm]\n1 2\n", {}, "separate columns by commas, semicolons or tabs, begin other"),
        ("t [s],x\n0,1\n", {}, 'r.csv:1: column "x" states no unit; write e.g. "x [mm]"'),
        ("t [s],x [bar]\n0,1\n", {}, 'column "x": bar is a pressure, need a length'),
        ("t [s],p1 [baz]\n0,1\n", {}, 'column "p1": unknown unit "baz"; use one of'),
        ("t [s],p1 [bar],p1 [bar]\n0,1,2\n", {}, "both name the channel p1; rename or delete one"),
        (
            "t [s],p1 [bar],PA [bar]\n0,1,2\n",
            {},
            'both name the channel p1; choose a column with --column "p1=NAME"',
        ),
        ("t [s],x [mm]\n0,1\n\n1\n", {}, "r.csv:4: 1 cells, but the header has 2 columns"),
        ("t [s],x [mm]\n0,1\n1,2,3\n", {}, "r.csv:3: 3 cells, but the header has 2 columns"),
        ("t [s],x [mm]\n0,0,1\n1,0,2\n", {}, "r.csv:2: 3 cells"),
        ("t [s],x [mm]\n0,1,5\n1,0,2\n", {}, "separate columns by semicolons"),
        ("t [s],x [mm]\n0,1\n1,0x1F\n", {}, 'r.csv:3: "0x1F" in column "x" is not a number; write'),
        ("t [s],x [mm]\n0,1\n1,1_000\n", {}, 'r.csv:3: "1_000" in column "x" is not a number'),
        ("t [s];x [mm]\n0;1.234,5\n", {}, 'r.csv:2: "1.234.5" in column "x" is not'),
        ("t [s],x [mm]\n12:00:01.5,1\n12:00:02,2\n", {}, "is a clock time or a date; write the"),
        ("t [s],x [mm]\n2024-05-01,1\n", {}, "is a clock time or a date; write the time as"),
        ("t [s],x [mm]\n0,\x1b[31mred\n", {}, "r.csv:2: not text: byte 0x1b"),
        ("t [s],x [mm]\n0,\x00\n", {}, "r.csv:2: not text: byte 0x00; export the record as CSV"),
        (PLAIN, {"q": "x"}, 'r.csv:1: "q" is not a channel; use one of t, p1, p2, x, v, F_L, T, w'),
        (PLAIN, {"v": "p11"}, 'no column "p11" for v; did you mean "p1"?'),
        (PLAIN, {"v": ""}, 'no column "" for v'),
        (PLAIN, {"p1": "p2", "p2": "p2"}, 'column "p2 [bar]" is given for both p1 and p2'),
        ("t [s],a [mm],a [mm]\n0,1,1\n", {"x": "a"}, '2 columns are called "a"; rename all but'),
    ],
)
def test_faults_say_where_what_and_what_to_do(text, columns, says):
    """Every fault is one line with its place and its remedy."""
    assert says in fault(text, columns=columns)


def test_every_fault_of_a_header_is_said_at_once():
    """Two columns without a unit are two lines; a channel doubled often is one."""
    assert len(faults("t [s],x,p1\n0,1,2\n")) == 2
    assert len(faults("t [s]" + ",x [mm]" * 1000 + "\n0" + ",1" * 1000 + "\n")) == 1


def test_bytes_of_a_file_become_text():
    """UTF-8 and UTF-16 with a mark, UTF-8 without and Latin-1 read alike; no workbook is read."""
    text = "t [s],x [µm],T [°C]\n0,1,20\n1,2,21\n"
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "latin-1"):
        record = parse_record(decode_sheet(text.encode(encoding), "r.csv"))
        np.testing.assert_allclose(record["x"], [1e-6, 2e-6])
        np.testing.assert_allclose(record["T"], [293.15, 294.15])
    with pytest.raises(
        InputError, match=r"r\.csv: the file is a workbook or an archive, not text; save"
    ):
        decode_sheet(b"PK\x03\x04\x14\x00", "r.csv")
    with pytest.raises(InputError, match=r"r\.csv: the file is larger than 1 MB; leave out"):
        decode_sheet(b"0" * 1_000_001, "r.csv", most=1_000_000)


@given(data=st.binary(max_size=300))
@example(b"\x89PNG\r\n\x1a\n\x00\x00")
@example(b"\xff\xfe\x00")
def test_bytes_read_or_are_refused(data):
    """No bytes raise anything but an input error."""
    with contextlib.suppress(InputError):
        parse_record(decode_sheet(data, "r.csv"))


WORDS = st.sampled_from(
    ["t", "T [s]", "x [mm]", "p1", "(", "[", "]", "/", '"', ",", ";", "\t", "\n", "\r", "0", "1.5"]
) | st.sampled_from(
    ["1,5", "-", "#", "#N/A", "nan", "1e999", "s", "mm", " ", "_", "\x85", "=", ":"]
)


@st.composite
def spoilt(draw):
    """A good record with words put in and pieces cut out."""
    text = PLAIN
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(text)))
        word = draw(WORDS | st.text(max_size=3))
        text = text[:at] + word + text[at + draw(st.integers(0, 5)) :]
    return text


@given(text=st.one_of(spoilt(), st.text(max_size=200), st.lists(WORDS, max_size=40).map("".join)))
@example('"')
@example('t [s],"x [mm]\n0,"1\n')
@example("t [s],x [m]\n0,1e308\n")
@example("t [s],x [km]\n0,1e308\n")
@example("t [s]," + "(" * 150 + "\n0,1\n")
@example(",t [s]\n1,2\n")
@example("t [s]\n1\n")
def test_any_text_reads_or_is_refused_in_plain_lines(text):
    """No text raises anything but an input error, whose lines hold no control characters."""
    try:
        record = parse_record(text)
    except InputError as error:
        for one in error.diagnostics:
            assert str(one).isprintable()
    else:
        assert all(one.size == record.time.size for one in record.channels.values())
        assert record.line(record.time.size - 1) <= text.count("\n") + text.count("\r") + 1


@given(name=st.text(max_size=30), header=st.text(max_size=30))
def test_any_columns_read_or_are_refused(name, header):
    """No choice of columns raises anything but an input error."""
    try:
        parse_record(PLAIN, columns={name: header, "p1": header})
    except InputError as error:
        for one in error.diagnostics:
            assert str(one).isprintable()


NUMBERS = st.floats(-1e6, 1e6).map(lambda x: round(x, 6))
UNITS = {
    "t": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "p1": {"Pa": 1.0, "bar": 1e5, "MPa": 1e6, "psi": PSI, "barg": 1e5},
    "p2": {"bar": 1e5, "kPa": 1e3},
    "x": {"m": 1.0, "mm": 1e-3, "µm": 1e-6, "in": INCH},
    "F_L": {"N": 1.0, "kN": 1e3},
}


@st.composite
def tables(draw):
    """A text in some dialect, the SI numbers it means, and the lines of its samples."""
    names = draw(st.permutations(list(UNITS)).map(lambda one: list(one)))
    names.insert(draw(st.integers(0, len(names))), "status")
    chosen = {name: draw(st.sampled_from(sorted(UNITS[name]))) for name in UNITS}
    separator = draw(st.sampled_from([",", ";", "\t"]))
    comma = separator != "," and draw(st.booleans())
    quote = draw(st.sampled_from(["", '"']))
    style = draw(st.sampled_from(["{} [{}]", "{} ({})", "{} / {}", "{}[{}]", "below"]))
    tail = draw(st.sampled_from(["", separator, 2 * separator]))
    count = draw(st.integers(1, 8))
    rows = draw(st.lists(st.tuples(*[NUMBERS] * 5), min_size=count, max_size=count))
    header = [
        one if style == "below" or one == "status" else style.format(one, chosen[one])
        for one in names
    ]
    below = [chosen.get(one, "") for one in names]
    lines = [separator.join(quote + one + quote for one in header) + tail]
    if style == "below":
        lines.append(separator.join(below) + tail)
    places = []
    for row in rows:
        while draw(st.integers(0, 3)) == 3:
            lines.append(draw(st.sampled_from(["", "# note; a, b", "  ", 5 * separator])))
        values = dict(zip(UNITS, (repr(one) for one in row), strict=True))
        values = {name: one.replace(".", ",") if comma else one for name, one in values.items()}
        status = draw(st.sampled_from(["run", "", "3", f"{quote}a b{quote}"]))
        lines.append(separator.join(values.get(one, status) for one in names) + tail)
        places.append(len(lines))
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    text = (
        draw(st.sampled_from(["", "\ufeff"])) + end.join(lines) + draw(st.sampled_from(["", end]))
    )
    means = {
        name: np.array([row[k] for row in rows]) * UNITS[name][chosen[name]]
        for k, name in enumerate(UNITS)
    }
    return text, means, places


@given(table=tables())
def test_any_table_in_any_dialect_reads_to_its_si_numbers(table):
    """What is written is what is read, in SI, sample by sample and line by line."""
    text, means, places = table
    record = parse_record(text)
    np.testing.assert_allclose(record.time, means.pop("t"), rtol=1e-12)
    for name, values in means.items():
        np.testing.assert_allclose(record[name], values, rtol=1e-12)
    assert [record.line(k) for k in range(len(places))] == places


def test_every_channel_reads_by_its_other_names():
    """Every name that a channel states is understood, in any case and with blanks."""
    unit = {"pressure": "Pa", "length": "m", "speed": "m/s", "force": "N", "temperature": "K"}
    for channel, one in CHANNELS.items():
        for other in one.others:
            if channel == "t":
                assert parse_record(f"{other.upper()} [s]\n1\n").time.size == 1
            else:
                text = f"t [s],{other.upper()} [{unit[one.dimension]}]\n1,2\n"
                assert channel in parse_record(text)
