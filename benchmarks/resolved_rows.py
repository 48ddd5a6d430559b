"""Every re-solved end of a sensitivity table against an optimisation of its own; run by hand.

    python benchmarks/resolved_rows.py DESIGN.yaml [MORE.yaml ...] [--starts N] [--seeds N]

Each end is the file read again with the parameter replaced and searched from many starts, without
any knowledge of the unchanged optimum. Exit status 1 where one of them disagrees.
"""

from __future__ import annotations

import argparse
import sys
import time

from actuator_opt import api as verbs
from actuator_opt.base.errors import InputError

SAME = 1e-6
"""Relative difference of two objectives that is none."""


def searched(file: str, path: str, value: float, starts: int, seeds: int) -> float | None:
    """Best objective over the seeds with one number of the file replaced; None if infeasible."""
    found = []
    for seed in range(seeds):
        try:
            actuator = verbs.read(file, set={path: repr(value)})
            best = verbs.optimise(actuator, prices=False, starts=starts, seed=seed)
        except InputError as error:
            print(f"    {path} = {value:g}: {error}")
            return None
        if best.infeasibility is None and all(r.met for r in best.evaluation.requirements):
            found.append(best.objective_value)
    return min(found, default=None)


def judged(table: float | None, search: float | None) -> str:
    """How the two compare, in words."""
    if table is None or search is None:
        return "same" if table is search else "MISSED BY TABLE" if table is None else "not found"
    if abs(table - search) <= SAME * abs(search):
        return "same"
    return "TABLE WORSE" if table > search else "table better"


def main() -> int:
    """Print every end of every design; count those where the table is worse."""
    parser = argparse.ArgumentParser()
    parser.add_argument("designs", nargs="+")
    parser.add_argument("--starts", type=int, default=8)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--rows", type=int, default=None, help="only the first rows")
    asked = parser.parse_args()
    wrong = 0
    for file in asked.designs:
        best = verbs.optimise(file)
        print(f"{file}: {best.objective_value:.9g}", flush=True)
        for row in best.sensitivities[: asked.rows]:
            for sign, end in ((1, row.resolved_10), (-1, row.resolved_minus10)):
                began = time.perf_counter()
                found = searched(
                    file, row.parameter, row.limit * (1 + 0.1 * sign), asked.starts, asked.seeds
                )
                verdict = judged(end, found)
                wrong += verdict.isupper()
                print(
                    f"  {row.parameter:45} {10 * sign:+d} %  table {end!s:22} search {found!s:22}"
                    f" {verdict}  ({time.perf_counter() - began:.1f} s)",
                    flush=True,
                )
    print(f"{wrong} ends where the search is better")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
