# SPDX-License-Identifier: Apache-2.0
"""The paper's tables with ours beside them, as blocks of a page."""

import statistics

import paper
import scenes
from measure import median_ratio
from page import Table
from verdicts import MIB, error_ratio, map_share, merging_rows, prediction_error, verdicts

# The paper's steps, and the stages that make them up here (Table 2).
STEPS = (("Clustering", ("select",)), ("GBuffer", ("g-buffer",)), ("Shadows", ("project", "cull", "rasterize", "deliver")),
         ("Lighting", ("lookup", "shade")), ("Compositing", ("tone-map",)))
FILTERS = ("pcf", "pcss")
PAPER_COLUMN = {"pcf": 2, "pcss": 3}  # in a row of paper.TABLE_1


def verdict_table(results):
    return Table(["goal", "ours", "verdict"], [[v.goal, v.ours, v.text()] for v in verdicts(results)])


def per_filter(text):
    """One head of a column for each filter."""
    return [text.format(name.upper()) for name in FILTERS]


def named_rows(results):
    """(title and d_init, scene, row) of every row of every scene."""
    return [(f"{made['title']}, d_init {row['d_init_m']:.3g} m", made, row)
            for made in results["scenes"].values() for row in made["rows"]]


def time_table(name, made):
    """Table 1 of one scene."""
    head = ["d_init, m", "clusters", *per_filter("{}, ms"), *per_filter("reference ÷ {}"), "paper's clusters",
            *per_filter("paper's {}, ms"), *per_filter("paper's reference ÷ {}")]
    rows = [time_row(name, row) for row in made["rows"]]
    reference = statistics.median(ms for row in made["rows"] for f in FILTERS for ms in row["filters"][f]["reference_ms"])
    theirs = paper.TABLE_1[scenes.by_name(name).paper]
    rows.append([f"reference, {made['lights_in_view']} lights in view", str(made["lights_in_view"]), *2 * [f"{reference:.1f}"],
                 "1", "1", str(theirs["lights"]), *2 * [f"{theirs['reference_ms']:.1f}"], "1", "1"])
    return Table(head, rows, f"{made['title']}: milliseconds a frame (LightCluster, Table 1)")


def time_row(name, row):
    found = [row["filters"][f] for f in FILTERS]
    ours = [f"{row['d_init_m']:.3g}", str(row["clusters"]), *(f"{statistics.median(f['ms']):.1f}" for f in found),
            *(f"{median_ratio(f):.2f}" for f in found)]
    theirs = paper_row(name, row)
    if theirs is None:
        return ours + 5 * ["–"]
    stands_for = scenes.by_name(name).paper
    return ours + [str(theirs[1]), *(f"{theirs[PAPER_COLUMN[f]]:.1f}" for f in FILTERS),
                   *(f"{paper.reference_ratio(stands_for, theirs[1], f):.2f}" for f in FILTERS)]


def paper_row(name, row):
    """The paper's row with the number of clusters that was searched for, else with this d_init.

    Where numbers are searched for, the lights are not the paper's, and equal d_inits have nothing in common.
    """
    scene = scenes.by_name(name)
    rows = paper.TABLE_1[scene.paper]["rows"]
    if row["searched"]:
        return next(r for r in rows if r[1] == row["searched"])
    return None if scene.counts else next((r for r in rows if r[0] == row["d_init_m"]), None)


def error_table(made):
    rows = []
    for row in made["rows"]:
        for filter_name, found in row["filters"].items():
            rows.append([f"{row['d_init_m']:.3g}", str(row["clusters"]), filter_name.upper(), f"{found['rmse']:.4f}",
                         "–" if found["ssim"] is None else f"{found['ssim']:.4f}", f"{found['flip']:.4f}",
                         f"{found['rmse_truth']:.4f}"])
    rows.append(["reference", str(made["lights_in_view"]), "hard", "0", "1", "0", f"{made['reference_rmse_truth']:.4f}"])
    return Table(["d_init, m", "shadow maps", "filter", "RMSE", "SSIM", "FLIP", "RMSE against truth"], rows,
                 f"{made['title']}: error of the shown picture against the reference, and against truth")


def step_ms(run, stages):
    return sum(stage["gpu_ms"] + stage["cpu_ms"] for stage in run["stages"] if stage["name"] in stages)


