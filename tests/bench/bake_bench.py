#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the baker beside gltfpack: speed, memory, how both grow with the scene, and the size of compressed packs.

Both sides run in turns on the same file and cores; times are medians of whole processes, from page cache, geometry only
(no textures). Prints what the goals ask for and by how much each is met or missed, and writes a table and a plot.

  bake_bench.py --bake build/bin/chandelier-bake --out build/bench/bake [--most-triangles 20000000] [--data FOLDER]
"""

import argparse
import json
import os
import resource
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import city

SIZES = (10_000, 100_000, 1_000_000, 5_000_000, 20_000_000)
GEOMETRY = ("positions", "vertex_attributes", "indices", "skin_vertices")
HIERARCHIES = ("batches", "meshes", "instances", "batch_instances", "batch_bvh", "batch_bvh_items", "instance_bvh",
               "instance_bvh_items", "triangle_bvh", "triangle_bvh_items", "triangle_bvh_areas", "voxel_grid",
               "voxel_cells", "voxel_runs", "voxel_indices", "voxel_vertices", "voxel_occupancy")


def run(command):
    """(wall seconds, CPU seconds, peak MiB) of one process; stops the benchmark where it fails."""
    start = time.perf_counter()
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    error = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {process.returncode}\n{error.decode(errors='replace')}")
    return time.perf_counter() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def interleaved(commands, repeats):
    """Medians of (wall, cpu, MiB) of each command, run in turns."""
    runs = [[] for _ in commands]
    for _ in range(repeats):
        for command, results in zip(commands, runs):
            results.append(run(command))
    return [tuple(statistics.median(column) for column in zip(*results)) for results in runs]


def glb_or_gltf_buffers(path):
    """Bytes of a glTF's buffers that are not images."""
    path = Path(path)
    if path.suffix == ".glb":
        with open(path, "rb") as file:
            file.read(12)
            length, _ = struct.unpack("<I4s", file.read(8))
            document = json.loads(file.read(length))
    else:
        document = json.loads(path.read_text())
    images = {i["bufferView"] for i in document.get("images", []) if "bufferView" in i}
    total = 0
    for number, view in enumerate(document.get("bufferViews", [])):
        packed = view.get("extensions", {}).get("EXT_meshopt_compression")
        if number not in images:
            total += (packed or view)["byteLength"]
    return total


def section_bytes(inspect, pack):
    """{section: stored bytes}."""
    report = json.loads(subprocess.run([inspect, "--json", pack], check=True, capture_output=True).stdout)
    return {s["name"]: s["stored_bytes"] for s in report["sections"]}


class Bench:
    def __init__(self, arguments, folder):
        self.bake, self.folder, self.repeats = Path(arguments.bake), Path(folder), arguments.repeats
        self.inspect = self.bake.with_name("chandelier-inspect")
        self.lines = []

    def say(self, line=""):
        print(line, flush=True)
        self.lines.append(line)

    def bake_command(self, scene, *more):
        return [self.bake, scene, "-o", self.folder / "out.chandelier", "--textures", "none", "--quiet", *more]

    def compare(self, name, scene, repeats):
        """Speed and memory beside gltfpack -c; returns what the plot needs."""
        report = self.folder / "report.json"
        commands = [self.bake_command(scene, "--json", report)]
        if shutil.which("gltfpack"):
            commands.append(["gltfpack", "-c", "-i", scene, "-o", self.folder / "out.glb"])
        results = interleaved(commands, repeats)
        passes = json.loads(report.read_text())
        triangles, size = triangles_of(self.inspect, self.folder / "out.chandelier"), glb_or_gltf_buffers(scene)
        wall, cpu, memory = results[0]
        self.say(f"{name}: {triangles:,} triangles, {size / 2**20:.1f} MiB of geometry")
        self.say(f"  chandelier-bake  {wall:8.2f} s ({cpu:.2f} s CPU)  {triangles / wall / 1e6:6.2f} M triangles/s  "
                 f"{memory:7.0f} MiB = {memory * 2**20 / size:.2f} times the input's geometry")
        row = {"name": name, "triangles": triangles, "bytes": size, "bake_s": wall, "bake_cpu_s": cpu, "bake_mib": memory,
               "passes_ms": {p["name"]: p["ms"] for p in passes["passes"]}}
        if len(results) > 1:
            wall2, cpu2, memory2 = results[1]
            self.say(f"  gltfpack -c      {wall2:8.2f} s ({cpu2:.2f} s CPU)  {triangles / wall2 / 1e6:6.2f} M triangles/s  "
                     f"{memory2:7.0f} MiB")
            computed = sum(ms for name, ms in row["passes_ms"].items() if name not in ("write", "sync")) / 1000
            self.say(f"  ratio {wall2 / wall:.2f} (1 or more is the goal); {wall2 / computed:.2f} without writing "
                     f"{(self.folder / 'out.chandelier').stat().st_size / 2**20:.0f} MiB and waiting for the disk, "
                     f"where gltfpack writes {(self.folder / 'out.glb').stat().st_size / 2**20:.0f}")
            row |= {"gltfpack_s": wall2, "gltfpack_cpu_s": cpu2, "gltfpack_mib": memory2}
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        if memory < own * 1.05:
            self.say(f"  memory: less than this; a process starts with the peak of the one that starts it, here {own:.0f} MiB")
        slowest = sorted(row["passes_ms"].items(), key=lambda p: -p[1])
        self.say("  ms per pass: " + ", ".join(f"{n} {ms:.0f}" for n, ms in slowest if ms >= 0.5))
        return row

    def size(self, name, scene):
        """The compressed pack's geometry beside gltfpack -cc's, hierarchies apart."""
        run(self.bake_command(scene, "--compress"))
        sections = section_bytes(self.inspect, self.folder / "out.chandelier")
        geometry = sum(sections.get(s, 0) for s in GEOMETRY)
        rest = {s: sections[s] for s in HIERARCHIES if s in sections}
        line = f"{name}: geometry {geometry:,} bytes (" + ", ".join(
            f"{s} {sections[s]:,}" for s in GEOMETRY if s in sections) + ")"
        row = {"name": name, "geometry_bytes": geometry, "hierarchy_bytes": rest}
        if shutil.which("gltfpack"):
            run(["gltfpack", "-cc", "-i", scene, "-o", self.folder / "out.glb"])
            row["gltfpack_bytes"] = glb_or_gltf_buffers(self.folder / "out.glb")
            line += f"; gltfpack -cc {row['gltfpack_bytes']:,}; ratio {geometry / row['gltfpack_bytes']:.3f} (1.15 or less is the goal)"
        self.say(line)
        self.say(f"  and hierarchies {sum(rest.values()):,}: " + ", ".join(f"{s} {n:,}" for s, n in rest.items()))
        return row


