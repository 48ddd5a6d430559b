"""What a scenario may choose around the design: supply, friction of the seals, ends, control law.

Each entry states its words and keys here; `simulation.parts` states its equations. A kind without
equations fails at import (`kinds.per_kind`).
"""

from __future__ import annotations

from dataclasses import dataclass

from ...base.kinds import kinds


@dataclass(frozen=True, slots=True)
class SupplyType:
    """What feeds the valve.

    Attributes
    ----------
    name, help : its word in a scenario, and what it means
    needed, unread : keys it cannot do without, and keys it does not read
    pumps : whether a pump delivers into a volume, whose pressure is a state
    words : for a report
    """

    name: str
    help: str
    needed: tuple[str, ...]
    unread: tuple[str, ...]
    pumps: bool
    words: str


@dataclass(frozen=True, slots=True)
class SealFriction:
    """How the seals resist over time.

    Attributes
    ----------
    name, help : its word in a scenario, and what it means
    unread : keys of `friction` it does not read
    words : for a report
    """

    name: str
    help: str
    unread: tuple[str, ...]
    words: str


@dataclass(frozen=True, slots=True)
class PortEnd:
    """What the ports of the cylinder lead to.

    Attributes
    ----------
    name, help : its word in a scenario, and what it means
    words : for a report; None where the supply's words say it
    shut : whether no oil passes the end
    holds : whether the end keeps its pressure
    at_cylinder : whether it stands at the cylinder, before a throttle
    """

    name: str
    help: str
    words: str | None
    shut: bool
    holds: bool
    at_cylinder: bool


@dataclass(frozen=True, slots=True)
class ControlLaw:
    """What the controller does with the error.

    Attributes
    ----------
    name, help : its word in a scenario, and what it means
    integral, derivative : the parts it has beside the proportional one
    """

    name: str
    help: str
    integral: bool
    derivative: bool

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts beside the proportional one."""
        both = {"integral": self.integral, "derivative": self.derivative}
        return tuple(name for name, has in both.items() if has)


SUPPLIES = kinds(
    "supply",
    SupplyType(
        "constant",
        "the design's supply pressure, whatever flows",
        needed=(),
        unread=("volume", "flow", "pump", "relief", "gain", "time_constant", "accumulator"),
        pumps=False,
        words="constant supply",
    ),
    SupplyType(
        "fixed_pump",
        "a pump of constant flow with a relief valve",
        needed=("volume", "relief"),
        unread=("gain", "time_constant"),
        pumps=True,
        words="fixed pump",
    ),
    SupplyType(
        "controlled_pump",
        "a pump that follows the pressure with a lag",
        needed=("volume", "flow", "gain", "time_constant"),
        unread=("pump",),
        pumps=True,
        words="controlled pump",
    ),
)
"""Every supply by its word."""

FRICTIONS = kinds(
    "friction of the seals",
    SealFriction(
        "lugre", "bristles that stick, slide and creep", unread=(), words="LuGre friction"
    ),
    SealFriction(
        "stribeck",
        "a curve over the speed, smooth through zero",
        unread=("bristle_travel", "bristle_damping"),
        words="Stribeck friction",
    ),
    SealFriction(
        "none",
        "not at all",
        unread=(
            "coulomb",
            "static",
            "stribeck_speed",
            "exponent",
            "bristle_travel",
            "bristle_damping",
        ),
        words="no dry friction",
    ),
)
"""Every friction of the seals by its word."""

ENDS = kinds(
    "end",
    PortEnd(
        "valve",
        "the valve, driven by signal or control",
        words=None,
        shut=False,
        holds=False,
        at_cylinder=False,
    ),
    PortEnd(
        "closed",
        "lines shut at their far end",
        words="ports closed",
        shut=True,
        holds=False,
        at_cylinder=False,
    ),
    PortEnd(
        "blocked",
        "shut at the cylinder, before a throttle",
        words="ports blocked",
        shut=True,
        holds=False,
        at_cylinder=True,
    ),
    PortEnd(
        "constant_pressure",
        "ports that hold their pressure",
        words="ports at constant pressure",
        shut=False,
        holds=True,
        at_cylinder=False,
    ),
    PortEnd(
        "reducing_valve",
        "the design's",
        words="ports at reducing valves",
        shut=False,
        holds=False,
        at_cylinder=False,
    ),
)
"""Every end of the lines by its word."""

LAWS = kinds(
    "law",
    ControlLaw("p", "in proportion", integral=False, derivative=False),
    ControlLaw("pi", "and its integral", integral=True, derivative=False),
    ControlLaw("pid", "and its rate", integral=True, derivative=True),
)
"""Every law of the controller by its word."""
