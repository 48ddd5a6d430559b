"""The words a scenario may choose from: one type each, with what every word means."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from ..kinds import Choice

Shape: TypeAlias = Annotated[
    Literal["constant", "step", "ramp", "pulse", "sine", "record"],
    Choice(
        "course of this part of the signal; constant: value all the time; "
        "step: value from start on; ramp: from nothing at start to value at end; "
        "pulse: value from start to end; sine: amplitude value at frequency, from start to end; "
        "record: a column of a CSV file, linear between its samples"
    ),
]
Law: TypeAlias = Annotated[
    Literal["p", "pi", "pid"],
    Choice(
        "what the controller does with the error; p: in proportion; pi: and its integral; "
        "pid: and its rate"
    ),
]
Tuning: TypeAlias = Annotated[
    Literal["margins", "ziegler_nichols", "stated"],
    Choice(
        "where gain and times come from if they are not stated; margins: from the ultimate point "
        "of the linear model with a gain margin, direction and place of least gain; "
        "ziegler_nichols: by their table from the same point; stated: all are stated"
    ),
]
Friction: TypeAlias = Annotated[
    Literal["lugre", "stribeck", "none"],
    Choice(
        "how the seals resist; lugre: bristles that stick, slide and creep; "
        "stribeck: a curve over the speed, smooth through zero; none: not at all"
    ),
]
Supply: TypeAlias = Annotated[
    Literal["constant", "fixed_pump", "controlled_pump"],
    Choice(
        "what feeds the valve; constant: the design's supply pressure, whatever flows; "
        "fixed_pump: a pump of constant flow with a relief valve; "
        "controlled_pump: a pump that follows the pressure with a lag"
    ),
]
Ends: TypeAlias = Annotated[
    Literal["valve", "closed", "blocked", "constant_pressure", "reducing_valve"] | None,
    Choice(
        "what the ports lead to (default: the valve of the design, else its ports.end); "
        "valve: the valve, driven by signal or control; closed: lines shut at their far end; "
        "blocked: shut at the cylinder, before a throttle; "
        "constant_pressure: ports that hold their pressure; reducing_valve: the design's"
    ),
]
CushionEnd: TypeAlias = Annotated[
    Literal["both", "cap", "rod"],
    Choice("which ends have it; both: both; cap: where the rod is in; rod: where it is out"),
]
