# SPDX-License-Identifier: Apache-2.0
import os
import pathlib
import stat
import subprocess
import sys
import time

import pytest

from core import tools

BIN = pathlib.Path(os.environ.get("CHANDELIER_BIN", pathlib.Path(__file__).resolve().parents[2] / "build" / "bin"))
ROOM = pathlib.Path(__file__).resolve().parents[2] / "examples" / "cmake_project"
needs_bake = pytest.mark.skipif(not (BIN / "chandelier-bake").exists(), reason=f"no chandelier-bake in {BIN}")


def program(folder, text, name="chandelier-bake"):
    """A program that does what Python text says."""
    path = folder / name
    path.write_text(f"#!{sys.executable}\nimport signal, sys, time, os\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def ended(job):
    while job.is_running():
        time.sleep(0.01)
    return job


def test_unpacked_programs_may_run(tmp_path):
    path, note = pathlib.Path(program(tmp_path, "")), tmp_path / "NOTICE"
    note.touch()
    for each in (path, note):
        each.chmod(0o644)
    tools.make_executable(tmp_path)
    tools.make_executable(tmp_path / "missing")
    assert tools.find("chandelier-bake", [tmp_path]) == str(path)
    assert not os.access(note, os.X_OK)


def test_programs_are_found_in_folders_before_path(tmp_path, monkeypatch):
    first, second = tmp_path / "a", tmp_path / "b"
    for folder in (first, second):
        folder.mkdir()
        program(folder, "")
    monkeypatch.setenv("PATH", str(second))
    assert tools.find("chandelier-bake", [first]) == str(first / "chandelier-bake")
    assert tools.find("chandelier-bake", [tmp_path]) == str(second / "chandelier-bake")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(tools.ToolError, match="chandelier-bake: is neither in PATH nor in .*preferences"):
        tools.find("chandelier-bake", [tmp_path])


def test_a_file_that_cannot_be_run_says_so(tmp_path):
    (tmp_path / "none").write_text("")
    with pytest.raises(tools.ToolError, match="cannot be run"):
        tools.Job([str(tmp_path / "none")])


def test_the_player_is_told_the_distance_and_the_budget():
    command = tools.play_command("play", "a.chandelier", tools.Shown())
    assert command[command.index("--d-init") + 1] == "0.5" and "--max-shadow-maps" not in command and "--camera" not in command
    command = tools.play_command("play", "a.chandelier", tools.Shown(d_init=0.3, budget_maps=20, budget_mib=100, camera="Eye"))
    assert command[command.index("--d-init") + 1] == "0.3"
    assert command[command.index("--max-shadow-maps") + 1] == "20" and command[command.index("--max-shadow-bytes") + 1] == "100"
    assert command[-2:] == ["--camera", "Eye"]


def test_progress_warnings_and_what_it_does(tmp_path):
    job = tools.Job([program(tmp_path, """
for name in ("import", "materials, animation"):
    print(f"chandelier-bake:    0.10 s:   0.05 s for {name}", file=sys.stderr)
print("chandelier-bake: warning: scene: lights: odd: Lamp", file=sys.stderr, flush=True)
time.sleep(60)""")])
    patience = time.monotonic() + 30
    while not job.warnings and time.monotonic() < patience:
        assert job.is_running()
        time.sleep(0.01)
    assert job.warnings == ["scene: lights: odd: Lamp"]
    assert job.doing == "find_geometry" and 0 < job.progress < 0.2
    job.cancel()
    assert not job.is_running() and job.error == "chandelier-bake: cancelled"
    assert not os.path.exists(job.output_path)


def test_one_that_does_not_listen_is_ended_too(tmp_path, monkeypatch):
    monkeypatch.setattr(tools, "PATIENCE_S", 0.2)
    job = tools.Job([program(tmp_path, """
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print("ready", file=sys.stderr, flush=True)
time.sleep(60)""")])
    while not job.last:
        job.is_running()
        time.sleep(0.01)
    job.cancel()
    assert job.process.returncode == -9 and job.error == "chandelier-bake: cancelled"


@pytest.mark.parametrize("text, says", [
    ("print('chandelier-bake: error: a.glb: broken', file=sys.stderr); sys.exit(1)", "chandelier-bake: a.glb: broken"),
    ("print('not known', file=sys.stderr); sys.exit(2)", "chandelier-bake: not known"),
    ("sys.stderr.write('no end of line'); sys.exit(1)", "chandelier-bake: no end of line"),
    ("sys.exit(5)", "chandelier-bake: ended with status 5"),
    ("os.kill(os.getpid(), 11)", "chandelier-bake: ended by signal 11"),
    ("print('chandelier-bake: error: said, but it went on', file=sys.stderr)", "")])
def test_why_it_failed(tmp_path, text, says):
    assert ended(tools.Job([program(tmp_path, text)])).error == says


@needs_bake
def test_the_baker_itself(tmp_path):
    pack, bake = tmp_path / "room.chandelier", str(BIN / "chandelier-bake")
    for _ in range(2):  # the second finds the first's geometry in the cache
        job = ended(tools.Job(tools.bake_command(bake, ROOM / "room.gltf", pack, tmp_path / "cache")))
        assert job.error == "" and pack.exists() and job.progress == 1
    job = ended(tools.Job(tools.bake_command(bake, tmp_path / "none.glb", pack)))
    assert job.error.startswith("chandelier-bake: ") and "none.glb: no such file" in job.error


@needs_bake
def test_the_bakers_passes_are_known_in_their_order(tmp_path):
    command = tools.bake_command(str(BIN / "chandelier-bake"), ROOM / "room.gltf", tmp_path / "a.chandelier", tmp_path / "cache")
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    # It warns that the room has no lights.
    *passes, total = [line for line in done.stderr.splitlines() if not tools.MESSAGE_LINE.match(line)]
    assert [name for line in passes for name in line.split(" s for ")[1].split(", ")] == list(tools.PASSES)
    # Of passes that share a line the last is found, and nothing in the line that sums up.
    assert [tools.PASS_LINE.match(line)[1] for line in passes] == [line.split(" s for ")[1].split(", ")[-1] for line in passes]
    assert not tools.PASS_LINE.match(total)
