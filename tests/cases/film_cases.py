"""Contacts the tests of lubrication share: the published kinds of seal at stated inputs."""

from __future__ import annotations

import numpy as np

from actuator_opt.lubrication import Contact, Elastic, Lubricant, Surface
from actuator_opt.models.contact_profile import lip_profile
from actuator_opt.models.fluid import viscosity_astm_d341
from actuator_opt.models.seals import LAWS

AIR = 0.101e6
ROUGH = Surface(roughness=0.8e-6, asperity_density=1e14, asperity_radius=1e-6)
KINDS = ("o_ring", "lip", "step_ring")
VISCOSITIES = ((32e-6, 5.36e-6), (46e-6, 6.8e-6))
"""ISO VG 32 and 46 at 40 and 100 degC [m^2/s]."""


def o_ring_profile(*, position, sealed_pressure, outer_pressure, excess):
    """Profile behind the published check table: a falling sine plus the Hertz ellipse."""
    u = 2 * position - 1
    fall = (1 - np.sin(np.pi * u / 2)) / 2
    ellipse = np.sqrt(np.clip(1 - u * u, 0, None))
    return outer_pressure + (sealed_pressure - outer_pressure) * fall + excess * ellipse


def lip(speed, *, nodes=161, width=4e-3, sealed=5e6, outer=AIR, excess=1.5e6, **changes):
    """Polyurethane lip of the check table, or with changes to its contact."""
    static = lip_profile(
        position=np.linspace(0, 1, nodes),
        sealed_pressure=sealed,
        outer_pressure=outer,
        excess=excess,
    )
    given = {
        "elastic": Elastic(50e6, 0.48),
        "surface": ROUGH,
        "lubricant": Lubricant(0.035, "barus", 16e-9),
    }
    return Contact(
        width=width, static_pressure=static, speed=speed, sealed_pressure=sealed,
        outer_pressure=outer, **(given | changes),
    )  # fmt: skip


def o_ring(speed, *, nodes=161, width, excess, sealed=3.1e6, outer=AIR, **changes):
    """O-ring on its rod."""
    static = o_ring_profile(
        position=np.linspace(0, 1, nodes),
        sealed_pressure=sealed,
        outer_pressure=outer,
        excess=excess,
    )
    given = {
        "elastic": Elastic(8e6, 0.49),
        "surface": ROUGH,
        "lubricant": Lubricant(0.03, "barus", 16e-9),
    }
    return Contact(
        width=width, static_pressure=static, speed=speed, sealed_pressure=sealed,
        outer_pressure=outer, **(given | changes),
    )  # fmt: skip


def drag(film, friction_coefficient):
    """Drag on the rod per circumference, against a positive speed; at rest the most it holds."""
    sign = -1.0 if film.contact.speed < 0 else 1.0
    return film.viscous_drag + sign * friction_coefficient * film.contact_load


def hertz(squeeze, section, youngs_modulus):
    """Width and unpressurised peak of an O-ring by Hertz and Lindley."""
    law, ring = LAWS["hertz_lindley"], {"squeeze": squeeze, "section": section}
    ring |= {"youngs_modulus": youngs_modulus, "pressure": 0.0}
    return float(law.contact_width(**ring)), float(law.peak_pressure(**ring))


def _log(random, low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def random_case(random, kind, nodes=121):
    """One contact of a kind at random, oil at -20 to 100 degC."""
    speed = _log(random, 1e-4, 1.0) * random.choice([-1.0, 1.0])
    sealed = AIR + _log(random, 0.1e6, 40e6)
    viscosity = 870 * viscosity_astm_d341(
        temperature=random.uniform(253.15, 373.15),
        points_temperature=(313.15, 373.15),
        points_viscosity=VISCOSITIES[random.integers(2)],
    )
    law = ("none", "barus", "roelands")[random.integers(3)]
    common = {
        "nodes": nodes,
        "sealed": sealed,
        "lubricant": Lubricant(float(viscosity), law, random.uniform(12e-9, 24e-9)),
        "surface": Surface(
            roughness=_log(random, 0.3e-6, 2e-6),
            asperity_density=_log(random, 3e13, 2e14),
            asperity_radius=_log(random, 0.5e-6, 2e-6),
            rod_share=float(random.choice([0.0, 0.0, random.uniform(0, 1)])),
        ),
    }
    if kind == "o_ring":
        modulus = _log(random, 5e6, 15e6)
        width, excess = hertz(random.uniform(0.08, 0.3), random.uniform(1.78e-3, 7e-3), modulus)
        elastic = Elastic(modulus, 0.49)
        return o_ring(speed, width=width, excess=excess, elastic=elastic, **common)
    if kind == "lip":
        elastic = Elastic(_log(random, 10e6, 80e6), 0.48)
        width, excess = random.uniform(0.5e-3, 6e-3), _log(random, 0.3e6, 5e6)
        return lip(speed, width=width, excess=excess, elastic=elastic, **common)
    elastic = Elastic(_log(random, 100e6, 600e6), 0.46)
    width, excess = random.uniform(1e-3, 6e-3), _log(random, 1e6, 20e6)
    return o_ring(speed, width=width, excess=excess, elastic=elastic, **common)


def random_cases(count, seed=1):
    """Contacts of all kinds in turn."""
    random = np.random.default_rng(seed)
    return [(KINDS[i % 3], random_case(random, KINDS[i % 3])) for i in range(count)]
