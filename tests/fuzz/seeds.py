#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Collects small glTFs as seeds for the importer's fuzz target, each one self-contained: a target sees one file only.

  seeds.py --out FOLDER [--most-bytes N] FOLDER_WITH_GLTFS …
"""

import argparse
import base64
import json
import urllib.parse
from pathlib import Path


def embedded(path):
    """The .gltf with the files that it names as data URIs; None where one is missing or it is not JSON."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        for entry in document.get("buffers", []) + document.get("images", []):
            uri = entry.get("uri")
            if isinstance(uri, str) and not uri.startswith("data:"):
                data = (path.parent / urllib.parse.unquote(uri)).read_bytes()
                entry["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        return json.dumps(document, separators=(",", ":")).encode()
    except (OSError, ValueError, AttributeError, TypeError):
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", metavar="FOLDER", help="searched for .gltf and .glb")
    parser.add_argument("--out", required=True, help="folder for the seeds")
    parser.add_argument("--most-bytes", type=int, default=64 * 1024, help="larger ones are left out (default: %(default)s)")
    arguments = parser.parse_args()
    out = Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)
    count = 0
    for folder in arguments.folders:
        for path in sorted(p for p in Path(folder).rglob("*") if p.suffix in (".gltf", ".glb")):
            data = embedded(path) if path.suffix == ".gltf" else None
            data = path.read_bytes() if data is None else data
            if len(data) <= arguments.most_bytes:
                (out / f"{count:04}{path.suffix}").write_bytes(data)
                count += 1
    print(f"{count} seeds in {out}")


if __name__ == "__main__":
    main()
