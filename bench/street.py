#!/usr/bin/env python3
"""Renders the built-in street as the lecture states it, and writes picture and figures where the README shows them.

    python3 bench/street.py

The lecture (P. Hanrahan, Stanford CS348B, 2010, lecture 14): "1536x654, 16 paths/pixel, 2 bounces, 250,000 faces,
18 min., dual PIII-800". Those are the defaults of builtin:street, so that nothing has to be set. What is compared is paths
per second of the rendering alone, the median of some renders, on a machine that does nothing else.
"""

import argparse
import json
import statistics
import sys

sys.dont_write_bytecode = True  # No __pycache__ in the source tree.

import peers
import report

PICTURE = peers.ROOT / "docs" / "images" / "street.jpg"
README = peers.ROOT / "README.md"
MARKERS = ("<!-- street: begin -->", "<!-- street: end -->")
LECTURE_SECONDS = 18 * 60
PATHS = 1536 * 654 * 16


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--rounds", type=int, default=3, help="timed renders (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="threads; the lecture's machine had two processors (default: %(default)s)")
    parser.add_argument("--no-build", action="store_true", help="take the command as it was built last")
    options = parser.parse_args()
    with peers.bench(options.no_build) as folder:
        runs = [render(options.threads, folder) for _ in range(options.rounds)]
    report.write(README, table(runs, options.threads), MARKERS)


def render(threads, folder):
    """The statistics of one render, whose picture replaces the last one."""
    stats = folder / "stats.json"
    command = [peers.BINARY, "render", "builtin:street", "--threads", threads, "--output", PICTURE, "--stats", stats]
    peers.run(command, "the street could not be rendered")
    return json.loads(stats.read_text())


def table(runs, threads):
    """The lecture's figures and ours."""
    seconds = statistics.median(run["seconds"]["render"] for run in runs)
    faces = runs[0]["scene"]["triangles"]
    rows = [
        ["Arnold, dual PIII-800, as the lecture states", "250,000", f"{LECTURE_SECONDS:,}", f"{PATHS / LECTURE_SECONDS:,.0f}", "1×"],
        [f"Lichtweg, {threads} threads", f"{faces:,}", f"{seconds:.1f}", f"{PATHS / seconds:,.0f}", f"{LECTURE_SECONDS / seconds:.0f}×"],
    ]
    return report.table(["", "faces", "seconds", "paths per second", "ratio"], rows)


if __name__ == "__main__":
    main()
