"""A second program for duty cycles: dense splines, own rainflow count, fixed points, root finding.

It shares no code with the program. It takes what other models compute (seal friction and contact at
three pressures, stresses of the parts under a full pulse, masses, properties of materials) as given
numbers, and repeats everything that follows from a motion.
"""

from __future__ import annotations

from math import exp, log, pi, sqrt

import numpy as np
from scipy.optimize import root

AIR = 101325.0


# ---- kinematics ----


def spline_slopes(t, y, *, closed):
    """Slopes at the knots of the C2 cubic spline: periodic, or not-a-knot; by a dense system."""
    h, d = np.diff(t), np.diff(y) / np.diff(t)
    n = len(t)
    a, b = np.zeros((n, n)), np.zeros(n)
    for i in range(1, n - 1):
        a[i, i - 1 : i + 2] = h[i], 2 * (h[i - 1] + h[i]), h[i - 1]
        b[i] = 3 * (h[i] * d[i - 1] + h[i - 1] * d[i])
    if closed:
        a[0, [0, 1]] = 2 * (h[-1] + h[0]), h[-1]
        a[0, n - 2] += h[0]
        b[0] = 3 * (h[0] * d[-1] + h[-1] * d[0])
        a[n - 1, [0, n - 1]] = 1, -1
    else:  # the third derivative, 6 (m_i + m_(i+1) - 2 d_i)/h_i^2, has no jump at the second knots
        for row, i in ((0, 0), (n - 1, n - 3)):
            a[row, i : i + 3] = 1 / h[i] ** 2, 1 / h[i] ** 2 - 1 / h[i + 1] ** 2, -1 / h[i + 1] ** 2
            b[row] = 2 * (d[i] / h[i] ** 2 - d[i + 1] / h[i + 1] ** 2)
    return np.linalg.solve(a, b)


def kinematics(cycle, u):
    """Position, speed, force and time of a cycle, from its file's columns and its scales."""
    t = cycle["time"] * cycle["time_scale"]
    rate = spline_slopes(t, cycle["motion"], closed=cycle["closed"])
    if not cycle["joint"]:
        return t, cycle["motion"], rate, cycle["load_scale"] * cycle["load"]
    if cycle["lever_arm"] is not None:
        arm = cycle["lever_arm"]
        middle = 0.5 * (cycle["motion"].max() + cycle["motion"].min())
        x = u["stroke"] / 2 + arm * (cycle["motion"] - middle)
        return t, x, arm * rate, cycle["load_scale"] * cycle["load"] / arm
    base, crank = u["base_radius"], u["crank_radius"]
    phi = cycle["motion"] + u["angle_offset"]
    pins = crank * np.cos(phi) - base, crank * np.sin(phi)  # crank pin seen from the fixed pivot
    length = np.hypot(*pins)
    arm = base * crank * np.sin(phi) / length
    return t, length - u["closed_length"], arm * rate, cycle["load_scale"] * cycle["load"] / arm


# ---- pressures ----


def line_drop(line, flow, oil):
    """Drop of a smooth line and its fittings; laminar to Re 2300, Blasius from 4000."""
    speed = 4 * flow / (pi * line["inner_diameter"] ** 2)
    re = speed * line["inner_diameter"] * oil["density"] / oil["viscosity"]
    if re == 0:
        return 0.0
    w = min(max((re - 2300) / 1700, 0), 1)
    w = w * w * (3 - 2 * w)
    factor = (1 - w) * 64 / re + w * 0.3164 * max(re, 2300) ** -0.25
    head = 0.5 * oil["density"] * speed**2
    return head * (factor * line["length"] / line["inner_diameter"] + line["loss_coefficient"])


def between(values, share):
    """Lagrange's parabola through values at 0, 1/2 and 1."""
    z = share
    return (
        values[0] * (1 - 2 * z) * (1 - z)
        + values[1] * 4 * z * (1 - z)
        + values[2] * z * (2 * z - 1)
    )


def seal_friction(seal, share, speed):
    """Stribeck's curve of exponent 2 over the Coulomb friction at a sealed pressure."""
    coulomb = between(seal["coulomb"], share)
    bump = (seal["breakaway_ratio"] - 1) * exp(-((speed / seal["stribeck_speed"]) ** 2))
    return coulomb * (1 + bump) + seal["viscous_friction"] * abs(speed)


