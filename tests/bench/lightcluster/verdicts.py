# SPDX-License-Identifier: Apache-2.0
"""The goals, and whether a run meets them or by how much it misses."""

import math
from dataclasses import dataclass

import paper
from measure import ERROR_DRIVEN_SHARE, median_ratio

SELECTION_GOALS = ((paper.SELECTION_LIGHTS, paper.SELECTION_MS), (100_000, 100.0))  # lights, milliseconds
# Time as lights to the power of this; n log n, which sorting needs, is 1.11 between 2,048 and 100,000 lights.
LINEAR_EXPONENT = 1.12
RATIO_COUNTS = (26, 10)  # clusters of Sponza for which the goal is the paper's ratio
VISIBILITY_SHARE = 0.25  # of the paper's bytes
PREDICTION_SHARE = 0.05
PREDICTED = ("light_clusters", "shadow_maps", "shadow_views", "shadow_triangles", "shadow_bytes", "visibility_bytes")
MIB = 2**20


@dataclass
class Verdict:
    goal: str
    ours: str  # what was measured; "not measured" where nothing was
    met: bool | None = None
    missed_by: str = ""

    def text(self):
        return {True: "**met**", False: f"missed by {self.missed_by}", None: "–"}[self.met]


def not_measured(goal):
    return Verdict(goal, "not measured")


def at_least(goal, least, value, show):
    if value >= least:
        return Verdict(goal, show(value), True)
    return Verdict(goal, show(value), False, percent(1 - value / least))


def at_most(goal, most, value, show):
    if value <= most:
        return Verdict(goal, show(value), True)
    return Verdict(goal, show(value), False, percent(value / most - 1))


def percent(share):
    return f"{100 * share:.1f} %" if share >= 0.0005 else "less than 0.1 %"


def ms(value):
    return f"{value:.2f} ms" if value < 10 else f"{value:.1f} ms"


def times(value):
    return f"{value:.2f} times"


def ratio_goal(clusters, filter_name):
    """The paper's ratio, to one place."""
    return round(paper.reference_ratio("sponza", clusters, filter_name), 1)


def growth_exponent(points):
    """Least-squares slope of log time over log lights."""
    logs = [(math.log(lights), math.log(time)) for lights, time in points]
    x_mean, y_mean = (sum(column) / len(logs) for column in zip(*logs))
    return sum((x - x_mean) * (y - y_mean) for x, y in logs) / sum((x - x_mean) ** 2 for x, _ in logs)


def selection_verdicts(rows):
    verdicts = []
    for lights, most_ms in SELECTION_GOALS:
        goal = f"selection of {lights:,} lights in {most_ms:g} ms on one core, at every d_init"
        found = [row["median_ms"] for row in rows if row["lights"] == lights]
        verdicts.append(at_most(goal, most_ms, max(found), ms) if found else not_measured(goal))
    goal = (f"selection grows linearly: time as lights to the power of {LINEAR_EXPONENT} at most, from "
            f"{paper.SELECTION_LIGHTS:,} lights on")
    exponents = []
    for d_init in {row["d_init_m"] for row in rows}:
        points = [(r["lights"], r["median_ms"]) for r in rows
                  if r["d_init_m"] == d_init and r["lights"] >= paper.SELECTION_LIGHTS]
        if len(points) > 1:
            exponents.append(growth_exponent(points))
    verdicts.append(at_most(goal, LINEAR_EXPONENT, max(exponents), lambda v: f"{v:.2f}") if exponents else not_measured(goal))
    return verdicts


def searched_row(results, clusters):
    rows = results["scenes"].get("sponza", {}).get("rows", [])
    return next((row for row in rows if row["searched"] == clusters), None)


def ratio_verdicts(results):
    verdicts = []
    for filter_name in ("pcss", "pcf"):
        for clusters in RATIO_COUNTS:
            least = ratio_goal(clusters, filter_name)
            goal = f"Sponza, 80 lights: reference over {clusters} clusters with {filter_name.upper()}, {least} times"
            row = searched_row(results, clusters)
            found = row and median_ratio(row["filters"][filter_name])
            verdicts.append(at_least(goal, least, found, times) if row else not_measured(goal))
    return verdicts


