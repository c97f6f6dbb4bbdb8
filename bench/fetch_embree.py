#!/usr/bin/env python3
"""Fetches Embree 4 for `cargo bench -p lichtweg-ray`, from the wheel `embreex` on PyPI.

    EMBREE_LIBRARY=$(bench/fetch_embree.py) cargo bench -p lichtweg-ray

Prints the path of libembree4. The wheel is unpacked below `target/embree` once.
"""

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

VERSION = "4.4.0.post1"
FOLDER = Path(__file__).resolve().parent.parent / "target" / "embree"


def library() -> Path | None:
    return next(iter(sorted(FOLDER.rglob("libembree4*.so*"))), None)


def main() -> None:
    if library() is None:
        with tempfile.TemporaryDirectory() as download:
            pip = [sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary", ":all:"]
            subprocess.run([*pip, "--quiet", "--dest", download, f"embreex=={VERSION}"],
                           check=True, stdout=sys.stderr)
            for wheel in Path(download).glob("*.whl"):
                zipfile.ZipFile(wheel).extractall(FOLDER)
    found = library()
    if found is None:
        sys.exit("the wheel holds no libembree4")
    print(found)


if __name__ == "__main__":
    main()