def at_sample(u, p_s, v, force):
    """All of one sample: friction and pressures in turns, two passes after the first."""
    out = v >= 0
    sign = 1.0 if out else -1.0
    driven, other = (u["area_a"], u["area_b"]) if out else (u["area_b"], u["area_a"])
    feed, drain = (u["feed_a"], u["drain_b"]) if out else (u["feed_b"], u["drain_a"])
    c = (other / driven) ** 2 * (feed / drain) ** 2
    drop = {
        side: sum(
            line_drop(line, u[f"area_{side}"] * abs(v), u["oil"])
            for line in u["lines"]
            if line["chamber"] == side
        )
        for side in "ab"
    }
    into, away = (drop["a"], drop["b"]) if out else (drop["b"], drop["a"])
    frictions = [0.0] * len(u["seals"])
    others = 0.0
    for _ in range(3):
        load = sign * force + others + sum(frictions) + driven * into + other * away
        edge = (p_s * driven - u["drain"] * other - load) / (driven + c * other)
        pressed, left = p_s - edge - into, u["drain"] + c * edge + away
        a, b = (pressed, left) if out else (left, pressed)
        others = u["other_friction"]
        sealed = [
            abs(a - b) if s["name"] == "piston" else max(b if s["name"] == "rod" else a, 0.0)
            for s in u["seals"]
        ]
        shares = [p / u["supply"] for p in sealed]
        frictions = [seal_friction(s, z, v) for s, z in zip(u["seals"], shares, strict=True)]
    load = sign * force + others + sum(frictions) + driven * into + other * away
    full = (driven + c * other) * (driven * v / (feed * u["opening_limit"])) ** 2
    needed = (load + u["drain"] * other + full) / driven
    if out:
        shut = (u["leak_b"], p_s - b), (u["leak_a"], a - u["drain"])
    else:
        shut = (u["leak_a"], p_s - a), (u["leak_b"], b - u["drain"])
    leak = sum(k * sqrt(max(dp, 0.0)) for k, dp in shut) + u["piston_leakage"] * abs(a - b)
    return {
        "a": a, "b": b, "friction": others + sum(frictions), "frictions": frictions,
        "contact": [between(s["contact"], z) for s, z in zip(u["seals"], shares, strict=True)],
        "needed": needed, "reserve": (p_s - needed) * driven, "leak": leak,
        "flow": driven * abs(v) + leak, "power": force * v, "inlet": p_s - pressed,
        "opening": driven * abs(v) / (feed * sqrt(edge)) if edge > 0 else np.inf,
    }  # fmt: skip


# ---- rainflow and damage ----


def rainflow(history):
    """(largest, smallest) of the cycles of a repeating history, by the four-point rule."""
    start = int(np.argmax(history))
    rotated = [*history[start:], *history[: start + 1]]
    turns = [rotated[0]]
    for value in rotated[1:]:
        if value == turns[-1]:
            continue
        if len(turns) > 1 and (value > turns[-1]) == (turns[-1] > turns[-2]):
            turns[-1] = value
        else:
            turns.append(value)
    cycles, stack = [], []
    for value in turns:
        stack.append(value)
        while len(stack) >= 4:
            p, q, r, s = stack[-4:]
            if not (min(p, s) <= min(q, r) and max(q, r) <= max(p, s)):
                break
            cycles.append((max(q, r), min(q, r)))
            del stack[-3:-1]
    if len(stack) == 3:
        cycles.append((stack[0], stack[1]))
    return cycles


def damage_of(part, high, low):
    """1/N of one cycle between two shares of the full pulse."""
    if part["only_tension"]:
        high, low = max(high, 0.0), max(low, 0.0)
    if part["bolted"]:
        return (high - low) ** 3 / part["life"]
    amplitude = part["span"] * (high - low) / 2
    mean = part["offset"] + part["slope"] * (high + low) / 2
    if amplitude == 0:
        return 0.0
    strength = part["ultimate"]
    reversed_ = amplitude / (1 - max(mean, 0.0) / strength)
    b = log(part["limit_cycles"] / 1e3) / log(part["limit"] / (0.9 * strength))
    return 1 / (1e3 * (reversed_ / (0.9 * strength)) ** b)


def history_of(load, course, u):
    """Load of a part as a share of its full pulse, over time."""
    a, b, x = course["a"] / u["supply"], course["b"] / u["supply"], course["x"]
    if load == "rod":
        return -course["force"] / (u["supply"] * (u["area_a"] + u["area_b"]))
    middle = np.where(x > (x.max() + x.min()) / 2, a, b)
    return {"a": a, "b": b, "middle": middle}[load]


