# SPDX-License-Identifier: Apache-2.0
"""What is measured: fills one dictionary, which results.json keeps and from which the page is made."""

import math
import shutil
import statistics
import sys

import paper
import play
import scenes
from jobs import Jobs

FILTERS = {"pcss": "lightcluster", "pcf": "lightcluster-pcf"}  # filter: preset
PATH_FRAMES = 30
# What a camera is moved with, and the options that make it so (LightCluster §5.6 names the second).
PATH_RECIPES = (("the paper's selection", ()), ("d_min without distance", ("--distance-scaling", "none")),
                ("stability 0.3", ("--stability", "0.3")), ("error-driven", ("--select", "error-driven")))
ERROR_DRIVEN_SHARE = 0.6  # of the paper selection's maps
SWEEP_M = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2, 1.6)  # Figure 6


def at(name, row):
    return f"{name}, d_init {row['d_init_m']:.3g} m"


class Evaluation:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.results = {"size": arguments.size, "face_size": arguments.face_size, "repeats": arguments.repeats,
                        "processor": play.processor(), "scenes": {}, "left_out": []}
        self.jobs = Jobs()

    def measure(self):
        players = {}
        for scene in [scenes.by_name(name) for name in self.arguments.scenes]:
            print(f"{scene.name}: making its pack", flush=True)
            pack = scenes.bake(scene, self.arguments.bake, self.arguments.data, self.folder / "packs")
            if pack is None:
                print(f"{scene.name}: left out, no test data", flush=True)
                self.results["left_out"].append(f"{scene.title} (no {scene.data} in the test data)")
                continue
            players[scene.name] = play.Player(self.arguments.play, pack, scene.camera, self.arguments, self.folder / scene.name)
            self.results["scenes"][scene.name] = self.open_scene(scene, players[scene.name])
        if not players:
            sys.exit("no scene is left to measure")
        self.jobs.add("selection", "selection time over the number of lights", self.selection)
        for repeat in range(self.arguments.repeats):  # all configurations in turns, so that a slow moment falls on all
            for name, player in players.items():
                self.add_times(name, player, repeat)
        for name, player in players.items():
            self.add_errors(name, player)
            self.add_counts(name, player)
            self.add_budgets(name, player)
            self.add_error_driven(name, player)
            self.add_paths(name, player)
        if "sponza" in players:
            self.add_steps(players["sponza"])
        self.jobs.run()
        return self.results

    def open_scene(self, scene, player):
        d_inits = {d: None for d in scene.d_inits}  # d_init: the number of clusters that it was searched for
        for clusters in scene.counts:
            found = player.budget(clusters)
            if found["shadow_maps"] == clusters:
                d_inits[found["d_init_m"]] = clusters
            else:
                self.results["left_out"].append(f"{scene.title} with {clusters} clusters (no d_init gives so many)")
        stats = player.draw("reference", "reference")
        self.results |= {"device": stats["device"], "driver": stats["driver"]}
        return {"title": scene.title, "camera": scene.camera, "lights": stats["counters"]["lights"],
                "lights_in_view": stats["counters"]["lights_in_view"], "exposure_ev": stats["exposure_ev"],
                "rows": [{"d_init_m": d, "searched": searched, "filters": {}} for d, searched in sorted(d_inits.items())],
                "automatic": {"ratio": []}, "sweep": [], "budgets": [], "paths": []}

    def selection(self):
        self.results["selection"] = play.selection_times(self.arguments.chandelier_bench, self.arguments.repeats)

    def add_times(self, name, player, repeat):
        made = self.results["scenes"][name]
        turn = f"{repeat + 1} of {self.arguments.repeats}"
        for row in made["rows"]:
            for filter_name in FILTERS:
                self.jobs.add((name, filter_name), f"{at(name, row)}: reference and {filter_name.upper()}, {turn}",
                              lambda row=row, filter_name=filter_name: self.time_row(player, row, filter_name, repeat))
        self.jobs.add((name, "automatic"), f"{at(name, made['rows'][0])}: the path that is chosen, {turn}",
                      lambda: self.time_automatic(made, player))

    def time_row(self, player, row, filter_name, repeat):
        folder = f"{filter_name}_{row['d_init_m']:.4f}" if repeat == 0 else "again"
        result = player.compare("reference", FILTERS[filter_name], folder, "--d-init", row["d_init_m"],
                                *play.NO_REFERENCE_PATH)
        found = row["filters"].setdefault(filter_name, {"ms": [], "reference_ms": [], "folder": folder})
        found["reference_ms"].append(result["a"]["frame_ms"])
        found["ms"].append(result["b"]["frame_ms"])
        if repeat == 0:
            found |= {"rmse": result["rmse"]["shown"], "ssim": result["ssim"], "flip": result["flip"]["mean"],
                      "scale": result["difference"]["scale_shown"], "image": result["b"]["image"]}
            row["clusters"] = result["b"]["counters"]["light_clusters"]
        else:
            shutil.rmtree(player.folder / folder)

    def time_automatic(self, made, player):
        result = player.compare("reference", "lightcluster", "automatic", "--d-init", made["rows"][0]["d_init_m"])
        made["automatic"]["ratio"].append(result["a"]["frame_ms"] / result["b"]["frame_ms"])
        made["automatic"]["reference_path"] = bool(result["b"]["counters"]["reference_path"])
        shutil.rmtree(player.folder / "automatic")

    def add_errors(self, name, player):
        made = self.results["scenes"][name]
        self.jobs.add((name, "truth"), f"{name}: truth, by rays", lambda: self.truth(made, player))
        for d_init_m in sorted(set(self.arguments.sweep) - {row["d_init_m"] for row in made["rows"]}):
            self.jobs.add((name, "sweep"), f"{name}: error at d_init {d_init_m:.3g} m",
                          lambda d_init_m=d_init_m: made["sweep"].append(self.error_at(made, player, d_init_m)))

    def truth(self, made, player):
        """Drawn once, with the reference's exposure, as everything that is held against it."""
        player.draw("truth", "truth", "--exposure", made["exposure_ev"])
        against = lambda picture: play.rmse(play.picture(player, "truth"), picture)
        made["reference_rmse_truth"] = against(play.picture(player, "reference"))
        for row in made["rows"]:
            for found in row["filters"].values():
                found["rmse_truth"] = against(player.folder / found["folder"] / found["image"])
            pcss = row["filters"]["pcss"]
            made["sweep"].append({"d_init_m": row["d_init_m"], "clusters": row["clusters"], "rmse_reference": pcss["rmse"],
                                  "rmse_truth": pcss["rmse_truth"]})

    def error_at(self, made, player, d_init_m):
        stats = player.draw("lightcluster", "sweep", "--d-init", d_init_m, "--exposure", made["exposure_ev"],
                            *play.NO_REFERENCE_PATH)
        drawn = play.picture(player, "sweep")
        return {"d_init_m": d_init_m, "clusters": stats["counters"]["light_clusters"],
                "rmse_reference": play.rmse(play.picture(player, "reference"), drawn),
                "rmse_truth": play.rmse(play.picture(player, "truth"), drawn)}

    def add_counts(self, name, player):
        made = self.results["scenes"][name]
        for row in made["rows"]:
            self.jobs.add((name, "counts"), f"{at(name, row)}: prediction and counters, visibility textures",
                          lambda row=row: self.count_row(player, row))

    def count_row(self, player, row):
        """Counters with visibility textures, drawn and predicted (section 5.3)."""
        options = ("--d-init", row["d_init_m"], "--deliver", "textures", *play.NO_REFERENCE_PATH)
        row["counters"] = player.draw("lightcluster", "counts", *options)["counters"]
        prediction = player.predict("lightcluster", *options)
        row |= {"predicted": prediction["counters"], "expected_rmse": prediction["expected_rmse_shown"]}

    def add_budgets(self, name, player):
        """d_init chosen for as many shadow maps as the paper drew."""
        made = self.results["scenes"][name]
        for clusters in [row[1] for row in paper.TABLE_1[scenes.by_name(name).paper]["rows"]]:
            self.jobs.add((name, "budget"), f"{name}: d_init for {clusters} shadow maps",
                          lambda clusters=clusters: made["budgets"].append(player.budget(clusters)))

    def add_error_driven(self, name, player):
        made = self.results["scenes"][name]
        for row in made["rows"]:
            self.jobs.add((name, "error-driven"), f"{at(name, row)}: error-driven selection",
                          lambda row=row: self.error_driven_row(made, player, row))

    def error_driven_row(self, made, player, row):
        """As little error as its share of the paper selection's maps allows, drawn with the same exposure."""
        maps = max(1, math.floor(ERROR_DRIVEN_SHARE * row["clusters"] + 1e-6))
        stats = player.draw("chandelier", "error_driven", "--max-shadow-maps", maps, "--exposure", made["exposure_ev"])
        row["error_driven"] = {"shadow_maps": stats["counters"]["shadow_maps"],
                               "rmse": play.rmse(play.picture(player, "reference"), play.picture(player, "error_driven"))}

    def add_paths(self, name, player):
        scene, made = scenes.by_name(name), self.results["scenes"][name]
        for recipe, options in PATH_RECIPES:
            self.jobs.add((name, recipe), f"{name}: moving camera, {recipe}",
                          lambda recipe=recipe, options=options: made["paths"].append(self.path(player, scene, recipe, options)))

    def path(self, player, scene, recipe, options):
        d_init_m, frames = scene.d_inits[2], self.arguments.path_frames
        result = player.path("lightcluster", scene.walk, frames, "--d-init", d_init_m, *play.NO_REFERENCE_PATH, *options)
        return {"recipe": recipe, "d_init_m": d_init_m, "frames": frames, **result["mean"]}

    def add_steps(self, player):
        """Table 2, and Figure 5: PCF beside PCSS, with visibility textures as the paper has them."""
        for clusters, key, more in ((paper.TABLE_2_CLUSTERS, "steps", ("--deliver", "textures")),
                                    (paper.MEMORY_CLUSTERS, "filters", ())):
            row = next((r for r in self.results["scenes"]["sponza"]["rows"] if r["searched"] == clusters), None)
            if row:
                self.jobs.add(("sponza", "filters"), f"sponza: PCF beside PCSS with {clusters} clusters",
                              lambda row=row, key=key, more=more: self.steps(player, row, key, more))

    def steps(self, player, row, key, more):
        result = player.compare(FILTERS["pcf"], FILTERS["pcss"], key, "--d-init", row["d_init_m"], *play.NO_REFERENCE_PATH,
                                *more, frames=self.arguments.repeats)
        self.results[key] = {"clusters": row["clusters"], "rmse": result["rmse"]["shown"],
                             "scale": result["difference"]["scale_shown"], "pcf": side(result["a"]), "pcss": side(result["b"])}


def side(run):
    return {"frame_ms": run["frame_ms"], "stages": run["stages"], "image": run["image"]}


def median_ratio(found):
    """Reference over LightCluster: the median of the ratios within each process."""
    return statistics.median(a / b for a, b in zip(found["reference_ms"], found["ms"]))
