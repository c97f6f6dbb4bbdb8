#!/usr/bin/env python3
"""Measures what choosing among many lights costs, and what it gains.

    python3 bench/lights.py                   both, as a table for docs/bidirectional.md

**Cost.** A room with a hundred thousand small triangles in the air. All of them emit, or only ten: the geometry is the same, so
that the quotient of times per path is what the choice costs. Once as one mesh, once as a shape each.

**Gain.** Ten thousand small lamps: over a floor (direct light alone), and in the room (paths of six edges). The variance is half
the mean squared difference of two renders with other seeds, once with choice by power, once by place. Gain at equal time is
the quotient of variance times seconds.

Rounds alternate between what is compared, and medians are taken, so that a slow minute of the machine hits all alike.
"""

import argparse
import array
import math
import random
import statistics
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # No __pycache__ in the source tree.

import peers

CAMERA = """Film "rgb" "integer xresolution" [{size}] "integer yresolution" [{size}]
PixelFilter "box"
LookAt {eye}  {at}  0 1 0
Camera "perspective" "float fov" [60]
Integrator "path" "integer maxdepth" [{bounces}]
WorldBegin
"""
ROOM = [(0, 0, 0), (10, 0, 0), (10, 4, 0), (0, 4, 0), (0, 0, 10), (10, 0, 10), (10, 4, 10), (0, 4, 10)]
WALLS = "0 4 5 0 5 1  3 2 6 3 6 7  0 1 2 0 2 3  4 7 6 4 6 5  0 3 7 0 7 4  1 5 6 1 6 2"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--size", type=int, default=192, help="pixels a side (default: %(default)s)")
    parser.add_argument("--spp", type=int, default=16, help="samples per pixel (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="threads (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="timed renders of each (default: %(default)s)")
    parser.add_argument("--keep", type=Path, help="folder to keep the scenes in")
    parser.add_argument("--no-build", action="store_true", help="take the command as it was built last")
    options = parser.parse_args()
    with peers.bench(options.no_build) as folder:
        folder = options.keep or folder
        folder.mkdir(exist_ok=True)
        costs(options, folder)
        gains(options, folder)


def costs(options, folder):
    """Seconds a million paths, by how many triangles emit."""
    print("| 100,000 triangles | 10 emit | all emit | quotient |\n|---|---:|---:|---:|")
    for name, apart in [("one mesh", False), ("a shape each", True)]:
        scenes = [folder / f"cost-{apart}-{lit}.pbrt" for lit in (10, 100_000)]
        for scene, lit in zip(scenes, (10, 100_000)):
            scene.write_text(room(options.size, 100_000, lit, apart))
        few, all_ = rounds(options, [(scene, []) for scene in scenes])
        per_path = 1e6 / (options.size**2 * options.spp)
        few, all_ = statistics.median(few) * per_path, statistics.median(all_) * per_path
        print(f"| {name} | {few:.3f} s | {all_:.3f} s | {all_ / few:.2f} |", flush=True)


def gains(options, folder):
    """Variance and time by power and by place."""
    print("\n| 10,000 lamps | variance, power over place | time, place over power | gain at equal time |\n|---|---:|---:|---:|")
    for name, scene in [("over a floor", floor(options.size, 10_000)), ("in a room", room(options.size, 10_000, 10_000, False))]:
        path = folder / f"gain-{name.replace(' ', '-')}.pbrt"
        path.write_text(scene)
        ways = [(path, ["--integrator", f"path:hide_emitters=true,lights={way}"]) for way in ("power", "tree")]
        by_power, by_place = rounds(options, ways)
        seconds = statistics.median(by_place) / statistics.median(by_power)
        power, place = (variance(options, path, way, folder) for _, way in ways)
        print(f"| {name} | {power / place:.1f} | {seconds:.2f} | {power / place / seconds:.1f} |", flush=True)


def rounds(options, renders):
    """Seconds of rendering of each, in alternating rounds."""
    seconds = [[] for _ in renders]
    for round_ in range(options.rounds):
        for took, (scene, arguments) in zip(seconds, renders):
            took.append(render(options, scene, [*arguments, "--seed", round_])["seconds"]["render"])
    return seconds


def render(options, scene, arguments):
    return peers.lichtweg(scene, ["--spp", options.spp, "--threads", options.threads, *arguments])


def variance(options, scene, arguments, folder):
    """Of a pixel."""
    images = []
    for seed in (1, 2):
        image = folder / f"{seed}.pfm"
        render(options, scene, [*arguments, "--seed", seed, "-o", image])
        images.append(pfm(image))
    return statistics.fmean((a - b) ** 2 for a, b in zip(*images)) / 2


def pfm(path):
    """The numbers of a little-endian PFM file."""
    data = path.read_bytes()
    at = 0
    for _ in range(3):
        at = data.index(b"\n", at) + 1
    return array.array("f", data[at:])


def room(size, count, lit, apart):
    """Triangles in the air of a closed grey room; some emit."""
    points = " ".join(" ".join(map(str, p)) for p in ROOM)
    scene = CAMERA.format(size=size, eye="9 2 9", at="2 1.5 2", bounces=5)
    scene += f'Material "diffuse" "rgb reflectance" [.5 .5 .5]\nShape "trianglemesh" "point3 P" [{points}] "integer indices" [{WALLS}]\n'
    chance = random.Random(1)
    lamps = [triangle(chance, [chance.uniform(0.1, 9.9), chance.uniform(0.2, 3.9), chance.uniform(0.1, 9.9)], 0.008, math.pi) for _ in range(count)]
    glow = 40_000 * 70 / lit
    return scene + dark() + shapes(lamps[lit:], apart) + shining(glow) + shapes(lamps[:lit], apart)


def floor(size, count):
    """A floor under lamps that look down, more or less."""
    scene = CAMERA.format(size=size, eye="10 9 19", at="10 0 9", bounces=1)
    scene += 'Material "diffuse" "rgb reflectance" [.5 .5 .5]\nShape "trianglemesh" "point3 P" [0 0 0  20 0 0  20 0 20  0 0 20] "integer indices" [0 2 1 0 3 2]\n'
    chance = random.Random(2)
    lamps = [triangle(chance, [chance.uniform(0, 20), chance.uniform(0.3, 1.5), chance.uniform(0, 20)], 0.02, 0.8) for _ in range(count)]
    return scene + dark() + shining(200) + shapes(lamps, False)


def dark():
    return 'Material "diffuse" "rgb reflectance" [0 0 0]\n'


def shining(radiance):
    return f'AreaLightSource "diffuse" "bool twosided" true "rgb L" [{radiance} {radiance} {radiance}]\n'


def triangle(chance, center, size, tilt):
    """A triangle about a centre whose normal is at most `tilt` from straight down."""
    cos, turn = chance.uniform(math.cos(tilt), 1), chance.uniform(0, 2 * math.pi)
    sin = math.sqrt(1 - cos * cos)
    normal = [sin * math.cos(turn), -cos, sin * math.sin(turn)]
    across = unit(cross(normal, [0.3, 0.5, 0.8]))
    up = cross(normal, across)
    angles = [0, 2 * math.pi / 3, 4 * math.pi / 3]
    return [[c + size * (math.cos(a) * x + math.sin(a) * y) for c, x, y in zip(center, across, up)] for a in angles]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def shapes(triangles, apart):
    """Shapes of them: one, or one each."""
    return "".join(map(mesh, [[t] for t in triangles] if apart else [triangles] if triangles else []))


def mesh(triangles):
    points = " ".join(f"{x:.5g}" for t in triangles for p in t for x in p)
    indices = " ".join(map(str, range(3 * len(triangles))))
    return f'Shape "trianglemesh" "point3 P" [{points}] "integer indices" [{indices}]\n'


if __name__ == "__main__":
    main()