def fatigue(courses, cycles, u):
    """Miner's sum of a life for every part."""
    damage = {}
    for part in u["parts"]:
        total, highest, lowest = 0.0, -np.inf, np.inf
        alive = [name for name in cycles if cycles[name]["repeats"] is not None]
        for name in alive:
            history = history_of(part["load"], courses[name], u)
            pairs = rainflow(history)
            total += cycles[name]["repeats"] * sum(damage_of(part, *pair) for pair in pairs)
            peak = history[np.argmax(np.abs(history))]
            total += cycles[name]["starts"] * damage_of(part, max(peak, 0.0), min(peak, 0.0))
            highest, lowest = max(highest, history.max()), min(lowest, history.min())
        if len(alive) > 1:
            changes = max(cycles[name]["starts"] for name in alive)
            total += changes * damage_of(part, highest, lowest)
        damage[part["place"]] = total
    return damage


# ---- one cycle ----


def trapezoid(y, t):
    """Integral by Gauss's rule of one point on each piece of a linear interpolant."""
    middles = np.interp(0.5 * (t[1:] + t[:-1]), t, y)
    return float(np.sum(middles * np.diff(t)))


def course_of(cycle, u):
    """All samples of a cycle by name, and its sums."""
    t, x, v, force = kinematics(cycle, u)
    level = cycle["supply_pressure"] or u["supply"]
    p_s = cycle["supply_column"] if cycle["supply_column"] is not None else np.full(len(t), level)
    samples = [at_sample(u, *row) for row in zip(p_s, v, force, strict=True)]
    course = {key: np.array([s[key] for s in samples]) for key in samples[0]}
    course |= {"t": t, "x": x, "v": v, "force": force, "p_s": p_s, "level": level}
    dx = np.diff(x)
    swept = np.where(dx > 0, u["area_a"], u["area_b"]) * np.abs(dx)
    returned = np.where(dx > 0, u["area_b"], u["area_a"]) * np.abs(dx)

    def mean(y):
        return 0.5 * (y[1:] + y[:-1])

    work = mean(force) * dx
    filled = float(np.sum(mean(p_s) * swept))
    leaked = trapezoid(p_s * course["leak"], t)
    sums = {
        "duration": t[-1] - t[0],
        "way": np.abs(dx).sum(),
        "supply_energy": filled + leaked,
        "leakage_energy": leaked,
        "work_out": work[work > 0].sum(),
        "work_in": -work[work < 0].sum(),
        "friction_energy": np.sum(mean(course["friction"]) * np.abs(dx)),
        "volume": swept.sum() + trapezoid(course["leak"], t),
        "inlet": np.sum(mean(course["inlet"]) * swept) / swept.sum(),
        "swept": swept.sum(),
        "position": trapezoid(x, t) / (t[-1] - t[0]),
    }
    sums["throttling_energy"] = (
        filled - u["drain"] * returned.sum() - work.sum() - sums["friction_energy"]
    )
    sums["seal_friction"] = [
        np.sum(mean(course["frictions"][:, i]) * np.abs(dx)) for i in range(len(u["seals"]))
    ]
    sums["severity"] = [
        np.sum(mean(course["contact"][:, i]) * np.abs(dx)) for i in range(len(u["seals"]))
    ]
    return course, sums | flows_of(course, cycle) | {"exchange": exchange(x, u, cycle, sums)}


def flows_of(course, cycle):
    """Ripple volume and peak of all actuators on the supply: pieces of lines add up in pieces."""
    t, q = course["t"] - course["t"][0], course["flow"]
    period = t[-1]
    late = [(phase - cycle["phase"]) * period for phase in cycle["also"]]
    at = np.unique(np.concatenate([t, *((t + d) % period for d in late)]))
    at = at[np.append(True, np.diff(at) > 1e-12 * period)]
    total = np.interp(at, t, q) + sum(np.interp((at - d) % period, t, q) for d in late)
    steps = 0.5 * (total[1:] + total[:-1]) * np.diff(at)
    stored = np.append(0.0, np.cumsum(steps - steps.sum() / period * np.diff(at)))
    return {"ripple": stored.max() - stored.min(), "peak_of_all": total.max()}


