"""Terms of results and reports that are neither a key of a design file nor a metric."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import NamedTuple


class GlossaryTerm(NamedTuple):
    """A term with its definition, its source, other words for it, and names to look up next."""

    name: str
    aliases: tuple[str, ...]
    definition: str
    source: str
    related: tuple[str, ...]


_ROWS = """
PATH | Name of one value of a design: keys joined by dots, the index or name of a list entry in brackets, such as cylinder.bore or load_cases[stance].force. Used by --set, --vary, variables, choices and scripts. | our choice | variable, cylinder.bore
metric | A result that an evaluation computes, such as stiffness_min. It has a value in every load case and place; the governing one is printed. | our choice | requirement, check, governing value
governing value | Value of a metric that is compared with its limit: the largest if a maximum is required or the metric is minimised, the smallest if a minimum is required or it is maximised; else the worst by the table of metrics. | our choice | metric, margin
requirement | A smallest (min) or largest (max) value of a metric that the design must have in every load case. `optimise` meets all requirements; their prices say what each costs. | our choice | metric, margin, price, check
check | A line of the professional check list: a metric with a usual limit and its source. `optimise` meets all checks except advice and waived ones. | our choice | requirement, waiver
advice | A line of the check list that gives a warning if it is missed, but that the optimiser need not meet. A requirement on the same metric makes it a limit; a waiver accepts the miss. | our choice | check, waiver, requirement
scenario | A file that simulates a design: the valve signal or motion over time, the load, and what to change in the design. `init --scenario DESIGN` writes one, `simulate` runs it. | our choice | set, load case, duty cycle
set / unset | What a scenario changes in its design, by PATH. The list "unset: [cushion]" removes keys and blocks, which then take their defaults; after that "set" gives values. On the command line: --unset and --set. | our choice | PATH
waiver | A check that does not apply, with the reason, under `waivers` in the design file. Reports print it. | our choice | check
load case | A single state that the actuator must carry: direction, force or joint torque, speed, position, temperature, side load. Every requirement holds in every load case. | our choice | load_cases, requirement
duty cycle | A course of motion and load over time from a CSV file, with its repeats in a life, under `duty.cycles` in the design file. A load case is one state; a cycle has thousands. | our choice | load case, duty
bound / bounds | Smallest or largest value that a variable may have, under `variables` in the design file. An optimum at a bound may improve if the bound is wider. | our choice | variable, optimum
variable | A number that the optimiser may move between two bounds, under `variables` in the design file. All other numbers are fixed. | our choice | objective, choices
objective | The metric that `optimise` makes as small or as large as possible, or a weighted sum of metrics, each divided by its value in the file. | our choice | variable, optimum
margin | Distance from a limit as a share of it: (value - limit)/abs(limit) for a minimum, with the opposite sign for a maximum. Met if at least -1e-6. If the limit is 0, the margin is the value itself. | our choice | requirement, reserve
reserve / no reserve / without reserve | A limit met with a margin below 0.1 % has no reserve: an optimum lies on such limits, and tolerances make some of the built actuators miss them. | our choice, IT7 of ISO 286-1 at 20 mm | margin, yield
price | Change of the best objective per unit of a limit or fixed number: what the requirement costs. It is the derivative of the Lagrangian at the optimum, exact for small changes. | [Fiacco1983] | KKT, active limit, sensitivity
sensitivity | Another word for price; also the command that lists all prices, each solved again at +-10 %. | [Fiacco1983] | price, influence
influence | Relative change of a metric per relative change of a number of the design, in % per %, with all other numbers fixed. It is not a price: the design is not optimised again. | [Squire1998] | price
active limit / at its limit / just met | A limit that the optimum just meets. It holds the design: the objective would be better without it. | [NocedalWright2006] | KKT, price
multiplier | Factor of a limit in the Lagrangian; positive for an active limit, 0 for others. Prices follow from the multipliers. | [NocedalWright2006] | KKT, price
KKT / KKT residual / stationary | Karush-Kuhn-Tucker conditions of an optimum: the slope of the objective is balanced by those of the active limits, with multipliers that are not negative. The residual is the unbalanced share; 1e-6 or less is an optimum. | [NocedalWright2006] | multiplier, active limit
optimum | The best design found: no requirement or check is missed, and no small change of the variables improves the objective. | [NocedalWright2006] | KKT, certificate
certificate / certify / proven / gap | Proof of how far the best design is at most from the best possible one: a lower bound of the objective over the whole box of variables, by `optimise --certify`. The gap is a fraction of the objective. | [McCormick1976], [Neumaier2004] | optimum
infeasible | No design within the bounds meets every limit. `optimise` then lists the conflicting limits and changes that help. | [Chinneck2008] | requirement, variable
Pareto front | Designs of which none is better in one objective without being worse in another; by `pareto`. | [Das1999], [PascolettiSerafini1984] | knee
knee | Point of a Pareto front at which more of one objective begins to cost much of the other. | [Deb2005] | Pareto front
yield | Probability that an actuator built to the design meets every requirement, given scatter and tolerances; by `uncertainty`. Not the yield strength of a metal. | [Clopper1934] | reserve, uncertainty, yield_strength
scatter | Variation of a library value from lot to lot: coefficient of variation (CV), tolerance, or factor. | our choice | yield, confidence
confidence / unverified / verified | How well a library value was checked. verified: read in its primary source; secondary: in another source; unverified: from memory or a rule; derived: computed from others. | our choice | scatter
basis | Statistics of a library strength: mean, typical, A (99 %) or B (90 % of the population, with 95 % confidence), S (specification), minimum. | CMH-17 practice | knock-down
knock-down | Factor from a library strength to an allowable one: temperature, moisture, basis of the statistics, process. | our choice | basis, basis_knockdown
extrapolated / in range / valid range | A model was used outside its valid range, or a library value outside its data. The result is marked and warns. | our choice | confidence
safety factor / factor of safety | Strength divided by load: burst, proof, buckling, fatigue and other metrics that end in _factor. Their limits are requirements, or usual limits of the check list. | our choice | requirement, check, burst_factor
working pressure | Supply pressure of the design, gauge. Burst and proof factors are relative to it. | ISO 10100 practice | supply.pressure, proof pressure
proof pressure / proof | Test pressure that must leave no permanent damage: supply.proof_ratio times the supply pressure. | ISO 10100 practice | proof_factor, supply.proof_ratio
first-ply failure | First damage of any ply of a laminate, by the criterion of barrel.criterion; without a liner it is the leak pressure. | [Jones1999] | first_ply_factor, burst_factor
lay-up / layup / laminate | Layers of a wound tube from the bore outwards, each with material, angle to the axis and thickness; 90 deg is a hoop layer. | [Jones1999] | barrel.layup
autofrettage | One-time pressure that yields the liner, so that it stays under compression and bears more pressure cycles. | [Hill1950] | barrel.autofrettage_pressure, reverse_yield_factor
squeeze | Radial compression of a seal as a share of its free cross-section. Bore growth and tolerances reduce it. | [EngineersEdgeGlands] | seal_squeeze, seal_gap
extrusion gap | Radial gap that the pressure can press the seal into: clearance plus bore growth at the seal. | [SealAndDesignExtrusion] | seal_gap, extrusion_factor
breakaway | Friction that must be overcome to start sliding; larger than running friction. | [ArmstrongHelouvry1994] | friction_breakaway, Stribeck curve
Stribeck curve | Friction against speed: it falls from breakaway to running friction over the Stribeck speed, then rises with the viscous part. | [ArmstrongHelouvry1994] | breakaway, LuGre model
LuGre model | Friction model with bristles: stiffness before sliding, the Stribeck curve while sliding; used in simulations and fitted by `identify`. | [ArmstrongHelouvry1994] | Stribeck curve
secant damping | Friction divided by speed at the stated speed; not the slope of the friction. | [Huang2017] | damping_seal, damping_ratio
dead volume | Oil in a chamber with the piston at its end, including ports. It lowers the stiffness. | [Merritt1967] | cylinder.dead_volume_a, stiffness_oil
seed | Number that starts the random samples of a search; the same seed gives the same result. | our choice | optimum
degenerate optimum / vertex / degenerate | Optimum with more active limits than variables. A limit then may have one price for an increase and another for a decrease. | [Gauvin1982] | price, active limit
Sobol index / Sobol / Sobol indices | Share of the scatter of a metric that one input causes, alone or together with others; by `uncertainty`. | [Saltelli2010] | scatter, yield
spec hash | Short code of all inputs of a result: design, material data and program version. Equal codes mean equal inputs. | our choice | run, seed
run | Record of an `optimise`, `pareto` or `sweep`: input, versions, seed and result; see `runs list`. | our choice | seed
display unit | Unit of a quantity on terminal, in reports and CSV. JSON and scripts use SI. | our choice | PATH
"""
"""A term a line: name and other words for it, definition, source, names to look up next."""


@cache
def terms() -> Mapping[str, GlossaryTerm]:
    """All terms by name."""
    rows = [[cell.strip() for cell in line.split("|")] for line in _ROWS.strip().splitlines()]
    known = {}
    for names, definition, source, related in rows:
        name, *aliases = (word.strip() for word in names.split("/"))
        see = tuple(word.strip() for word in related.split(","))
        known[name] = GlossaryTerm(name, tuple(aliases), definition, source, see)
    return known
