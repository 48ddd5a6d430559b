"""Interface of a seal type: names, sizes, faults, groove, contact, outline, finite elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Literal, NamedTuple

from ..base.dataclass import dataclass
from ..base.numeric import Array
from .contact import SealContact, Shape, SizeField

if TYPE_CHECKING:
    from ..finite_elements.section import SealSolution

AXIAL_PLAY = 1.1
"""Default ratio of groove width to seal width. Our choice: 10 % clearance for motion and swell."""


@dataclass(frozen=True, slots=True)
class SealSizes:
    """Dimensions and properties of a seal by name, SI, and the names of its laws.

    Parameters
    ----------
    numbers : floats, or arrays that broadcast. From the design file: `section`, `squeeze` and every
        size of the type. In addition: `gland_depth`, `groove_width`, `diameter` of the counterface,
        `youngs_modulus` of the squeezed part, sealed `pressure`, and `squeeze_left`, the squeeze
        that remains under pressure; `hardness` if needed; `face_modulus` and `face_poissons_ratio`
        of the sliding face if `face` of the type is true
    law : contact law of a round ring (`models.seals.LAWS`)
    hardness_model : law that gives the modulus of the rubber from its hardness
        (`models.elastomer.MODULUS_LAWS`)
    on_rod : whether the counterface is a rod, not a bore
    """

    numbers: Mapping[str, Array]
    law: str = "energised"
    hardness_model: str = "gent"
    on_rod: bool = True

    def __getitem__(self, name: str) -> Array:
        return self.numbers[name]


class SizeFault(NamedTuple):
    """A size that contradicts other sizes: its key, what is wrong, and the remedy."""

    key: str
    message: str
    remedy: str


class SealPart(NamedTuple):
    """Piece of seal compound in a groove: section area before mounting [m^2], centre depth [m]."""

    area: Array
    depth: Array


class SealGroove(NamedTuple):
    """Groove of a seal without back-up rings.

    Parameters
    ----------
    depth : depth from the counterface at nominal squeeze [m]
    ring_width : axial width of the seal [m]
    width : default groove width [m]
    pieces : pieces of the seal compound in the groove
    """

    depth: Array
    ring_width: Array
    width: Array
    pieces: tuple[SealPart, ...]


class Room(NamedTuple):
    """Space for a seal between its back-up rings: axial positions of both ends, and depth [m]."""

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
    solve : function that computes the contacts of a single seal (its numbers are floats, not
        arrays) at increasing sealed pressures [Pa], for a groove width without back-up rings [m].
        It imports the finite-element modules only when called
    note : remark for the user on how far the contact peak depends on the mesh
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
    help : explanation of the name, for the JSON Schema
    fields : sizes that a design may state for this type
    faults : function that yields the contradictions between sizes (floats by key)
    groove : function that computes the groove from `section`, `squeeze` and the required sizes
        (floats or arrays by key)
    contact : function that computes the contact of a seal
    outline : function that draws the outline of the mounted seal, from sizes (floats by key) and
        the available space
    round_ring : whether the squeezed part is a round ring. Its contact then follows from a law of
        `LAWS` and its modulus from its hardness; each law is valid for a range of squeeze or
        hardness
    modulus_by : source of the modulus of the squeezed part. "hardness": always its hardness,
        because the modulus in the data of the compound is that of the plastic ring; "stated": the
        modulus in the data of the compound or, if there is none, the hardness
    face : whether the contact depends on the elastic constants of the sliding face
    o_ring_gland : whether the seal is an O-ring alone in a standard gland; gland fill, stretch and
        section are then checked, and the standard sizes and compounds of O-rings apply
    model : function that computes the line load; reports cite its sources. None if the line load
        follows from a law of `LAWS`
    contact_model : description of this model for reports; {law} is replaced by the name of the law
    warnings : function that yields reasons to doubt the contact of a seal
    elements : finite-element solution; None if the type has none
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
        """Keys of the sizes of this type in a design file."""
        return tuple(field.key for field in self.fields)

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """Keys of the sizes that a design must state, as they have no default."""
        return tuple(field.key for field in self.fields if field.default is None)

    @property
    def width_key(self) -> str:
        """Key of the axial width of the seal; for a round ring, that of its section diameter."""
        return "width" if "width" in self.keys else "section"

    def sizes(
        self, stated: Mapping[str, Array], *, section: Array, gland_depth: Array
    ) -> dict[str, Array]:
        """All sizes of the type; a size that is not stated has its default, if it has one.

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
