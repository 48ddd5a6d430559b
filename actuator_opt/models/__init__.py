"""Models as pure functions in SI units; arguments may be arrays, which broadcast.

Every docstring states formula, range of validity and source.

A number outside a model's domain gives NaN, and the other elements of an array keep their values.
Impossible geometry gives NaN too: a negative length, area or volume, an outer radius not above the
inner one, a rod not inside its bore (`base.numeric.geometry`). A search without a solution, an
unknown choice, and lists of unequal lengths raise ValueError where the docstring says so.

Scripts may call every module: arguments are passed by name, and `help` shows formula, range and
source.

>>> from actuator_opt.models import rod
>>> print(f"{rod.thread_stress_area(diameter=10e-3, pitch=1.5e-3) * 1e6:.2f} mm2")
57.99 mm2

Some functions are for scripts alone; no part of the program calls them:

- `end_stop.cushion_mean_pressure`, `end_stop.cushion_open_area`: pressure and flow area of a
  cushion that brakes evenly, as input for `stops.cushion` of a scenario
- `wear.cycle_severity`: severity of a measured contact pressure, as the input of a worn depth
- `end_bending.clamped`: bending of a wall at a rigid clamp, an upper bound for any joint
- `elements.capacitance`, `elements.resonance_frequency`, `elements.sound_speed`,
  `lugre.lugre_steady_deflection`, `transmission_line.plugged_branch_impedance`,
  `stiffness_published.barrel_stiffness_as_published`,
  `stiffness_published.line_stiffness_as_published`: equations of [AaltoThesis] that the report
  of its test cylinder names
"""