def step_row(name, ours, ours_total, theirs):
    return [name, *(f"{ms:.2f}" for ms in ours), *(f"{100 * ms / total:.1f} %" for ms, total in zip(ours, ours_total)),
            *(f"{ms:.2f}" for ms in theirs), *(f"{100 * ms / total:.1f} %" for ms, total in zip(theirs, paper.TABLE_2[-1][1:]))]


def step_table(steps):
    """Table 2. The total is the frame's, with what lies between its stages."""
    totals = [steps[f]["frame_ms"] for f in FILTERS]
    rows = []
    for (name, stages), theirs in zip(STEPS, paper.TABLE_2):
        rows.append(step_row(f"{name}: {', '.join(stages)}", [step_ms(steps[f], stages) for f in FILTERS], totals, theirs[1:]))
    rows.append(step_row("Total", totals, totals, paper.TABLE_2[-1][1:]))
    head = ["step", *per_filter("{}, ms"), *per_filter("{}"), *per_filter("paper's {}, ms"), *per_filter("paper's {}")]
    return Table(head, rows, f"Sponza with {steps['clusters']} clusters, visibility textures: milliseconds of each step "
                 "(LightCluster, Table 2)")


def selection_table(rows):
    table = []
    for row in sorted(rows, key=lambda r: (r["lights"], r["d_init_m"])):
        brute = row["brute_force_over_this"]
        table.append([f"{row['lights']:,}", f"{row['d_init_m']:g}", f"{row['clusters']:,}", f"{row['median_ms']:.3f}",
                      f"{brute:.1f}" if brute else "–"])
    return Table(["lights", "d_init, m", "clusters", "ms, median", "brute force ÷ this"], table,
                 "Selection on one core (LightCluster, Figure 4)")


def memory_table(results):
    bytes_of = ("visibility_bytes", "visibility_pool_bytes", "shadow_bytes")
    rows = [[name, str(row["clusters"]), *(f"{row['counters'][b] / MIB:.1f}" for b in bytes_of)]
            for name, _, row in named_rows(results)]
    rows.append(["paper's Sponza", str(paper.MEMORY_CLUSTERS), *2 * [str(paper.VISIBILITY_MIB)], str(paper.SHADOW_MAPS_MIB)])
    return Table(["scene", "clusters", "visibility, MiB", "of it held at a time, MiB", "shadow maps, MiB"], rows)


def error_driven_table(results):
    rows = []
    for name, made, row in named_rows(results):
        if row in merging_rows(made):
            ours, theirs = row["error_driven"], row["filters"]["pcss"]
            rows.append([name, str(row["clusters"]), str(ours["shadow_maps"]), f"{100 * map_share(row):.0f} %",
                         f"{theirs['rmse']:.4f}", f"{ours['rmse']:.4f}", f"{error_ratio(row):.2f}"])
    return Table(["scene", "paper's selection, maps", "error-driven, maps", "share", "paper's selection, RMSE",
                  "error-driven, RMSE", "ratio"], rows)


def prediction_table(results):
    columns = (("shadow_maps", 1), ("shadow_triangles", 1), ("shadow_bytes", MIB), ("visibility_bytes", MIB))
    rows = []
    for name, _, row in named_rows(results):
        pairs = [f"{row['predicted'][c] / unit:,.0f} / {row['counters'][c] / unit:,.0f}" for c, unit in columns]
        errors = f"{row['expected_rmse']:.4f} / {row['filters']['pcss']['rmse']:.4f}"
        rows.append([name, *pairs, f"{100 * prediction_error(row):.2f} %", errors])
    return Table(["scene", "shadow maps", "shadow triangles", "shadow maps, MiB", "visibility, MiB", "largest miss", "RMSE"], rows,
                 "Predicted / counted; RMSE expected / measured, PCSS")


def path_table(results):
    rows = [[f"{made['title']}, d_init {p['d_init_m']:.3g} m", p["recipe"], str(p["frames"]), f"{p['shadow_maps']:.1f}",
             f"{p['lights_changed']:.2f}", f"{p['unexplained_rmse']:.5f}"]
            for made in results["scenes"].values() for p in made["paths"]]
    return Table(["scene", "selection", "frames", "shadow maps a frame", "lights that change their map, a frame",
                  "RMSE unexplained, a frame"], rows)


def budget_table(results):
    rows = [[made["title"], str(b["max_shadow_maps"]), f"{b['d_init_m']:.3f}", str(b["shadow_maps"])]
            for made in results["scenes"].values() for b in made["budgets"]]
    return Table(["scene", "--max-shadow-maps", "d_init chosen, m", "shadow maps"], rows)