def triangles_of(inspect, pack):
    report = json.loads(subprocess.run([inspect, "--json", pack], check=True, capture_output=True).stdout)
    return next(s["count"] for s in report["sections"] if s["name"] == "indices") // 3


def plot(rows, path):
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    figure, (time_axes, memory_axes) = plt.subplots(1, 2, figsize=(11, 4.5))
    x = [r["triangles"] for r in rows]
    for key, label, style in (("bake_s", "chandelier-bake", "o-"), ("gltfpack_s", "gltfpack -c", "s--")):
        points = [(r["triangles"], r[key]) for r in rows if key in r]
        if points:
            time_axes.loglog(*zip(*points), style, label=label)
    time_axes.loglog(x, [x_i * rows[-1]["bake_s"] / x[-1] for x_i in x], ":", color="grey", label="linear")
    time_axes.set(xlabel="triangles", ylabel="seconds, whole process", title="Time")
    memory_axes.loglog(x, [r["bake_mib"] for r in rows], "o-", label="chandelier-bake, peak")
    memory_axes.loglog(x, [4 * r["bytes"] / 2**20 for r in rows], ":", color="grey", label="4 × the input's geometry")
    memory_axes.set(xlabel="triangles", ylabel="MiB", title="Memory")
    for axes in (time_axes, memory_axes):
        axes.grid(True, which="both", alpha=0.3)
        axes.legend()
    figure.tight_layout()
    figure.savefig(path)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bake", required=True, help="chandelier-bake; chandelier-inspect lies beside it")
    parser.add_argument("--out", required=True, help="folder for results.json, report.txt and scaling.svg")
    parser.add_argument("--data", default="../shared/data", help="real scenes; left out where absent (default: %(default)s)")
    parser.add_argument("--most-triangles", type=int, default=SIZES[-1], help="largest city (default: %(default)s)")
    parser.add_argument("--repeats", type=int, default=5, help="of the small ones; large ones run less (default: %(default)s)")
    arguments = parser.parse_args()
    out = Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out) as folder:
        bench = Bench(arguments, folder)
        rows, sizes = [], []
        if not shutil.which("gltfpack"):
            bench.say("gltfpack is not installed: its side is left out")
        for triangles in [n for n in SIZES if n <= arguments.most_triangles]:
            scene = Path(folder) / "city.glb"
            city.write_city(scene, triangles)
            repeats = arguments.repeats if triangles <= 1_000_000 else 3 if triangles <= 5_000_000 else 1
            rows.append(bench.compare(f"city {triangles:,}", scene, repeats))
            if triangles == 1_000_000:
                sizes.append(bench.size(f"city {triangles:,}", scene))
            scene.unlink()
        real = []
        for name in ("scenes/crytek_sponza", "scenes/classroom"):
            found = sorted((Path(arguments.data) / name).glob("*.gl*"))
            if not found:
                bench.say(f"SKIPPED: {name} (no test data)")
                continue
            real.append(bench.compare(name, found[0], arguments.repeats))
            sizes.append(bench.size(name, found[0]))
        if plot(rows, out / "scaling.svg"):
            bench.say(f"plot: {out / 'scaling.svg'}")
        (out / "results.json").write_text(json.dumps({"cities": rows, "scenes": real, "sizes": sizes}, indent=1))
        (out / "report.txt").write_text("\n".join(bench.lines) + "\n")


if __name__ == "__main__":
    main()
