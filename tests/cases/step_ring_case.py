"""The step ring whose finite elements are tested and drawn."""

from __future__ import annotations

from actuator_opt.finite_elements.material import MooneyRivlin
from actuator_opt.finite_elements.mesh import SlideRing
from actuator_opt.finite_elements.step_ring import squeezed_step_ring

SECTION, SQUEEZE, MODULUS = 2.62e-3, 0.15, 8e6
RUBBER = MooneyRivlin.of_modulus(MODULUS)
PLASTIC = MooneyRivlin.of_modulus(5e8, poissons_ratio=0.46)
SHAPE = SlideRing(
    width=4e-3,
    thickness=1.5e-3,
    land_width=0.8e-3,
    chamfer_width=0.5e-3,
    chamfer_height=0.3e-3,
    relief_angle=0.12,
    edge_radius=0.15e-3,
)


def seal(*pressures, shape=SHAPE, **more):
    """The seal above at pressures in Pa, on a coarse mesh."""
    return squeezed_step_ring(
        section=SECTION,
        squeeze=SQUEEZE,
        groove_width=shape.width + 0.2e-3,
        rubber=RUBBER,
        plastic=PLASTIC,
        shape=shape,
        pressures=pressures,
        **{"elements_around": 32, "edge_elements": 2, **more},
    )