def exchange(x, u, cycle, sums):
    """Flow of fresh oil into both chambers: each whole stroke less what the line holds."""
    runs = []
    for step in np.diff(x):
        if step and runs and (runs[-1] > 0) == (step > 0):
            runs[-1] += step
        elif step:
            runs.append(step)
    if cycle["closed"] and len(runs) > 1 and (runs[0] > 0) == (runs[-1] > 0):
        runs[0] += runs.pop()
    fresh = 0.0
    for side, sign in (("a", 1), ("b", -1)):
        held = sum(
            pi / 4 * line["inner_diameter"] ** 2 * line["length"]
            for line in u["lines"]
            if line["chamber"] == side
        )
        fresh += sum(
            max(0.0, u[f"area_{side}"] * sign * run - held) for run in runs if sign * run > 0
        )
    return fresh / sums["duration"]


# ---- supply ----


def gas_volume(delta, high, low, precharge, n):
    """Gas of an accumulator; the expanded gas fits its shell or the shell ends the discharge."""
    full = precharge / high
    end = min(full * (high / low) ** (1 / n), 1.0)
    return delta / (end - full)


def supply(sums, cycles, u):
    """Mean power, gas, heat, tank and system mass; `masses` are the specific masses."""
    s = u["supply_block"]
    count = 1 + max(len(cycle["also"]) for cycle in cycles.values())

    def over_life(each, resting):
        alive = [name for name in cycles if cycles[name]["repeats"] is not None]
        if not alive:
            return max(each[name] / sums[name]["duration"] for name in cycles)
        amount, time = u["standby"] * resting, u["standby"]
        for name in alive:
            amount += cycles[name]["repeats"] * each[name]
            time += cycles[name]["repeats"] * sums[name]["duration"]
        return amount / time

    half = (u["supply"] - u["drain"]) / 2
    rest = u["supply"] * (u["leak_a"] + u["leak_b"]) * sqrt(half)
    power = over_life({k: x["supply_energy"] for k, x in sums.items()}, rest)
    net = over_life({k: x["work_out"] - x["work_in"] for k, x in sums.items()}, 0.0)
    gas, pump = 0.0, 0.0
    for name, cycle in cycles.items():
        high = (cycle["supply_pressure"] or u["supply"]) + AIR
        low = high - s["pressure_drop"]
        n = 1.4 if sums[name]["duration"] < 60 else 1.0
        gas = max(gas, gas_volume(sums[name]["ripple"], high, low, 0.9 * low, n))
        actuators = 1 + len(cycle["also"])
        pump = max(pump, actuators * sums[name]["supply_energy"] / sums[name]["duration"])
    heat = count * (power / s["pump_efficiency"] - net)
    tank = u["ambient"] + heat / u["tank"] if u["tank"] else None
    cooler = u["tank"] or heat / (u["oil_supply"] - u["ambient"])
    energy = count * power / s["pump_efficiency"] / s["motor_efficiency"] * s["mission_time"]
    mass = count * u["actuator_mass"] + s["other_mass"]
    mass += s["pump_mass"] * pump + s["accumulator_mass"] * gas + s["cooler_mass"] * cooler
    mass += energy / s["specific_energy"]
    return {"power": power, "gas": gas, "tank": tank, "mass": mass}


# ---- temperatures ----


def air_film(surface, ambient, diameter, wind, emissivity):
    """Convection (the larger of free and forced) and radiation to air."""
    film = (surface + ambient) / 2
    eta = 1.458e-6 * film**1.5 / (film + 110.4)
    k = 2.64638e-3 * film**1.5 / (film + 245.4 * 10 ** (-12 / film))
    rho = AIR / (287.05287 * film)
    prandtl, nu = eta * 1005.0 / k, eta / rho
    rayleigh = 9.80665 / film * abs(surface - ambient) * diameter**3 / nu**2 * prandtl
    free = 0.60 + 0.387 * rayleigh ** (1 / 6) / (1 + (0.559 / prandtl) ** (9 / 16)) ** (8 / 27)
    re = abs(wind) * diameter / nu
    forced = 0.62 * sqrt(re) * prandtl ** (1 / 3) / (1 + (0.4 / prandtl) ** (2 / 3)) ** 0.25
    forced = 0.3 + forced * (1 + (re / 282000) ** (5 / 8)) ** (4 / 5)
    radiation = emissivity * 5.670374419e-8 * (surface**4 - ambient**4) / (surface - ambient)
    return max(free**2, forced) * k / diameter + radiation


