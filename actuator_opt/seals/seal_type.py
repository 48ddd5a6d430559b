"""Interface of a seal type: names, sizes, faults, groove, contact, outline, finite elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Literal, NamedTuple

from ..base.dataclass import dataclass
from ..base.numeric import Array
from .contact import SealContact, Shape, SizeField

if TYPE_CHECKING:
    from ..finite_elements.result import SealSolution

AXIAL_PLAY = 1.1
"""Default ratio of groove width to seal width. Our choice: 10 % clearance for motion and swell."""


@dataclass(frozen=True, slots=True)
class SealSizes:
    """Numbers of a seal by name, SI, and the names of its laws.

    Parameters
    ----------
    numbers : those of the design file (`section`, `squeeze`, every size of the type) and
        `gland_depth`, `groove_width`, `diameter` of the counterface, `youngs_modulus` of the
        squeezed part, sealed `pressure` and remaining `squeeze_left`; `hardness` if needed;
        `face_modulus` and `face_poissons_ratio` of the sliding face if the type has `face`;
        floats, or arrays that broadcast
    law : contact law of a round ring (`models.seals.LAWS`)
    hardness_model : law of its modulus (`models.elastomer.MODULUS_LAWS`)
    on_rod : whether the counterface is a rod, not a bore
    """

    numbers: Mapping[str, Array]
    law: str = "energised"
    hardness_model: str = "gent"
    on_rod: bool = True

    def __getitem__(self, name: str) -> Array:
        return self.numbers[name]


class SizeFault(NamedTuple):
    """A size that contradicts others: its key, the fault, the remedy."""

    key: str
    message: str
    remedy: str


class SealPart(NamedTuple):
    """A part in a groove, of the seal compound: free section [m^2], depth of its centre [m]."""

    area: Array
    depth: Array


class SealGroove(NamedTuple):
    """Groove of a seal without back-up rings.

    Parameters
    ----------
    depth : depth from the counterface at nominal squeeze [m]
    ring_width : axial width of the seal [m]
    width : default groove width [m]
    pieces : parts in the groove
    """

    depth: Array
    ring_width: Array
    width: Array
    pieces: tuple[SealPart, ...]


class Room(NamedTuple):
    """Space for a seal between its back-up rings: positions of its axial ends, and depth [m]."""

    start: float
    end: float
    depth: float

    @property
    def middle(self) -> float:
        """Axial position halfway between the ends [m]."""
        return (self.start + self.end) / 2


class Elements(NamedTuple):
    """Finite-element solution of a seal type.

    Parameters
    ----------
    solve : contacts of a seal of floats, from groove width without back-up rings [m] and
        increasing sealed pressures [Pa]; imports its libraries itself
    note : mesh dependence of the contact peak
    """

    solve: Callable[[SealSizes, float, Sequence[float]], SealSolution]
    note: str


@dataclass(frozen=True, kw_only=True)
class SealType:
    """A type of seal; every field must be stated.

    Parameters
    ----------
    name : name in a design file
    title : title in reports
    help : meaning of the name
    fields : its sizes; a design must not state others
    faults : function that yields contradictions between stated sizes (floats by key)
    groove : groove for `section`, `squeeze` and the required sizes, floats or arrays by key
    contact : contact for the numbers of a seal
    outline : mounted outline for floats by key, in its space
    round_ring : whether the squeezed part is a round ring: its contact follows from a law of
        `LAWS`, its modulus from its hardness, and both have a range of squeeze and hardness
    modulus_by : source of the modulus of the squeezed part: always hardness, if the compound
        states the modulus of a plastic ring; else stated, or by hardness
    face : whether its contact depends on the elastic constants of the sliding face
    o_ring_gland : whether it is alone in a standard O-ring gland: fill, stretch and section are
        checked, sizes and compounds of O-rings apply
    model : function of its line load, cited as its model; None: its law of `LAWS`
    contact_model : the same in words; {law} is replaced by the name of the law
    warnings : doubts about the contact for the numbers of a seal
    elements : finite-element solution, or None
    """

    name: str
    title: str
    help: str
    fields: tuple[SizeField, ...]
    faults: Callable[[Mapping[str, float]], Iterable[SizeFault]]
    groove: Callable[[Mapping[str, Array]], SealGroove]
    contact: Callable[[SealSizes], SealContact]
    outline: Callable[[Mapping[str, float], Room], tuple[Shape, ...]]
    round_ring: bool
    modulus_by: Literal["hardness", "stated"]
    face: bool
    o_ring_gland: bool
    model: Callable[..., object] | None
    contact_model: str
    warnings: Callable[[SealSizes], Iterable[str]]
    elements: Elements | None

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """Keys of its sizes."""
        return tuple(field.key for field in self.fields)

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """Keys of the required sizes."""
        return tuple(field.key for field in self.fields if field.default is None)

    @property
    def width_key(self) -> str:
        """Key of its axial width; for a round ring its section."""
        return "width" if "width" in self.keys else "section"

    def sizes(
        self, stated: Mapping[str, Array], *, section: Array, gland_depth: Array
    ) -> dict[str, Array]:
        """All sizes of the type: stated value, else default; required sizes must be stated.

        Parameters
        ----------
        stated : sizes by key, SI
        section, gland_depth : section of the seal, depth of its groove [m]
        """
        sizes: dict[str, Array] = {"section": section, "gland_depth": gland_depth}
        for field in self.fields:
            value = stated.get(field.key)
            if value is None and field.default is not None:
                value = field.default(sizes)
            sizes[field.key] = stated[field.key] if value is None else value
        del sizes["section"], sizes["gland_depth"]
        return sizes


def no_faults(sizes: Mapping[str, float]) -> Iterable[SizeFault]:
    """No faults, for a type whose sizes cannot contradict each other."""
    return ()


def no_warnings(seal: SealSizes) -> Iterable[str]:
    """No warnings, for a type whose model has no limited range."""
    return ()
