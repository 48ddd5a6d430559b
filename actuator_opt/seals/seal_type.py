"""What a seal type states: words, sizes, faults, groove, contact, outline, elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, NamedTuple

from ..base.numeric import Array
from .contact import SealContact
from .outline import Shape
from .sizes import SizeField

if TYPE_CHECKING:
    from ..finite_elements.result import SealSolution

AXIAL_PLAY = 1.1
"""Groove over seal width where no groove is stated (choice: 10 % room to move and swell)."""


@dataclass(frozen=True, slots=True)
class SealSizes:
    """Numbers of a seal by name, SI, and the words that pick its laws.

    Parameters
    ----------
    numbers : those of the design file (`section`, `squeeze`, every size of the type) and
        `gland_depth`, `groove_width`, `diameter` of the counterface, `youngs_modulus` of what is
        squeezed, `pressure` it seals and `squeeze_left` under it; `hardness` where it is read;
        `face_modulus` and `face_poissons_ratio` of the sliding face where the type has `face`;
        floats, or arrays that broadcast
    law : of contact of a round ring (`models.seals.LAWS`)
    hardness_model : of its modulus (`models.elastomer.MODULUS_LAWS`)
    on_rod : whether the counterface is a rod, not a bore
    """

    numbers: Mapping[str, Array]
    law: str = "energised"
    hardness_model: str = "gent"
    on_rod: bool = True

    def __getitem__(self, name: str) -> Array:
        return self.numbers[name]


class SizeFault(NamedTuple):
    """A size that does not fit the others: its key, what is wrong, what to do."""

    key: str
    message: str
    remedy: str


class Piece(NamedTuple):
    """A part in a groove, of the seal's compound: free section [m^2], depth of its centre [m]."""

    area: Array
    depth: Array


class SealGroove(NamedTuple):
    """Groove of a seal without back-up rings.

    Parameters
    ----------
    depth : from the counterface, at nominal squeeze [m]
    ring_width : axial width of the seal [m]
    width : of the groove where the design states none [m]
    pieces : what lies in it
    """

    depth: Array
    ring_width: Array
    width: Array
    pieces: tuple[Piece, ...]


class Room(NamedTuple):
    """The groove that back-up rings leave: its ends along the cylinder, its depth [m]."""

    start: float
    end: float
    depth: float

    @property
    def middle(self) -> float:
        """Halfway between the ends [m]."""
        return (self.start + self.end) / 2


class Elements(NamedTuple):
    """Finite elements of a seal type.

    Parameters
    ----------
    solve : contacts of a seal of floats, of the groove's width that back-up rings leave [m] and
        rising sealed pressures [Pa]; imports what it needs itself
    note : how far the peak of their contact depends on the mesh
    """

    solve: Callable[[SealSizes, float, Sequence[float]], SealSolution]
    note: str


@dataclass(frozen=True, kw_only=True)
class SealType:
    """A type of seal; every piece must be given.

    Parameters
    ----------
    name : word in a design file
    title : in reports
    help : what the word means
    fields : sizes it has; a design refuses the others
    faults : sizes (floats by key, those a design states) that contradict each other
    groove : of `section`, `squeeze` and the needed sizes, floats or arrays by key
    contact : at the numbers of a seal
    outline : mounted, of floats by key, in the room it has
    round_ring : whether a round ring is squeezed: its contact follows from a law of `LAWS`, its
        modulus from its hardness, and both have a range of squeeze and hardness
    modulus_by : Young's modulus of what is squeezed: by the compound's hardness, because its stated
        modulus is that of a plastic ring before the rubber; else stated, or by hardness
    face : whether its contact reads modulus and Poisson's ratio of the sliding face
    o_ring_gland : whether it lies alone in a standard O-ring gland: its fill, stretch and section
        are checked, sizes and compounds of O-rings fit
    model : function that computes its line load, cited as its model; None: its law of `LAWS`
    contact_model : the same in words; {law} is replaced by the law's name
    warnings : what to doubt about its contact at the numbers of a seal
    elements : finite elements; None: there are none
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
        """Keys of the sizes that a design must state."""
        return tuple(field.key for field in self.fields if field.default is None)

    @property
    def width_key(self) -> str:
        """Key of its axial width: that of a round ring is its section."""
        return "width" if "width" in self.keys else "section"

    def sizes(
        self, stated: Mapping[str, Array], *, section: Array, gland_depth: Array
    ) -> dict[str, Array]:
        """Every size of the type: stated, else its default; a needed one must be stated.

        Parameters
        ----------
        stated : sizes by key, SI
        section, gland_depth : of the seal and its groove [m]
        """
        known: dict[str, Array] = {"section": section, "gland_depth": gland_depth}
        for field in self.fields:
            own = stated.get(field.key)
            if own is None and field.default is not None:
                own = field.default(known)
            known[field.key] = stated[field.key] if own is None else own
        del known["section"], known["gland_depth"]
        return known


def no_faults(sizes: Mapping[str, float]) -> Iterable[SizeFault]:
    """Of a type whose sizes never contradict each other."""
    return ()


def no_warnings(seal: SealSizes) -> Iterable[str]:
    """Of a type whose model has no range of its own."""
    return ()
