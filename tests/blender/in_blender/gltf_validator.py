# SPDX-License-Identifier: Apache-2.0
"""Khronos' glTF validator, from npm into the build folder."""

import json
import os
import pathlib
import shutil
import subprocess

BUILD = pathlib.Path(os.environ.get("CHANDELIER_BUILD", pathlib.Path(__file__).resolve().parents[3] / "build"))
FOLDER = BUILD / "blender" / "gltf-validator"
PACKAGE = "gltf-validator@2.0.0-dev.3.10"
SCRIPT = """
const fs = require('fs'), validator = require('gltf-validator');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])), {maxIssues: 100}).then(
  (report) => console.log(JSON.stringify(report)));
"""


def lacking():
    """Why it cannot be had, or nothing."""
    if not shutil.which("node") or not shutil.which("npm"):
        return "no node or no npm"
    if not (FOLDER / "node_modules" / "gltf-validator").is_dir():
        FOLDER.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(["npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", FOLDER, PACKAGE],
                              capture_output=True, text=True)
        if done.returncode != 0:
            return f"npm cannot fetch {PACKAGE}"
    return ""


def issues(path):
    """Errors and warnings of a glTF, a line each."""
    done = subprocess.run(["node", "-e", SCRIPT, path], capture_output=True, text=True, cwd=FOLDER, check=True)
    messages = json.loads(done.stdout)["issues"]["messages"]
    return [f"{message['code']} {message.get('pointer', '')}: {message['message']}"
            for message in messages if message["severity"] < 2]
