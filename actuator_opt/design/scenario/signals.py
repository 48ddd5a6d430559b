"""Signals over time: lists of parts that are added."""

from __future__ import annotations

from typing import Annotated

from ..kinds import Of, Section
from . import kinds
from .kinds import FileName, Label


class SignalSegment(Section):
    """A part of a signal; the parts of a list are added."""

    shape: kinds.Shape
    start: Annotated[float, Of("instant", "start time; for a record: time of its zero")] = 0.0
    end: Annotated[float | None, Of("instant", "end time")] = None
    frequency: Annotated[float | None, Of("frequency", "frequency of a sine")] = None
    phase: Annotated[float, Of("phase", "phase of a sine at its start")] = 0.0
    file: Annotated[
        str | None, FileName("CSV file of a record, beside the scenario", "record.csv")
    ] = None
    column: Annotated[str | None, Label("column of a record, by its header", "force")] = None
    scale: Annotated[float, Of("factor", "factor on a record")] = 1.0


class Signal(SignalSegment):
    """A part of the valve signal."""

    value: Annotated[float | None, Of("signal_value", "height, or amplitude of a sine")] = None


class Position(SignalSegment):
    """A part of a position over time."""

    value: Annotated[float | None, Of("position_value", "height, or amplitude of a sine")] = None


class Speed(SignalSegment):
    """A part of a speed over time."""

    value: Annotated[float | None, Of("speed_value", "height, or amplitude of a sine")] = None


class Force(SignalSegment):
    """A part of the load force, positive against extension."""

    value: Annotated[float | None, Of("force_value", "height, or amplitude of a sine")] = None


class Torque(SignalSegment):
    """A part of the load torque on a shaft or joint."""

    value: Annotated[float | None, Of("torque_value", "height, or amplitude of a sine")] = None


class ShaftSpeed(SignalSegment):
    """A part of a shaft's speed over time."""

    value: Annotated[float | None, Of("shaft_speed_value", "height, or amplitude of a sine")] = None


class ShaftAngle(SignalSegment):
    """A part of a shaft's angle over time."""

    value: Annotated[float | None, Of("shaft_angle_value", "height, or amplitude of a sine")] = None
