# SPDX-License-Identifier: Apache-2.0
"""Plots and pictures of the page."""

import matplotlib
from PIL import Image

matplotlib.use("svg")
import matplotlib.pyplot as plt

import evaluation
import paper
import scenes
from measure import median_ratio
from verdicts import SELECTION_GOALS

matplotlib.rcParams["svg.hashsalt"] = "chandelier"  # the same plot is the same file
PICTURE_WIDTH = 960  # pixels, of pictures on the page


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def plot_selection(rows, path):
    """Figure 4."""
    figure, axes = plt.subplots(figsize=(8, 4.5))
    for d_init in sorted({row["d_init_m"] for row in rows}):
        points = sorted((row["lights"], row["median_ms"]) for row in rows if row["d_init_m"] == d_init)
        axes.loglog(*zip(*points), "o-", label=f"d_init {d_init:g} m")
    lights = sorted({row["lights"] for row in rows})
    last = max(row["median_ms"] for row in rows if row["lights"] == lights[-1])
    axes.loglog(lights, [n * last / lights[-1] for n in lights], ":", color="grey", label="linear")
    axes.loglog(*zip(*SELECTION_GOALS), "kx", label="goals: no more than this")
    axes.loglog([paper.SELECTION_LIGHTS], [paper.SELECTION_MS], "s", mfc="none", color="tab:red", ms=10,
                label="paper: within this")
    axes.set(xlabel="lights", ylabel="milliseconds, one core")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend()
    save(figure, path)


def plot_errors(drawn, path):
    """Figure 6: one pair of axes per scene."""
    figure, grid = plt.subplots(1, len(drawn), figsize=(4 * len(drawn), 4), squeeze=False)
    for axes, (name, made) in zip(grid[0], drawn.items()):
        points = sorted(made["sweep"], key=lambda point: point["d_init_m"])
        x = [point["d_init_m"] for point in points]
        axes.plot(x, [point["rmse_reference"] for point in points], "o-", label="PCSS against reference")
        axes.plot(x, [point["rmse_truth"] for point in points], "s--", label="PCSS against truth")
        axes.axhline(made["reference_rmse_truth"], ls=":", color="grey", label="reference against truth")
        maps = axes.twinx()
        maps.step(x, [point["clusters"] for point in points], where="mid", color="tab:green", alpha=0.5)
        maps.set_ylabel("clusters (green)")
        maps.set_ylim(bottom=0)
        axes.set(xlabel="d_init, m", ylabel="RMSE of the shown picture", title=name)
        axes.set_ylim(bottom=0)
        axes.grid(True, alpha=0.3)
    grid[0][0].legend(fontsize="small")
    save(figure, path)


def plot_times(made, path):
    """Table 1 of one scene as a picture: reference over LightCluster, over the number of clusters."""
    figure, axes = plt.subplots(figsize=(8, 4))
    for filter_name, points in made.items():
        axes.plot(*zip(*sorted(points["ours"])), "o-", label=f"{filter_name.upper()}, ours")
        axes.plot(*zip(*sorted(points["paper"])), "s--", mfc="none", label=f"{filter_name.upper()}, paper")
    axes.axhline(1.0, ls=":", color="grey")
    axes.set(xlabel="clusters", ylabel="reference ÷ LightCluster")
    axes.grid(True, alpha=0.3)
    axes.legend()
    save(figure, path)


def shrink(source, path):
    """A picture of the page: JPEG of at most PICTURE_WIDTH pixels."""
    with Image.open(source) as image:
        image = image.convert("RGB")
        if image.width > PICTURE_WIDTH:
            image = image.resize((PICTURE_WIDTH, round(image.height * PICTURE_WIDTH / image.width)), Image.LANCZOS)
        image.save(path, quality=88)


def make_pictures(results, work, out):
    """Copies what was drawn, small, to where the page shows it."""
    (out / "images").mkdir(exist_ok=True)
    for name, made in results["scenes"].items():
        for row in evaluation.shown_rows(name, made):
            found = row["filters"]["pcss"]
            for what, source in (("reference", "reference.png"), ("pcss", found["image"]), ("difference", "difference.png")):
                shrink(work / name / found["folder"] / source, out / evaluation.picture_name(name, row, what))
    if "filters" in results:
        for what, source in (("pcf", results["filters"]["pcf"]["image"]), ("pcss", results["filters"]["pcss"]["image"]),
                             ("difference", "difference.png")):
            shrink(work / "sponza" / "filters" / source, out / f"images/filters_{what}.jpg")


def make_plots(results, out):
    (out / "images").mkdir(exist_ok=True)
    plot_selection(results["selection"], out / "images/selection.svg")
    plot_errors(results["scenes"], out / "images/errors.svg")
    for name, made in results["scenes"].items():
        plot_times(ratio_points(name, made), out / f"images/{name}_times.svg")


def ratio_points(name, made):
    """{filter: {ours: [(clusters, ratio)], paper: [...]}}."""
    table = scenes.by_name(name).paper
    theirs = [row[1] for row in paper.TABLE_1[table]["rows"]]
    return {f: {"ours": [(row["clusters"], median_ratio(row["filters"][f])) for row in made["rows"]],
                "paper": [(clusters, paper.reference_ratio(table, clusters, f)) for clusters in theirs]} for f in ("pcf", "pcss")}
