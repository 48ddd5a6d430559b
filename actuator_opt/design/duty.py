"""The block `duty` of a design: cycles of motion and load, and what a life needs besides them.

Load cases are single states; cycles are courses over time. A design may have both. Each number has
a PATH, such as ``duty.cycles[walk].torque_scale``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field

from .cycle_record import MOST_BYTES, CycleRecord, parse_cycle
from .data_file import DataFile, DataFileName, as_read
from .kinds import Boolean, CaseName, Choice, EntryName, Label, Of, Section

MOST_CYCLES = 50
"""Largest number of cycles of a design (our choice)."""
MOST_LEVELS = 10
"""Largest number of levels of the supply pressure (our choice)."""

ThermalBasis: TypeAlias = Annotated[
    Literal["worst", "mean"],
    Choice(
        "cycle for which the steady temperatures are computed; worst: the cycle that heats most, "
        "repeated without end; mean: all cycles, weighted by their time in a life"
    ),
]


def cycle_of(
    file: DataFile, *, closed: bool, ignore: tuple[str, ...] = (), samples: int | None = None
) -> CycleRecord:
    """The record in a file; for `DataFile.parsed`. Faults as for `read_cycle`."""
    if samples is None:
        return parse_cycle(file.text, file.place, closed=closed, ignore=ignore)
    return file.parsed(cycle_of, closed=closed, ignore=ignore).resampled(samples)


def _closed(cycle: Mapping[str, Any]) -> bool:
    """Whether a cycle of a tree repeats; its value may still be a text."""
    return str(cycle.get("closed", True)).strip().lower() not in ("false", "no", "off", "0")


def _ignored(cycle: Mapping[str, Any]) -> tuple[str, ...]:
    """The columns that a cycle of a tree ignores."""
    names = cycle.get("ignore")
    return tuple(map(str, names)) if isinstance(names, (list, tuple)) else ()


class SharingActuator(Section):
    """A further actuator on the same supply, which runs the same cycle with another phase."""

    phase: Annotated[float, Of("cycle_phase", "delay of its cycle, as a share of the period")]


class DutyCycle(Section):
    """One cycle: a file of motion and load over time, with its repeats in a life.

    The file states angle and torque of the joint, or position and force of the rod. Its torques or
    forces contain the inertia of the load: `load.mass` and `load.inertia` are not added.
    """

    name: Annotated[str, CaseName("name of the cycle in reports and PATHs")]
    file: Annotated[
        str,
        DataFileName(
            "CSV file in the folder of the design, with columns such as time [s], joint_angle "
            "[deg], joint_torque [N*m]; or position [mm], force [N]; or its text of several lines",
            "walk.csv",
            most=MOST_BYTES,
            parse=lambda file, cycle: file.parsed(
                cycle_of, closed=_closed(cycle), ignore=_ignored(cycle)
            ),
        ),
    ]
    repeats: Annotated[
        float | None,
        Of("repeats", "repeats in a life; default: no statement on the life of this cycle"),
    ] = None
    starts: Annotated[
        float, Of("repeats", "times in a life that the pressure is raised from zero for this cycle")
    ] = 0.0
    torque_scale: Annotated[float, Of("scale_factor", "factor of the file's torques")] = 1.0
    force_scale: Annotated[float, Of("scale_factor", "factor of the file's forces")] = 1.0
    time_scale: Annotated[
        float, Of("scale_factor", "factor of the file's times; 2: half as fast")
    ] = 1.0
    lever_arm: Annotated[
        float | None,
        Of(
            "lever_arm",
            "constant lever arm of the joint, with the travel centred in the stroke; default: from "
            "the linkage",
        ),
    ] = None
    supply_pressure: Annotated[
        float | None,
        Of("working_pressure", "supply pressure of this cycle; default: supply.pressure"),
    ] = None
    level: Annotated[
        str | None,
        EntryName("level of duty.levels that supplies this cycle; default: supply.pressure"),
    ] = None
    closed: Annotated[
        bool, Boolean("whether the cycle repeats, so that its last sample is its first")
    ] = True
    phase: Annotated[
        float, Of("cycle_phase", "delay of this actuator's cycle, as a share of the period")
    ] = 0.0
    also: Annotated[tuple[SharingActuator, ...], Field(max_length=20)] = ()
    ignore: Annotated[
        tuple[Annotated[str, Label("column of the file that is not read", "emg")], ...],
        Field(max_length=100),
    ] = ()

    @property
    def record(self) -> CycleRecord:
        """The samples of the file, unscaled.

        Raises
        ------
        InputError
            the file was not read, because the design was not made from a file or text
        """
        return self.sampled(None)

    def sampled(self, samples: int | None) -> CycleRecord:
        """The record with at least `samples` samples; None keeps those of the file."""
        file = as_read(self.file, f"cycle {self.name}")
        if samples is None:
            return file.parsed(cycle_of, closed=self.closed, ignore=self.ignore)
        return file.parsed(cycle_of, closed=self.closed, ignore=self.ignore, samples=samples)


class SupplyLevel(Section):
    """A supply pressure that several cycles may share, and that a choice may assign to a cycle."""

    name: Annotated[str, CaseName("name of the level, for `level` of a cycle")]
    pressure: Annotated[float, Of("working_pressure", "supply pressure of the level")]


class Tank(Section):
    """A tank of a closed oil circuit; all losses end as heat in its oil."""

    cooler_conductance: Annotated[
        float, Of("thermal_conductance", "heat flow of tank and cooler per temperature difference")
    ]


class SealWear(Section):
    """Measured wear of a seal: worn depth = rate x contact pressure x sliding distance."""

    rate: Annotated[
        float | None,
        Of("wear_rate", "wear rate k of Archard's law from a test; default: no wear depth"),
    ] = None
    depth: Annotated[
        float | None, Of("wear_depth", "allowed wear depth; default: from the squeeze")
    ] = None


class Wear(Section):
    """Measured wear of the seals."""

    piston: SealWear | None = None
    rod: SealWear | None = None


class DutySupply(Section):
    """The supply that cycles need: efficiencies, accumulator, energy store, and their masses.

    Without a specific mass there is no mass of the whole system: none is assumed.
    """

    pump_efficiency: Annotated[
        float | None, Of("machine_efficiency", "hydraulic by mechanical power of the pump")
    ] = None
    motor_efficiency: Annotated[
        float | None, Of("machine_efficiency", "mechanical by electric power of the motor")
    ] = None
    pressure_drop: Annotated[
        float | None,
        Of("pressure_drop", "largest drop of the supply pressure while the accumulator empties"),
    ] = None
    precharge_ratio: Annotated[
        float | None,
        Of("precharge_ratio", "precharge divided by the lowest supply pressure, both absolute"),
    ] = None
    polytropic_index: Annotated[
        float | None,
        Of(
            "polytropic_index",
            "polytropic index of the accumulator's gas; default: 1.4 for a cycle under a minute, "
            "else 1",
        ),
    ] = None
    mission_time: Annotated[
        float | None, Of("service_time", "time for which the energy store lasts")
    ] = None
    specific_energy: Annotated[
        float | None, Of("specific_energy", "energy of the store divided by its mass")
    ] = None
    pump_mass: Annotated[
        float | None,
        Of("mass_per_power", "mass of pump and motor divided by their largest hydraulic power"),
    ] = None
    cooler_mass: Annotated[
        float | None,
        Of("mass_per_conductance", "mass of the cooler divided by its thermal conductance"),
    ] = None
    accumulator_mass: Annotated[
        float | None, Of("shell_density", "mass of the accumulator divided by its gas volume")
    ] = None
    other_mass: Annotated[
        float | None, Of("system_part_mass", "mass of further parts, such as lines to the supply")
    ] = None


class DutySection(Section):
    """Duty cycles of the actuator, and what their evaluation needs besides."""

    cycles: Annotated[tuple[DutyCycle, ...], Field(min_length=1, max_length=MOST_CYCLES)]
    levels: Annotated[tuple[SupplyLevel, ...], Field(max_length=MOST_LEVELS)] = ()
    samples: Annotated[
        float | None,
        Of("sample_count", "least number of samples of a cycle, by its spline; default: the file"),
    ] = None
    opening_limit: Annotated[
        float, Of("opening_limit", "largest opening of the valve that a cycle may need")
    ] = 0.9
    standby: Annotated[
        float, Of("service_time", "time in a life, at rest under supply pressure")
    ] = 0.0
    oil_supply: Annotated[
        float | None,
        Of("temperature", "temperature of the oil from the supply; default: fluid.temperature"),
    ] = None
    tank: Tank | None = None
    ambient: Annotated[float, Of("temperature", "temperature of the air around")] = 293.15
    air_speed: Annotated[float, Of("speed", "speed of the air across the actuator")] = 0.0
    emissivity: Annotated[float, Of("emissivity", "emissivity of the actuator's surface")] = 0.9
    """Default: bare or painted laminate, recalled, not re-read; bare aluminium has 0.1."""
    thermal: ThermalBasis = "worst"
    wear: Wear | None = None
    supply: DutySupply | None = None

    @property
    def warnings(self) -> list[str]:
        """Sentences on doubtful data of all cycles, each with the cycle's PATH."""
        return [
            f"duty.cycles[{cycle.name}]: {text}"
            for cycle in self.cycles
            for text in self.record(cycle).warnings
        ]

    def pressure_path(self, cycle: DutyCycle) -> str:
        """PATH of the supply pressure of a cycle: its own, that of its level, or that of all."""
        if cycle.supply_pressure is not None:
            return f"duty.cycles[{cycle.name}].supply_pressure"
        return "supply.pressure" if cycle.level is None else f"duty.levels[{cycle.level}].pressure"

    def record(self, cycle: DutyCycle) -> CycleRecord:
        """The record of a cycle, with at least `samples` samples."""
        return cycle.sampled(None if self.samples is None else int(self.samples))
