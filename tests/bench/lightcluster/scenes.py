# SPDX-License-Identifier: Apache-2.0
"""The scenes of the evaluation, and how they become packs."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
PAPER_SPONZA_D_INITS = (0.1, 0.3, 0.5, 1.6)


@dataclass(frozen=True)
class Scene:
    name: str
    title: str
    camera: str
    paper: str  # the scene of paper.TABLE_1 that it stands for
    d_inits: tuple  # the paper's, metres
    pictures: tuple  # d_inits whose pictures the page shows, as the paper's Figures 7 to 9 do
    script: str  # in examples/; empty: the data alone
    walk: tuple  # of a moving camera: where it begins and ends, as --path takes them
    data: str = ""  # a glTF of the test data that is baked with it
    counts: tuple = ()  # numbers of clusters for which d_init is searched, since the goals are stated for them


SCENES = (
    Scene("sponza", "Crytek's Sponza under 80 lights", "hall", "sponza", PAPER_SPONZA_D_INITS, (), "sponza_rig.py",
          ("-11.2,1.7,-0.25,0,2.3,-0.25,60", "-4,1.7,-0.25,7.2,2.3,-0.25,60"),
          "scenes/crytek_sponza/crytek_sponza.gltf", (44, 26, 10)),
    Scene("atrium", "Atrium under 80 lights", "hall", "sponza", PAPER_SPONZA_D_INITS, (0.5, 1.6), "atrium.py",
          ("-11,2,2,0,2,0,60", "-4,2,1,7,2,0,60")),
    Scene("cornell", "Cornell box under 32 lights", "front", "cornell", (0.3, 0.4, 0.5, 0.6), (0.5, 0.6), "cornell.py",
          ("-0.3,0.5,1.55,0,0.5,0,45", "0.3,0.5,1.1,0,0.5,0,45")),
    Scene("restaurant", "Restaurant under 14 lights", "table", "restaurant", (0.2, 0.3, 0.4, 0.5), (0.3, 0.4), "restaurant.py",
          ("-1.05,1.45,2.75,0.1,1.05,0,50", "1,1.45,2.2,0.1,1.05,0,50")),
)


def by_name(name):
    return next(scene for scene in SCENES if scene.name == name)


def bake(scene, bake_program, data, folder):
    """The scene's pack in `folder`, made where it is missing or older than what it comes from; None without its test data."""
    scripts = [EXAMPLES / scene.script] if scene.script else []
    rig, pack = folder / f"{scene.name}.glb", folder / f"{scene.name}.chandelier"
    found = [Path(data) / scene.data] if scene.data else []
    if not all(path.exists() for path in found):
        return None
    newest = max(path.stat().st_mtime for path in [*scripts, Path(bake_program), *found])
    if not pack.exists() or pack.stat().st_mtime < newest:
        folder.mkdir(parents=True, exist_ok=True)
        for script in scripts:
            run([sys.executable, "-B", script, "-o", rig])
        run([bake_program, "--quiet", *found, *([rig] if scripts else []), "-o", pack])
    return pack


def run(command):
    """Stops the benchmark with the command and what it said where it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout
