"""A measured record from a file: channels by the names of the signals they measure."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...base.errors import Diagnostic, InputError
from ...base.numeric import Array
from ...design.scenario.recorded import gap_words, gaps
from ...identification.column_units import NONE, ColumnUnits
from ...identification.record import CHANNELS, Channel, Record, parse_record

COLUMNS = {name: CHANNELS[name] for name in ("t", "p1", "p2", "x", "v", "F_L", "T")} | {
    "U": Channel("voltage", "V", "signal of the valve", ("signal", "command")),
    "spool": Channel("voltage", "V", "position of the spool", ("spoolposition",)),
    "pS": Channel("pressure", "bar", "supply pressure", ("pressuresupply", "psupply", "pp")),
    "qA": Channel("flow", "l/min", "flow into port A", ("flowa",)),
    "qB": Channel("flow", "l/min", "flow into port B", ("flowb",)),
    "n_shaft": Channel("angular_speed", "rpm", "speed of the shaft", ("shaftspeed", "speed")),
    "phi": Channel("angle", "deg", "angle of the shaft", ("shaftangle",)),
}
"""Channels of a record and their descriptions; a temperature column is ignored."""
SIGNALS = {
    "p1": "pressure_a", "p2": "pressure_b", "x": "position", "v": "speed", "F_L": "load_force",
    "U": "signal", "spool": "spool", "pS": "pressure_supply", "qA": "flow_a", "qB": "flow_b",
    "n_shaft": "shaft_speed", "phi": "shaft_angle",
}  # fmt: skip
"""The simulated signal that each channel measures."""
FEWEST = 10
"""Least number of samples for a usable channel (a choice)."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """A measured record on the scenario's time: signals by name, each (time [s], values [SI]).

    Channels may have different sample rates, late starts and gaps; times increase.
    """

    channels: Mapping[str, tuple[Array, Array]]
    name: str = "record"
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, record: Record) -> Measured:
        """The channels of a record; missing samples are left out.

        Raises
        ------
        InputError
            a sample without time, times that do not increase, no channel that a simulation has
        """
        time = _rising(record)
        channels: dict[str, tuple[Array, Array]] = {}
        notes, missing = [*record.notes], dict[str, list[str]]()
        known = [column for column in SIGNALS if column in record]
        for column in known:
            values, signal = record[column], SIGNALS[column]
            seen = np.isfinite(values)
            count = int(np.count_nonzero(seen))
            if count < FEWEST:
                notes.append(f"{signal}: {count} samples, left out: at least {FEWEST} are needed")
                continue
            channels[signal] = time[seen], values[seen]
            if absent := gaps(time, values):
                missing.setdefault(gap_words(absent), []).append(signal)
        if known and not channels:
            message = f"fewer than {FEWEST} numbers in {', '.join(known)}"
            raise record.fault(
                message, "give more samples: empty cells, nan, inf and 1e30 count as missing"
            )
        if not channels:
            message = "no channel matches a simulated signal"
            raise record.fault(message, f"name columns {', '.join(SIGNALS)} with units")
        notes += [
            f"{named(names, channels)}: {words}, left out" for words, names in missing.items()
        ]
        still = [signal for signal, (_, values) in channels.items() if np.ptp(values) == 0]
        if still:
            notes.append(f"{', '.join(still)}: constant throughout the record")
        return cls(channels, record.name, tuple(notes))

    def fault(self, message: str, remedy: str) -> InputError:
        """An error about this record."""
        return InputError(Diagnostic(message, remedy, file=self.name))


def parse_measured(
    text: str,
    *,
    name: str = "record",
    columns: Mapping[str, str] | None = None,
    units: ColumnUnits = NONE,
) -> Measured:
    """A measured record from the text of a CSV file, columns as in `COLUMNS`.

    Parameters
    ----------
    text : of the file
    name : of the file, for messages
    columns : header by channel, if the names are not known: ``{"p1": "Channel 3 [bar]"}``
    units : of columns whose header states none

    Raises
    ------
    InputError
        as `identification.parse_record`; no channel that a simulation has
    """
    record = parse_record(
        text, name=name, columns=columns, channels=COLUMNS, units=units, needed=SIGNALS
    )
    notes = [
        f"{one}; channels are {', '.join(SIGNALS)}" if one.startswith("columns that") else one
        for one in record.notes
    ]
    return Measured.of(replace(record, notes=tuple(notes)))


def named(names: Collection[str], every: Collection[str]) -> str:
    """Name some channels, or "all channels"."""
    return ", ".join(names) if len(names) < max(len(every), 2) else "all channels"


def _rising(record: Record) -> Array:
    """The times of a record, checked."""
    time = record.time
    lost = np.flatnonzero(~np.isfinite(time))
    if lost.size:
        raise record.fault("missing time", "give a time for every sample", int(lost[0]))
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        at = int(back[0]) + 1
        message = f"time does not increase at {time[at]:.9g} s"
        raise record.fault(message, "sort the lines by time and remove repeated ones", at)
    return time
