"""Components around the design in a scenario: supply, seal friction, port ends, control law.

Each entry declares its name and keys here and its equations in `simulation.parts`. A kind without
equations fails at import (`kinds.per_kind`).
"""

from __future__ import annotations

from dataclasses import dataclass

from ...base.kinds import kinds


@dataclass(frozen=True, slots=True)
class SupplyType:
    """Type of supply of the valve.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    needed, unread : required keys, and keys without effect
    pumps : whether a pump delivers into a volume with its pressure as a state
    words : text for a report
    """

    name: str
    help: str
    needed: tuple[str, ...]
    unread: tuple[str, ...]
    pumps: bool
    words: str


@dataclass(frozen=True, slots=True)
class SealFriction:
    """Friction model of the seals over time.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    unread : keys of `friction` without effect
    words : text for a report
    """

    name: str
    help: str
    unread: tuple[str, ...]
    words: str


@dataclass(frozen=True, slots=True)
class PortEnd:
    """End of the cylinder's ports.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    words : text for a report; None if the text of the supply suffices
    shut : whether the end is closed
    holds : whether the end has constant pressure
    at_cylinder : whether the end is at the cylinder, before a throttle
    """

    name: str
    help: str
    words: str | None
    shut: bool
    holds: bool
    at_cylinder: bool


@dataclass(frozen=True, slots=True)
class ControlLaw:
    """Control law: response of the controller to the error.

    Attributes
    ----------
    name, help : name in a scenario, and its meaning
    integral, derivative : whether the law has these terms besides the proportional term
    """

    name: str
    help: str
    integral: bool
    derivative: bool

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the terms besides the proportional term."""
        both = {"integral": self.integral, "derivative": self.derivative}
        return tuple(name for name, has in both.items() if has)


SUPPLIES = kinds(
    "supply",
    SupplyType(
        "constant",
        "supply pressure of the design at any flow",
        needed=(),
        unread=("volume", "flow", "pump", "relief", "gain", "time_constant", "accumulator"),
        pumps=False,
        words="constant supply",
    ),
    SupplyType(
        "fixed_pump",
        "constant-flow pump with a relief valve",
        needed=("volume", "relief"),
        unread=("gain", "time_constant"),
        pumps=True,
        words="fixed pump",
    ),
    SupplyType(
        "controlled_pump",
        "pressure-controlled pump with a first-order lag",
        needed=("volume", "flow", "gain", "time_constant"),
        unread=("pump",),
        pumps=True,
        words="controlled pump",
    ),
)
"""Every supply by name."""

FRICTIONS = kinds(
    "friction of the seals",
    SealFriction(
        "lugre", "bristle model with sticking, sliding and creep", unread=(), words="LuGre friction"
    ),
    SealFriction(
        "stribeck",
        "friction curve over speed, smooth through zero",
        unread=("bristle_travel", "bristle_damping"),
        words="Stribeck friction",
    ),
    SealFriction(
        "none",
        "no friction",
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
"""Every friction model of the seals by name."""

ENDS = kinds(
    "end",
    PortEnd(
        "valve",
        "valve, driven by signal or control",
        words=None,
        shut=False,
        holds=False,
        at_cylinder=False,
    ),
    PortEnd(
        "closed",
        "lines closed at their far end",
        words="ports closed",
        shut=True,
        holds=False,
        at_cylinder=False,
    ),
    PortEnd(
        "blocked",
        "closed at the cylinder, before a throttle",
        words="ports blocked",
        shut=True,
        holds=False,
        at_cylinder=True,
    ),
    PortEnd(
        "constant_pressure",
        "ports at constant pressure",
        words="ports at constant pressure",
        shut=False,
        holds=True,
        at_cylinder=False,
    ),
    PortEnd(
        "reducing_valve",
        "reducing valves of the design",
        words="ports at reducing valves",
        shut=False,
        holds=False,
        at_cylinder=False,
    ),
)
"""Every end of the lines by name."""

LAWS = kinds(
    "law",
    ControlLaw("p", "proportional", integral=False, derivative=False),
    ControlLaw("pi", "proportional and integral", integral=True, derivative=False),
    ControlLaw("pid", "proportional, integral and derivative", integral=True, derivative=True),
)
"""Every control law by name."""
