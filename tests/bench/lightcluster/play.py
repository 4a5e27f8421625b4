# SPDX-License-Identifier: Apache-2.0
"""Runs chandelier-play and chandelier-bench and reads what they write."""

import json
import os
from pathlib import Path

import numpy as np
from PIL import Image

from scenes import run

# Never the reference's path by itself: the paper measured LightCluster with 80 clusters of 80 lights, too.
NO_REFERENCE_PATH = ("--reference-share", "2")

PATH_SIZE, PATH_FACE_SIZE = "480x270", 256  # of a moving camera's many pictures


def shown(path):
    """A picture as on a screen, 0..1, height x width x 3."""
    return np.asarray(Image.open(path).convert("RGB"), "f4") / 255.0


def rmse(a, b):
    """Root of the mean square over R, G and B of every pixel, as comparison.json's rmse.shown."""
    return float(np.sqrt(np.mean((shown(a).astype("f8") - shown(b)) ** 2)))


class Player:
    """One scene's pack, drawn at one size on one device."""

    def __init__(self, program, pack, camera, arguments, folder):
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.program = [program, pack]
        self.view = ["--camera", camera] if camera else []
        self.device = ["--device", arguments.device] if arguments.device else []
        self.size = ["--size", arguments.size, "--face-size", arguments.face_size]

    def compare(self, a, b, name, *options, frames=1):
        """Both presets in turns in one process; comparison.json, its pictures in folder/name."""
        report = self.folder / name
        run([*self.program, *self.view, *self.device, *self.size, "--compare", f"{a},{b}", "--report", report, "--frames", frames,
             *options])
        return json.loads((report / "comparison.json").read_text())

    def draw(self, preset, name, *options):
        """One frame; its statistics, its picture in folder/name.png."""
        picture, stats = self.folder / f"{name}.png", self.folder / f"{name}.json"
        run([*self.program, *self.view, *self.device, *self.size, "--preset", preset, "--output", picture, "--stats", stats,
             *options])
        return json.loads(stats.read_text())

    def predict(self, preset, *options):
        """What a frame will take, from the pack alone: no device is opened."""
        stats = self.folder / "prediction.json"
        run([*self.program, *self.view, *self.size, "--predict", "--preset", preset, "--stats", stats, *options])
        return json.loads(stats.read_text())

    def path(self, preset, keys, frames, *options):
        """What changes from frame to frame while the camera goes from key to key."""
        file = self.folder / "walk.json"
        file.write_text(json.dumps({"keys": keys}))
        run([*self.program, *self.device, "--size", PATH_SIZE, "--face-size", PATH_FACE_SIZE, "--path", file,
             "--preset", preset, "--frames", frames, "--report", self.folder / "path", *options])
        return json.loads((self.folder / "path" / "path.json").read_text())

    def budget(self, shadow_maps):
        """The smallest d_init, so the most shadow maps, within so many."""
        found = self.predict("lightcluster", "--max-shadow-maps", shadow_maps, *NO_REFERENCE_PATH)
        return {"max_shadow_maps": shadow_maps, "d_init_m": found["recipe"]["settings"]["d_init_m"],
                "shadow_maps": found["counters"]["shadow_maps"]}


def picture(player, name):
    return player.folder / f"{name}.png"


def selection_times(bench_program, repeats):
    """One row per number of lights and d_init, from chandelier-bench (LightCluster, Figure 4).

    Processor time, which for one thread is its time on a core less what other processes took.
    """
    text = run([bench_program, "--benchmark_filter=select_light_clusters/", "--benchmark_format=json",
                f"--benchmark_repetitions={repeats}", "--benchmark_min_time=0.1"])
    results = json.loads(text)["benchmarks"]
    medians = [r for r in results if r.get("aggregate_name") == "median"] or results
    return [selection_row(r) for r in medians if "light_clusters" in r]


def selection_row(result):
    arguments = dict(part.split(":") for part in result["run_name"].split("/") if ":" in part)
    to_ms = {"ns": 1e-6, "us": 1e-3, "ms": 1.0}[result["time_unit"]]
    return {"lights": int(arguments["lights"]), "d_init_m": int(arguments["d_init_dm"]) / 10,
            "clusters": int(result["light_clusters"]), "median_ms": result["cpu_time"] * to_ms,
            "brute_force_over_this": result.get("brute_force_over_this")}


def processor():
    """The CPU's name and how many cores this process may use."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {len(os.sched_getaffinity(0))} cores"
