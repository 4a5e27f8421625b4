#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures this renderer as LightCluster's paper measured its own, and writes a page with the paper's figures beside ours.

  run.py --programs build/bin --out build/bench/lightcluster [--size 1920x1080] [--face-size 1024] [--scenes sponza,atrium]

OUT gets index.html and README.md (the same page), images/, results.json, and work/ with packs and pictures in full size.
"""

import argparse
import json
import sys
from pathlib import Path

import evaluation
import measure
import page
import paper
import plots
import scenes
from arguments import positive, size


def scene_names(text):
    names = text.split(",")
    unknown = [name for name in names if name not in {scene.name for scene in scenes.SCENES}]
    if unknown:
        known = ", ".join(scene.name for scene in scenes.SCENES)
        raise argparse.ArgumentTypeError(f"no such scene: {', '.join(unknown)}; there are {known}")
    return names


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    every_scene = [scene.name for scene in scenes.SCENES]
    parser.add_argument("--programs", default="build/bin", help="folder of the chandelier programs (default: %(default)s)")
    parser.add_argument("--out", default="build/bench/lightcluster", help="folder of the page (default: %(default)s)")
    parser.add_argument("--data", default="../shared/data", help="real scenes; left out where absent (default: %(default)s)")
    parser.add_argument("--size", type=size, default="{}x{}".format(*paper.SIZE), help="of pictures (default: %(default)s)")
    parser.add_argument("--face-size", type=positive, default=paper.FACE_SIZE, help="texels (default: %(default)s)")
    parser.add_argument("--scenes", type=scene_names, default=every_scene, help="some of " + ",".join(every_scene))
    parser.add_argument("--repeats", type=positive, default=3, help="of each time; their median counts (default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="each time once, fewer points in Figure 6: to see that it works")
    parser.add_argument("--device", default="", help="part of a Vulkan device's name (default: as chandelier-play chooses)")
    parser.add_argument("--results", help="measure nothing: make the page anew from this results.json")
    made = parser.parse_args(arguments)
    programs = Path(made.programs)
    made.play, made.bake, made.chandelier_bench = (programs / f"chandelier-{name}" for name in ("play", "bake", "bench"))
    made.sweep, made.path_frames = measure.SWEEP_M, measure.PATH_FRAMES
    if made.quick:
        made.repeats, made.sweep, made.path_frames = 1, (), 4
    return made


def main():
    arguments = parse(sys.argv[1:])
    out = Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)
    if arguments.results:
        results = json.loads(Path(arguments.results).read_text())
    else:
        results = measure.Evaluation(arguments, out / "work").measure()
        plots.make_pictures(results, out / "work", out)
        (out / "results.json").write_text(json.dumps(results, indent=1) + "\n")
    plots.make_plots(results, out)
    page.write(evaluation.blocks(results), out, evaluation.TITLE)
    print(f"{out / 'index.html'}\n{out / 'README.md'}")


if __name__ == "__main__":
    main()