def memory_verdict(results):
    most = paper.VISIBILITY_MIB * VISIBILITY_SHARE
    goal = (f"Sponza, {paper.MEMORY_CLUSTERS} clusters: visibility in a quarter of the paper's {paper.VISIBILITY_MIB} MiB, "
            f"{most:.2f} MiB")
    row = searched_row(results, paper.MEMORY_CLUSTERS)
    if not row:
        return not_measured(goal)
    return at_most(goal, most, row["counters"]["visibility_bytes"] / MIB, lambda v: f"{v:.1f} MiB")


def merging_rows(made):
    """The rows where the paper's selection lets lights share maps: with one map each there is nothing to reach."""
    return [row for row in made["rows"] if row["clusters"] < made["lights_in_view"]]


def map_share(row):
    return row["error_driven"]["shadow_maps"] / row["clusters"]


def error_ratio(row):
    return row["error_driven"]["rmse"] / row["filters"]["pcss"]["rmse"]


def error_driven_verdict(made):
    """Met where every row of the scene needs no more than the share of maps and makes no more error."""
    goal = (f"{made['title']}: error-driven selection reaches the paper's error with {100 * ERROR_DRIVEN_SHARE:.0f} % of its "
            "maps, at every d_init")
    rows = merging_rows(made)
    if not rows:
        return not_measured(goal)
    share = max(map(map_share, rows))
    error = max(map(error_ratio, rows))
    ours = f"at most {100 * share:.0f} % of the maps, at most {error:.2f} times the error"
    good = [row for row in rows if map_share(row) <= ERROR_DRIVEN_SHARE and error_ratio(row) <= 1]
    if len(good) == len(rows):
        return Verdict(goal, ours, True)
    excess = [f"{percent(share / ERROR_DRIVEN_SHARE - 1)} more maps"] if share > ERROR_DRIVEN_SHARE else []
    excess += [f"{percent(error - 1)} more error"] if error > 1 else []
    return Verdict(goal, ours, False, f"{' and '.join(excess)} at worst; {len(good)} of {len(rows)} d_inits meet it")


def prediction_error(row):
    """The largest share by which a predicted counter misses what was counted."""
    return max(abs(row["predicted"][name] - row["counters"][name]) / max(row["counters"][name], 1) for name in PREDICTED)


def prediction_verdict(results):
    goal = (f"prediction of shadow maps, triangles and bytes within {100 * PREDICTION_SHARE:.0f} % of what is counted, on "
            "every scene")
    errors = [prediction_error(row) for made in results["scenes"].values() for row in made["rows"]]
    return at_most(goal, PREDICTION_SHARE, max(errors), lambda v: f"{100 * v:.2f} %") if errors else not_measured(goal)


def swapped_pairs(rows):
    """Pairs of d_inits of which the one with more expected error has less measured error."""
    errors = [(row["expected_rmse"], row["filters"]["pcss"]["rmse"]) for row in rows]
    return [(a, b) for i, a in enumerate(errors) for b in errors[:i] if (a[0] - b[0]) * (a[1] - b[1]) < 0]


def error_order_verdict(results):
    goal = "expected errors in the order of the measured ones over d_init, on every scene"
    scenes = results["scenes"].values()
    if not scenes:
        return not_measured(goal)
    swapped = sum(len(swapped_pairs(made["rows"])) for made in scenes)
    pairs = sum(len(made["rows"]) * (len(made["rows"]) - 1) // 2 for made in scenes)
    return Verdict(goal, f"{swapped} of {pairs} pairs swapped", swapped == 0, f"{swapped} pairs")


def verdicts(results):
    return [*selection_verdicts(results["selection"]), *ratio_verdicts(results), memory_verdict(results),
            *map(error_driven_verdict, results["scenes"].values()), prediction_verdict(results), error_order_verdict(results)]


def conditions(results):
    """Why a run's figures are not the goals' own, each in a few words."""
    reasons = []
    if results["size"] != "{}x{}".format(*paper.SIZE) or results["face_size"] != paper.FACE_SIZE:
        reasons.append(f"drawn at {results['size']} with faces of {results['face_size']}²")
    if "Mesa 25" not in results.get("driver", ""):
        reasons.append(f"driver {results.get('driver', 'none')}")
    return reasons
