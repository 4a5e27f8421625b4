#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what soft shadow maps cost beside the reference's hard ones: the frame and its stages, one row per scene and recipe.

  soft.py --programs build/bin --out build/bench/soft [--size 1920x1080] [--face-size 1024] [--scenes sponza,cornell]

All rows are drawn in turns, and each number is the median of its turns, so that a slow moment falls on all alike.
"""

import argparse
import statistics
import sys
from pathlib import Path

import play
import scenes
from arguments import positive, size

# Beside the evaluation's scenes: one with many rooms, and an open street.
MORE_SCENES = (
    scenes.Scene("stormkeep", "Stormkeep under its own lights", "", "", (), (), "", (), "scenes/nexuiz_stormkeep/stormkeep.gltf"),
    scenes.Scene("city", "Candela City under its own lights", "", "", (), (), "", (), "scenes/stk_candela_city/candela_city.gltf"))
SCENES = scenes.SCENES + MORE_SCENES
SPONZA_MAPS = (26, 10)
STAGES = ("g-buffer", "rasterize", "deliver", "shade")
PRESETS = ("lightcluster", "lightcluster-pcf")


class Row:
    """One recipe in one scene, and the statistics of its frames."""

    def __init__(self, scene, preset, options=()):
        self.scene, self.preset, self.options, self.frames = scene, preset, options, []

    def median(self, stage=None):
        return statistics.median(stage_ms(frame, stage) if stage else frame["frame_ms"] for frame in self.frames)

    def maps(self):
        return self.frames[0]["counters"]["shadow_maps"]


def stage_ms(frame, stage):
    return sum(found["gpu_ms"] for found in frame["stages"] if found["name"] == stage)


def rows_of(scene, player):
    """The reference first. Sponza with the numbers of maps that goals are stated for, the others as the presets have it."""
    rows = [Row(scene, "reference")]
    if not scene.counts:
        return rows + [Row(scene, preset) for preset in PRESETS]
    for maps in SPONZA_MAPS:
        options = ("--d-init", player.budget(maps)["d_init_m"], *play.NO_REFERENCE_PATH)
        rows += [Row(scene, preset, options) for preset in PRESETS]
    return rows


def table(rows):
    """Lines of text; the last column is how many times as fast as the scene's reference."""
    lines = [f"{'scene':<12}{'recipe':<18}{'maps':>5}{'frame':>9}" + "".join(f"{stage:>11}" for stage in STAGES) + f"{'times':>7}"]
    for row in rows:
        reference = next(other for other in rows if other.scene == row.scene and other.preset == "reference")
        times = "".join(f"{row.median(stage):11.1f}" for stage in STAGES)
        lines.append(f"{row.scene.name:<12}{row.preset:<18}{row.maps():5d}{row.median():9.1f}{times}"
                     f"{reference.median() / row.median():7.2f}")
    return lines


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [scene.name for scene in SCENES]
    parser.add_argument("--programs", default="build/bin", help="folder of the chandelier programs (default: %(default)s)")
    parser.add_argument("--out", default="build/bench/soft", help="folder for packs and pictures (default: %(default)s)")
    parser.add_argument("--data", default="../shared/data", help="real scenes; left out where absent (default: %(default)s)")
    parser.add_argument("--size", type=size, default="1920x1080", help="of pictures (default: %(default)s)")
    parser.add_argument("--face-size", type=positive, default=1024, help="texels (default: %(default)s)")
    parser.add_argument("--scenes", default=",".join(names), help="some of %(default)s")
    parser.add_argument("--repeats", type=positive, default=3, help="of each frame (default: %(default)s)")
    parser.add_argument("--device", default="", help="part of a Vulkan device's name (default: as chandelier-play chooses)")
    return parser.parse_args(arguments)


def main():
    arguments = parse(sys.argv[1:])
    programs, out = Path(arguments.programs), Path(arguments.out)
    players = {}
    rows = []
    for scene in SCENES:
        if scene.name not in arguments.scenes.split(","):
            continue
        pack = scenes.bake(scene, programs / "chandelier-bake", arguments.data, out / "packs")
        if pack is None:
            print(f"{scene.name}: left out, no test data", file=sys.stderr)
            continue
        players[scene.name] = play.Player(programs / "chandelier-play", pack, scene.camera, arguments, out / scene.name)
        rows += rows_of(scene, players[scene.name])
    if not rows:
        sys.exit("no scene is left to measure")
    for _ in range(arguments.repeats):
        for row in rows:
            row.frames.append(players[row.scene.name].draw(row.preset, row.preset, *row.options))
    first = rows[0].frames[0]
    print(f"{first['driver']}, {arguments.size}, faces of {arguments.face_size}, medians of {arguments.repeats}, ms")
    print("\n".join(table(rows)))


if __name__ == "__main__":
    main()