def network(mean, inlet, u):
    """Conductances of nodes oil, layers, surface, rod; heats; and the surfaces in air."""
    oil, heat = u["oil"], u["thermal"]
    d, length = u["bore"], heat["wall_length"]
    rho_c = oil["density_thermal"] * oil["specific_heat"]
    graetz = mean["speed"] * d**2 * rho_c / (oil["conductivity"] * u["stroke"] / 2)
    h = (3.66 + 0.0668 * graetz / (1 + 0.04 * graetz ** (2 / 3))) * oil["conductivity"] / d
    radius, halves = d / 2, []
    for layer in heat["layers"]:
        resistance = log((radius + layer["thickness"]) / radius) / (2 * pi * length * layer["k"])
        halves.append(resistance / 2)
        radius += layer["thickness"]
    wetted = min(u["stroke"], length)
    chain = [1 / (h * pi * d * wetted) + halves[0]]
    chain += [halves[k] + halves[k + 1] for k in range(len(halves) - 1)] + [halves[-1]]
    size = len(chain) + 2
    g = np.zeros((size, size))
    joints = [(k, k + 1, 1 / r) for k, r in enumerate(chain)]
    rod = heat["rod_diameter"]
    joints.append((0, size - 1, h * pi * rod * (u["stroke"] - mean["position"])))
    for i, j, value in joints:
        g[[i, j], [i, j]] += value
        g[[i, j], [j, i]] -= value
    exchanged = rho_c * mean["exchange"]
    g[0, 0] += exchanged
    q = np.zeros(size)
    q[0] = exchanged * (inlet + mean["inlet"] / rho_c)
    q[1] = mean["piston"] + 0.5 * mean["rod"]
    q[-1] = 0.5 * mean["rod"]
    surfaces = [
        (size - 2, 2 * pi * radius * length, 2 * radius),
        (size - 1, pi * rod * (mean["position"] + heat["rod_extension"]), rod),
    ]
    return g, q, surfaces


def steady(mean, inlet, u):
    """Temperatures of oil, innermost layer, inner faces of the layers, and rod."""
    g, q, surfaces = network(mean, inlet, u)
    ambient = u["ambient"]

    def balance(temperature):
        rest = g @ temperature - q
        for k, area, diameter in surfaces:
            film = air_film(temperature[k], ambient, diameter, u["air_speed"], u["emissivity"])
            rest[k] += film * area * (temperature[k] - ambient)
        return rest

    solution = root(balance, np.full(len(q), ambient + 20.0), tol=1e-13)
    assert np.abs(solution.fun).max() < 1e-9 * np.abs(q).max()  # `success` may be False by rounding
    t = solution.x
    radius, faces = u["bore"] / 2, []
    for k, layer in enumerate(u["thermal"]["layers"]):
        outer = radius + layer["thickness"]
        ratio = log(outer / radius) / (4 * pi * u["thermal"]["wall_length"] * layer["k"])
        # heat through the inner half of the layer
        flow = -g[k, k + 1] * (t[k] - t[k + 1])
        faces.append(t[k + 1] + flow * ratio)
        radius = outer
    return {"oil": t[0], "layer": t[1], "faces": faces, "rod": t[-1]}


def means_of(names, sums, cycles, u, *, standby):
    """Means over time of some cycles of a life, or of one cycle."""
    weight = {name: cycles[name]["repeats"] if standby is not None else 1.0 for name in names}
    moving = sum(weight[n] * sums[n]["duration"] for n in names)
    time = moving + (standby or 0.0)
    total = {
        "speed": sum(weight[n] * sums[n]["way"] for n in names) / time,
        "position": sum(weight[n] * sums[n]["duration"] * sums[n]["position"] for n in names)
        / moving,
        "exchange": sum(weight[n] * sums[n]["duration"] * sums[n]["exchange"] for n in names)
        / time,
    }
    volume = {n: sums[n]["swept"] for n in names}
    total["inlet"] = sum(weight[n] * volume[n] * sums[n]["inlet"] for n in names) / sum(
        weight[n] * volume[n] for n in names
    )
    for block in ("piston", "rod"):
        total[block] = (
            sum(
                weight[n] * energy
                for n in names
                for energy, seal in zip(sums[n]["seal_friction"], u["seals"], strict=True)
                if (seal["name"] == "piston") == (block == "piston")
            )
            / time
        )
    return total
