# SPDX-License-Identifier: Apache-2.0
"""The page of an evaluation, as blocks."""

import statistics

import paper
import scenes
import tables
from page import Figure, Heading, Paragraph
from play import PATH_FACE_SIZE, PATH_SIZE
from verdicts import RATIO_COUNTS, conditions

TITLE = "LightCluster, measured as its paper was"


def shown_rows(name, made):
    """The rows whose pictures the page shows, as Figures 7 to 9 do."""
    scene = scenes.by_name(name)
    return [row for row in made["rows"] if row["d_init_m"] in scene.pictures or row["searched"] in RATIO_COUNTS]


def picture_name(name, row, what):
    return f"images/{name}_{row['clusters']}_{what}.jpg"


def blocks(results):
    return [Heading(1, TITLE), *opening(results), *time_blocks(results), *step_blocks(results), *selection_blocks(results),
            *filter_blocks(results), *error_blocks(results), *memory_blocks(results), *error_driven_blocks(results),
            *prediction_blocks(results), *path_blocks(results), *picture_blocks(results)]


def opening(results):
    made = [Paragraph(
        "LightCluster (Wiesenhütter, Klein, Nischwitz), section 5, measured again with this renderer by "
        "`make bench-lightcluster`. The paper's machine: Xeon E5620, GeForce GTX 680, 1920x1080, cube faces of 1024². Here: "
        f"{results['device']}, driver {results['driver']}, {results['processor']}, {results['size']}, cube faces of "
        f"{results['face_size']}², medians of {results['repeats']}. Where the driver draws on the CPU, ratios compare with the "
        "paper's and milliseconds do not."), Paragraph(
        "Reference: one hard cube shadow map per light in view. Both sides of a ratio are drawn in one process, in turns; "
        "repeats of all configurations take turns too. A ratio is the median of the processes' ratios.")]
    if results["left_out"]:
        made.append(Paragraph("**Left out:** " + "; ".join(results["left_out"]) + "."))
    made.append(Heading(2, "Goals"))
    other = conditions(results)
    if other:
        made.append(Paragraph(
            f"**Not the conditions of the goals:** {'; '.join(other)}. They are stated for Mesa 25, 1920x1080 and faces of 1024²; "
            "verdicts on times and bytes of other runs tell nothing about them."))
    return [*made, tables.verdict_table(results)]


def time_blocks(results):
    made = [Heading(2, "Times (Table 1)"), Paragraph(
        "Rows stand for the paper's d_init. Crytek's Sponza is not the paper's Dabrovic Sponza and its rig is ours, so there d_init "
        "is also searched for the paper's numbers of clusters, which stand beside the paper's times. The share of lights from which "
        "the reference is drawn instead is switched off (`--reference-share 2`), as the paper measured.")]
    for name, scene in results["scenes"].items():
        made += [Heading(3, scene["title"]), tables.time_table(name, scene), Figure(
            [f"images/{name}_times.svg"], f"{scene['title']}: how many times longer the reference takes, ours and the paper's.")]
        first, automatic = scene["rows"][0], scene["automatic"]
        chosen = "the reference's path is taken" if automatic["reference_path"] else "light clusters are drawn"
        made.append(Paragraph(
            f"Left to choose by itself at d_init {first['d_init_m']:.3g} m ({first['clusters']} clusters of "
            f"{scene['lights_in_view']} lights), {chosen}: reference ÷ that is {statistics.median(automatic['ratio']):.2f}."))
    return made


def step_blocks(results):
    if "steps" not in results:
        return []
    return [Heading(2, "Steps (Table 2)"), Paragraph(
        "Visibility is delivered by textures here, as in the paper: sampling shadow maps belongs to Shadows, not to Lighting."),
        tables.step_table(results["steps"])]


def selection_blocks(results):
    return [Heading(2, "Selection (Figure 4)"), Paragraph(
        f"The paper: within {paper.SELECTION_MS:g} ms with {paper.SELECTION_LIGHTS:,} lights, growing nearly linearly."),
        Figure(["images/selection.svg"], "Time to select light clusters over the number of lights."),
        tables.selection_table(results["selection"])]


def filter_blocks(results):
    if "filters" not in results:
        return []
    found = results["filters"]
    return [Heading(2, "PCF and PCSS (Figure 5)"), Figure(
        [f"images/filters_{what}.jpg" for what in ("pcf", "pcss", "difference")],
        f"Sponza, {found['clusters']} clusters: PCF, PCSS, and their difference: dark blue is none, red {found['scale']:.3f} of "
        f"the shown picture's range or more. RMSE {found['rmse']:.4f}.")]


def error_blocks(results):
    return [Heading(2, "Errors (Figure 6)"), Paragraph(
        "RMSE, SSIM and FLIP of the shown picture, 0 to 1. Truth is the same shading with rays instead of shadow maps; the "
        "reference has an error of its own against it. The paper names no values."), Figure(
        ["images/errors.svg"], "RMSE over d_init, PCSS, against the reference and against truth; the number of clusters in green."),
        *(tables.error_table(scene) for scene in results["scenes"].values())]


def memory_blocks(results):
    return [Heading(2, "Memory (section 5.3)"), Paragraph(
        "What visibility textures need (`--deliver textures`): one byte for each pixel of the rectangle that a cluster reaches, "
        "where the paper has four for each pixel of the screen. Delivered inline, visibility needs none."),
        tables.memory_table(results)]


def error_driven_blocks(results):
    return [Heading(2, "Selection by error"), Paragraph(
        "Preset `chandelier` (selection by error, hard shadows), allowed six tenths of the shadow maps that the paper's selection takes "
        "at a d_init, beside that selection read by PCSS; errors are measured against the reference. Where the paper's selection gives "
        "every light its own map there is nothing to reach."), tables.error_driven_table(results)]


def prediction_blocks(results):
    return [Heading(2, "Prediction"), Paragraph(
        "`--predict` tells from the pack alone what a frame takes; beside it, what was counted when the frame was drawn (with "
        "visibility textures)."), tables.prediction_table(results), Paragraph(
        "The way back: d_init chosen by `--max-shadow-maps`, asked for as many maps as the paper drew."),
        tables.budget_table(results)]


def path_blocks(results):
    return [Heading(2, "A moving camera (section 5.6)"), Paragraph(
        "How many lights take another map than a frame ago, and how far the picture is from the same view with every light at its "
        "map of a frame ago: what the selection changes and the camera's motion does not explain. Error-driven selection gives some "
        "lights shares of several maps; they count by the largest, and what changes of their shares beside that is not measured, so "
        "that its figures are too low. Means over the frames, drawn at "
        f"{PATH_SIZE} with faces of {PATH_FACE_SIZE}²."),
        tables.path_table(results)]


def picture_blocks(results):
    made = [Heading(2, "Pictures (Figures 7 to 9)")]
    for name, scene in results["scenes"].items():
        for row in shown_rows(name, scene):
            found = row["filters"]["pcss"]
            made.append(Figure(
                [picture_name(name, row, what) for what in ("reference", "pcss", "difference")],
                f"{scene['title']}: reference with {scene['lights_in_view']} maps, {row['clusters']} clusters (d_init "
                f"{row['d_init_m']:.3g} m, PCSS), and their difference: red is {found['scale']:.3f} or more. "
                f"RMSE {found['rmse']:.4f}."))
    return made
