"""Duty cycles of random designs against a second program, `cases/duty_oracle.py`, to 1e-6."""

from __future__ import annotations

from math import inf, sqrt

import duty_oracle as oracle
import numpy as np
import pytest
from duty_case import LINKAGE

import actuator_opt as ao
from actuator_opt.evaluation.kernel import duty_numbers, duty_results, statics
from actuator_opt.evaluation.limits import MetricArrays

BAR = 1e5
TOLERANCE = 1e-6
BASE = "designs/servo_knee.yaml"


# ---- random designs ----


def wave(random, t, *, middle, size, waves=4):
    """A sum of sines over the period of `t`, repeated at its end."""
    u = (t - t[0]) / (t[-1] - t[0])
    parts = [
        random.normal() / k * np.sin(2 * np.pi * (k * u + random.uniform()))
        for k in range(1, waves)
    ]
    y = np.sum(parts, axis=0)
    y = middle + size * y / np.max(np.abs(y))
    y[-1] = y[0]
    return y


def random_cycle(random, name, *, joint, arm):
    """Text of the file, lines of the block, and the same numbers for the oracle."""
    count = int(random.integers(24, 60))
    closed = bool(random.uniform() < 0.7)
    t = np.cumsum(random.uniform(0.5, 1.5, count))
    t = 0.3 + (t - t[0]) * random.uniform(0.6, 3.0) / t[-1]
    motion = wave(random, t, middle=-0.35, size=0.35) if joint else wave(
        random, t, middle=0.055, size=0.04
    )  # fmt: skip
    size = 120.0 if joint else 2500.0
    load = wave(random, t, middle=random.uniform(-0.3, 0.3) * size, size=size, waves=6)
    if random.uniform() < 0.3:  # a rest, in which the load goes on
        motion[8:12] = motion[8]
    if not closed:
        motion, load, t = motion[: 2 * count // 3], load[: 2 * count // 3], t[: 2 * count // 3]
    column = None
    if not joint and random.uniform() < 0.5:
        column = wave(random, t, middle=120 * BAR, size=20 * BAR)
    stated = {
        "repeats": float(10 ** random.uniform(4, 7)), "starts": float(random.integers(0, 5000)),
        "torque_scale" if joint else "force_scale": random.uniform(0.5, 1.5),
        "time_scale": random.uniform(0.7, 1.4),
    }  # fmt: skip
    also = [float(x) for x in random.uniform(0, 1, int(random.integers(0, 3)))] if closed else []
    level = float(random.uniform(90, 150)) * BAR if column is None else None
    if random.uniform() < 0.5:
        level = None
    lines = [f"{key}: {value!r}" for key, value in stated.items()]
    lines += [f"closed: {str(closed).lower()}"]
    lines += [f"lever_arm: {arm!r} m"] if arm else []
    lines += [f"supply_pressure: {level!r} Pa"] if level else []
    lines += [f"also: [{', '.join(f'{{phase: {x!r}}}' for x in also)}]"] if also else []
    names = "joint_angle [rad],joint_torque [N*m]" if joint else "position [m],force [N]"
    columns = [t, motion, load]
    if column is not None:
        names, columns = names + ",supply_pressure [Pa]", [*columns, column]
    rows = [",".join(map(repr, map(float, row))) for row in zip(*columns, strict=True)]
    file = "\n".join(f"        {row}" for row in [f"time [s],{names}", *rows])
    text = f"    - name: {name}\n      file: |\n{file}\n" + "".join(f"      {x}\n" for x in lines)
    return text, {
        "time": t, "motion": motion, "load": load, "joint": joint, "closed": closed,
        "lever_arm": arm, "supply_pressure": level, "supply_column": column, "phase": 0.0,
        "also": also, "load_scale": stated["torque_scale" if joint else "force_scale"],
        "time_scale": stated["time_scale"], "repeats": stated["repeats"],
        "starts": stated["starts"],
    }  # fmt: skip


def random_design(seed):
    """A design with a cycle of a joint and one of a rod, and what the oracle needs of its file."""
    random = np.random.default_rng(seed)
    arm = float(random.uniform(0.04, 0.07)) if random.uniform() < 0.4 else None
    bend, walk = random_cycle(random, "bend", joint=True, arm=arm)
    press, hold = random_cycle(random, "press", joint=False, arm=None)
    lines, lined = "", bool(random.uniform() < 0.6)
    pipes = []
    if lined:
        for chamber in "ab":
            pipe = {
                "length": float(random.uniform(0.1, 1.5)),
                "inner_diameter": float(random.uniform(4e-3, 7e-3)),
                "loss_coefficient": float(random.uniform(0, 3)),
            }
            pipes.append({"chamber": chamber, **pipe})
            sizes = "".join(
                f", {key}: {value!r}{'' if key.startswith('loss') else ' m'}"
                for key, value in pipe.items()
            )
            sizes += ", material: steel_e355, rigid: true, outer_diameter: 10 mm"
            lines += f"  - {{chamber: {chamber}, type: pipe{sizes}}}\n"
        lines = f"lines:\n{lines}"
    tank = float(random.uniform(20, 80)) if random.uniform() < 0.5 else None
    supply = {
        "pump_efficiency": random.uniform(0.7, 0.95), "motor_efficiency": random.uniform(0.7, 0.95),
        "pressure_drop": random.uniform(8, 40) * BAR, "mission_time": random.uniform(600, 2e4),
        "specific_energy": random.uniform(0.4e6, 0.8e6), "pump_mass": random.uniform(5e-4, 2e-3),
        "cooler_mass": random.uniform(0.02, 0.05), "accumulator_mass": random.uniform(1e3, 2e3),
        "other_mass": random.uniform(0, 1),
    }  # fmt: skip
    units = {
        "pressure_drop": " Pa", "mission_time": " s", "specific_energy": " J/kg",
        "pump_mass": " kg/W", "cooler_mass": " kg*K/W", "accumulator_mass": " kg/m^3",
        "other_mass": " kg",
    }  # fmt: skip
    own = {
        "standby": float(random.uniform(0, 1e6)), "oil_supply": float(random.uniform(300, 330)),
        "ambient": float(random.uniform(260, 290)), "air_speed": float(random.choice([0, 2.0])),
        "emissivity": float(random.uniform(0.1, 0.9)), "opening_limit": 0.9,
    }  # fmt: skip
    thermal = str(random.choice(["worst", "mean"]))
    temperatures = f"  tank: {{cooler_conductance: {tank!r} W/K}}\n" if tank else (
        f"  oil_supply: {own['oil_supply']!r} K\n"
    )  # fmt: skip
    duty = (
        f"duty:\n  cycles:\n{bend}{press}  standby: {own['standby']!r} s\n{temperatures}"
        f"  ambient: {own['ambient']!r} K\n  air_speed: {own['air_speed']!r} m/s\n"
        f"  emissivity: {own['emissivity']!r}\n  thermal: {thermal}\n"
        "  wear:\n    piston: {rate: 2e-17 m^2/N, depth: 0.1 mm}\n"
        "    rod: {rate: 3e-17 m^2/N, depth: 0.2 mm}\n"
        "  supply:\n"
        + "".join(f"    {key}: {float(x)!r}{units.get(key, '')}\n" for key, x in supply.items())
    )
    with open(BASE) as file:
        base = file.read()
    text = base.replace("load_cases:", f"{'' if arm else LINKAGE}{duty}{lines}\nload_cases:", 1)
    flows = random.uniform(6, 20), random.uniform(0, 0.4)
    changed = {
        "cylinder.bore": f"{random.uniform(21, 26)} mm",
        "rod.outer_diameter": f"{random.uniform(11, 14)} mm",
        "supply.pressure": f"{random.uniform(150, 210)} bar",
        "supply.return_pressure": f"{random.uniform(1, 10)} bar",
        "valve.rated_flow": f"{flows[0]} l/min",
        "valve.leakage_flow": f"{flows[1]} l/min",
    }
    actuator = ao.read(text, set=changed)
    cycles = {"bend": walk, "press": hold}
    return actuator, cycles, own | {
        "lines": pipes, "tank": tank, "supply_block": supply, "thermal_basis": thermal,
        "flows": flows,
    }  # fmt: skip


def given_numbers(actuator, own):
    """Numbers of the file in SI, and results of models that do not see the cycles."""
    subject = actuator.subject()
    v = subject.values()
    models, rows = duty_numbers(subject, v)
    numbers = dict(zip(models.names, rows[:, 0].tolist(), strict=True))
    computed = duty_results(subject, v)
    design, plan = subject.design, models.plan
    edge = own["flows"][0] / 60000 / sqrt(35 * BAR)
    leak = own["flows"][1] / 60000 / sqrt(50 * BAR)
    bore, rod = design.cylinder.bore, design.rod.outer_diameter
    seals = []
    for i, ring in enumerate(plan.rings):
        seal = {
            key: numbers[f"seal{i}.{key}"]
            for key in ("breakaway_ratio", "stribeck_speed", "viscous_friction")
        }
        for key in ("coulomb", "contact"):
            powers = [numbers[f"seal{i}.{key}[{power}]"] for power in (2, 1, 0)]
            seal[key] = np.polyval(powers, numbers["supply"] * np.array([0.0, 0.5, 1.0])).tolist()
        seals.append(seal | {"name": ring.name, "label": ring.label})
    parts = []
    for i, part in enumerate(plan.parts):
        found = {
            key: numbers.get(f"part{i}.{key}")
            for key in ("span", "offset", "slope", "ultimate", "limit", "limit_cycles", "life")
        }
        words = ("place", "load", "bolted", "only_tension")
        parts.append(found | {word: getattr(part, word) for word in words})

    def material(name, *keys):
        return next(x for key in keys if (x := subject.numbers.get(f"materials.{name}.{key}")))

    geometry = statics(subject, v, MetricArrays()).base.geometry
    k = "thermal_conductivity_through", "thermal_conductivity"
    oil = design.fluid.material
    u = own | {
        "bore": bore, "area_a": np.pi / 4 * bore**2, "area_b": np.pi / 4 * (bore**2 - rod**2),
        "stroke": design.cylinder.stroke, "supply": design.supply.pressure,
        "drain": design.supply.return_pressure, "leak_a": leak, "leak_b": leak,
        "piston_leakage": numbers["piston_leakage"], "other_friction": numbers["other_friction"],
        "closed_length": numbers["closed_length"], "base_radius": 0.25, "crank_radius": 0.062,
        "angle_offset": np.radians(120), "seals": seals, "parts": parts,
        "actuator_mass": float(np.squeeze(computed.metrics["mass"][""]))
        + float(np.squeeze(computed.metrics["mass_oil"][""])),
        "oil": {
            "density": numbers.get("density"), "viscosity": numbers.get("dynamic_viscosity"),
            "density_thermal": material(oil, "density"),
            "specific_heat": material(oil, "specific_heat"), "conductivity": material(oil, *k),
        },
        "thermal": {
            "wall_length": float(np.squeeze(geometry.wall_length)),
            "rod_diameter": rod, "rod_extension": design.rod.extension,
            "layers": [
                {"thickness": x.thickness, "k": material(x.material, *k)}
                for x in design.barrel.layup
            ],
        },
    }  # fmt: skip
    u |= dict.fromkeys(("feed_a", "feed_b", "drain_a", "drain_b"), edge)
    return computed, u


# ---- comparison ----


class Deviations(dict):
    """Largest relative deviation by quantity."""

    def add(self, name, found, expected, scale=0.0):
        """Count a value; `scale` bounds the size that the deviation is related to."""
        found = float(np.squeeze(found))
        if not np.isfinite(expected):
            error = 0.0 if found == expected else inf
        else:
            error = abs(found - expected) / max(abs(expected), scale, 1e-300)
        self[name] = max(self.get(name, 0.0), error)


def deviations(seed):
    """Largest deviation of every quantity of a random design."""
    actuator, cycles, own = random_design(seed)
    computed, u = given_numbers(actuator, own)
    found = computed.metrics
    result = Deviations()
    courses, sums = {}, {}
    for name, cycle in cycles.items():
        courses[name], sums[name] = oracle.course_of(cycle, u)
        compare_cycle(result, name, courses[name], sums[name], found, u)
    damage = oracle.fatigue(courses, cycles, u)
    assert set(damage) == set(found["duty_fatigue"])
    for place, value in damage.items():
        result.add("damage", found["duty_fatigue"][place], value, scale=1e-30)
    way = sum(cycles[n]["repeats"] * sums[n]["way"] for n in cycles)
    result.add("sliding distance", found["duty_sliding"][""], way)
    for i, seal in enumerate(u["seals"]):
        rate, allowed = (2e-17, 1e-4) if seal["name"] == "piston" else (3e-17, 2e-4)
        depth = rate * sum(cycles[n]["repeats"] * sums[n]["severity"][i] for n in cycles)
        result.add("wear", found["duty_wear"][seal["label"]], depth)
        result.add("wear share", found["duty_wear_share"][seal["label"]], depth / allowed)
    compare_supply(result, sums, cycles, found, u)
    return result


def compare_cycle(result, name, course, sums, found, u):
    """Quantities of one cycle."""

    def metric(key, place=name):
        return found[f"duty_{key}"][place]

    scale = u["supply"] * u["area_a"] * sums["way"]
    for key in ("supply_energy", "work_out", "work_in", "throttling_energy", "friction_energy",
                "leakage_energy"):  # fmt: skip
        result.add(key, metric(key), sums[key], scale=1e-6 * scale)
    result.add("efficiency", metric("efficiency"), sums["work_out"] / sums["supply_energy"], 1e-6)
    result.add("mean flow", metric("flow_mean"), sums["volume"] / sums["duration"])
    result.add("mean power", metric("power_mean"), sums["supply_energy"] / sums["duration"])
    result.add("peak flow", metric("flow_peak"), course["flow"].max())
    result.add("peak power", metric("power_peak"), course["power"].max())
    result.add("absorbed power", metric("power_absorbed"), -course["power"].min())
    result.add("opening", metric("opening"), course["opening"].max())
    result.add("force reserve", metric("force_margin"), course["reserve"].min(), 1e-3 * scale)
    result.add("least supply", metric("supply_needed"), course["needed"].max())
    share = (course["needed"] / course["p_s"]).max()
    result.add("supply share", metric("supply_share"), share)
    for chamber, key in (("A", "a"), ("B", "b")):
        place = f"{name}, chamber {chamber}"
        p = course[key]
        result.add("lowest pressure", metric("pressure_min", place), p.min(), 1e-3 * u["supply"])
        result.add("highest pressure", metric("pressure_max", place), p.max())
        ratio = (p.min() + oracle.AIR) / oracle.AIR
        result.add("suction", metric("suction_ratio", place), ratio, 1.0)
    result.add("travel left", metric("stroke_margin", f"{name}, retracted"), course["x"].min())
    spare = u["stroke"] - course["x"].max()
    result.add("travel left", metric("stroke_margin", f"{name}, extended"), spare)
    for i, seal in enumerate(u["seals"]):
        pv = (course["contact"][:, i] * np.abs(course["v"])).max()
        result.add("pV", metric("pv", f"{name}, {seal['label']}"), pv)
    result.add("ripple volume", metric("ripple_volume"), sums["ripple"])


def compare_supply(result, sums, cycles, found, u):
    """Supply side and temperatures."""
    side = oracle.supply(sums, cycles, u)
    result.add("mean power of a life", found["duty_power_mean"]["all cycles"], side["power"])
    result.add("gas volume", found["duty_gas_volume"][""], side["gas"])
    result.add("system mass", found["system_mass"][""], side["mass"])
    inlet = u["oil_supply"]
    if side["tank"] is not None:
        result.add("tank temperature", found["duty_tank_temperature"][""], side["tank"])
        inlet = side["tank"]
    if u["thermal_basis"] == "worst":
        means = {n: oracle.means_of([n], sums, cycles, u, standby=None) for n in cycles}
    else:
        means = {
            "mean of all cycles": oracle.means_of([*cycles], sums, cycles, u, standby=u["standby"])
        }
    for name, mean in means.items():
        state = oracle.steady(mean, inlet, u)
        result.add("oil temperature", found["duty_oil_temperature"][name], state["oil"])
        seal = found["duty_seal_temperature"]
        result.add("piston seal temperature", seal[f"{name}, piston seal"], state["layer"])
        result.add("rod seal temperature", seal[f"{name}, rod seal"], state["rod"])
        faces = [x for place, x in found["duty_wall_temperature"].items() if place.startswith(name)]
        for face, value in zip(faces, state["faces"], strict=True):
            result.add("wall temperature", face, value)


@pytest.mark.parametrize(
    "seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(3, 200))]
)
def test_a_second_program_finds_the_same(seed):
    """Every quantity of a random design and its cycles."""
    found = deviations(seed)
    assert len(found) > 25
    assert {name: error for name, error in found.items() if not error < TOLERANCE} == {}
