#!/usr/bin/env python3
"""Measures bidirectional path tracing against path tracing at equal time, here and in Mitsuba 3.

    python3 bench/bidirectional.py SCENE.xml              the table of docs/bidirectional.md
    python3 bench/bidirectional.py SCENE.xml --no-mitsuba

Each estimator renders for the same time with the default settings of the command, several times with other seeds. Errors are those
against a long render of the same program: plain mean squared error, and relMSE, the mean over pixels and channels of
(x - ref)^2 / (ref^2 + 0.001), also trimmed of the worst thousandth of all pixels. Besides, what a sample costs: seconds a sample
by `bdpt` over those by `path`, in alternating rounds, of which the median is taken.

Mitsuba renders with the samples that fit into the time, known from a short render before; what it takes to compile its kernels
does not count.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True  # No __pycache__ in the source tree.

import peers
from lights import pfm


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scene", type=Path, help="a scene in Mitsuba's format")
    parser.add_argument("--size", type=int, default=128, help="pixels a side (default: %(default)s)")
    parser.add_argument("--max-depth", type=int, default=7, help="edges of a path (default: %(default)s)")
    parser.add_argument("--time", type=float, default=3.0, help="seconds of each render (default: %(default)s)")
    parser.add_argument("--seeds", type=int, default=3, help="renders of each (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="threads (default: %(default)s)")
    parser.add_argument("--reference", type=int, default=2048, help="samples of the reference (default: %(default)s)")
    parser.add_argument("--venv", type=Path, default=Path(tempfile.gettempdir()) / "lichtweg-bench", help="environment with Mitsuba")
    parser.add_argument("--no-mitsuba", action="store_true", help="leave out Mitsuba")
    parser.add_argument("--no-build", action="store_true", help="take the command as it was built last")
    options = parser.parse_args()
    with peers.bench(options.no_build) as folder:
        table(options, folder)
        costs(options)


def table(options, folder):
    """Errors after equal time."""
    reference = folder / "reference.pfm"
    render(options, ["--integrator", "bdpt", "--sampler", "sobol", "--spp", options.reference, "--seed", 1000, "-o", reference])
    reference = pfm(reference)
    print("| estimator | samples per pixel | relMSE | trimmed | MSE |\n|---|---:|---:|---:|---:|")
    for name in ("path", "bdpt"):
        found = []
        for seed in range(options.seeds):
            image = folder / "image.pfm"
            result = render(options, ["--integrator", name, "--time", options.time, "--seed", seed, "-o", image])
            found.append([result["result"]["samples_per_pixel"], *errors(pfm(image), reference)])
        row(f"`{name}`", found)
    if not options.no_mitsuba:
        row("Mitsuba `path`", mitsuba(options))


def render(options, arguments):
    size = f"{options.size}x{options.size}"
    settings = ["--size", size, "--filter", "box", "--max-depth", options.max_depth, "--threads", options.threads]
    return peers.lichtweg(options.scene, [*settings, *arguments])


def errors(image, reference):
    """relMSE, the same trimmed, and the plain mean squared error."""
    squares = [(x - r) ** 2 for x, r in zip(image, reference)]
    relative = [s / (r * r + 1e-3) for s, r in zip(squares, reference)]
    pixels = sorted(sum(relative[i : i + 3]) / 3 for i in range(0, len(relative), 3))
    kept = pixels[: len(pixels) - len(pixels) // 1000]
    return [statistics.fmean(pixels), statistics.fmean(kept), statistics.fmean(squares)]


def row(name, found):
    samples, relative, trimmed, plain = (statistics.fmean(column) for column in zip(*found))
    print(f"| {name} | {samples:.0f} | {relative:.3g} | {trimmed:.3g} | {plain:.3g} |", flush=True)


MITSUBA = """
import json, sys, time
import numpy, mitsuba
scene_file, size, depth, threads, limit, seeds, reference = sys.argv[1:]
mitsuba.set_variant("llvm_ad_rgb")
import drjit
drjit.set_thread_count(int(threads))
scene = mitsuba.load_file(scene_file, resx=size, resy=size, max_depth=depth, rfilter="box", spp="16")
def render(spp, seed):
    start = time.perf_counter()
    image = numpy.array(mitsuba.render(scene, spp=spp, seed=seed))[..., :3]
    return image.astype("float64"), time.perf_counter() - start
render(16, 1)
spp = max(1, round(64 * float(limit) / render(64, 2)[1]))
render(spp, 3)
spp = max(1, round(spp * float(limit) / render(spp, 4)[1]))
images = [render(spp, 10 + seed)[0] for seed in range(int(seeds))]
long = sum(render(spp, 1000 + i)[0] for i in range(int(reference))) / int(reference)
found = []
for image in images:
    square = (image - long) ** 2
    pixels = numpy.sort((square / (long**2 + 1e-3)).mean(axis=2).ravel())
    found.append([spp, pixels.mean(), pixels[: len(pixels) - len(pixels) // 1000].mean(), square.mean()])
print(json.dumps(found))
"""

# Renders of the same time that make up Mitsuba's own reference: it adds a thirtieth to the errors.
MITSUBA_REFERENCE = 30


def mitsuba(options):
    """Errors of Mitsuba's path tracer, against its own long render."""
    arguments = [options.scene, options.size, options.max_depth, options.threads, options.time, options.seeds, MITSUBA_REFERENCE]
    command = [peers.mitsuba_python(options.venv), "-c", MITSUBA, *arguments]
    environment = {"DRJIT_LIBLLVM_PATH": peers.find_llvm()}
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=peers.os.environ | environment)
    if done.returncode != 0:
        raise peers.Missing(f"Mitsuba cannot render {options.scene}:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def costs(options):
    """What a sample costs."""
    quotients = []
    for seed in range(2 * options.seeds):
        seconds = []
        for name, spp in (("path", 64), ("bdpt", 16)):
            result = render(options, ["--integrator", name, "--spp", spp, "--seed", seed])
            seconds.append(result["seconds"]["render"] / spp)
        quotients.append(seconds[1] / seconds[0])
    print(f"\na sample by bdpt costs {statistics.median(quotients):.2f} samples by path")


if __name__ == "__main__":
    main()
