#!/usr/bin/env python3
"""Renders the same scenes with Lichtweg and with Mitsuba 3, and writes down how fast each is.

    python3 bench/compare.py                  the full comparison, into docs/benchmarks.md
    python3 bench/compare.py --help           all options

Needs Python 3.9 with venv, cargo, and libLLVM (Debian: libllvm19). Mitsuba and numpy are installed from PyPI into a
virtual environment under the target folder.

**Method.** Every scene is rendered with the same size, samples per pixel, box filter and number of threads, and with the
scene's own maximal depth: by Lichtweg's path tracer, and by Mitsuba's `path` in the variants scalar_rgb and llvm_ad_rgb.
Rounds alternate between the renderers, so that a slow minute of the machine hits all three. Each Mitsuba variant lives in
a process of its own; its first render, which compiles, is not counted. Lichtweg is a new process every time. Every round
has another seed. What is compared is samples per second of the rendering alone; loading, building and compiling have
columns of their own. A sample costs what it costs at the noise it has: all three run the same estimator, multiple
importance sampling of lights and BSDFs, so that their noise per sample is about the same.

Scenes must declare resx, resy, spp and rfilter with <default>; others are left out, with a note.
"""

import argparse
import datetime
import os
import re
import shlex
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # No __pycache__ in the source tree.

import peers
import report

SHARED = peers.ROOT.parent / "shared" / "scenes"
SHARED_SCENES = ["cornell-box", "veach-mis", "veach-bidir", "veach-ajar"]
LOADING = SHARED / "house" / "scene-v4.pbrt"
PARAMETERS = ["resx", "resy", "spp", "rfilter"]


def main():
    parser = arguments()
    options = parser.parse_args()
    try:
        compare(options, command(parser, options))
    except peers.Missing as problem:
        sys.exit(f"error: {problem}")


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scenes", nargs="*", help="Mitsuba XML files (default: those beside the checkout, else scenes/*.xml)")
    parser.add_argument("--size", default="512x512", help="WxH in pixels (default: %(default)s)")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="threads of each renderer (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="timed renders of each (default: %(default)s)")
    parser.add_argument("--loading", default=LOADING, help="pbrt scene whose loading is measured (default: the house)")
    parser.add_argument("--venv", default=peers.TARGET / "mitsuba-venv", help="virtual environment (default: in target)")
    parser.add_argument("--no-build", action="store_true", help="take the command as it was built last")
    parser.add_argument("--output", default=peers.ROOT / "docs" / "benchmarks.md", help="Markdown file to write into")
    return parser


def command(parser, options):
    """The command line that repeats this: options that differ from the defaults, but for where things are kept."""
    words = ["python3", "bench/compare.py"]
    for name in ["size", "spp", "threads", "rounds", "loading"]:
        value = getattr(options, name)
        if value != parser.get_default(name):
            words += [f"--{name}", str(value)]
    return shlex.join(words + [shown(scene) for scene in options.scenes])


def shown(path):
    """A path as a document may name it: relative to the repository, or the file's name alone."""
    relative = os.path.relpath(path, peers.ROOT)
    return Path(path).name if relative.startswith(os.path.join("..", "..")) else relative


def compare(options, command_line):
    """Measures, and writes."""
    width, height = map(int, re.fullmatch(r"(\d+)x(\d+)", options.size).groups())
    python, llvm = peers.mitsuba_python(options.venv), peers.find_llvm()
    if not options.no_build:
        peers.build()
    settings = {"resx": width, "resy": height, "spp": options.spp, "rfilter": "box"}
    results, left_out, versions = [], [], {}
    for scene in options.scenes or default_scenes():
        say(f"{scene}")
        try:
            check(scene)
            results.append(measure(scene, settings, options, python, llvm, versions))
        except peers.Missing as problem:
            say(f"  left out: {problem}")
            left_out.append(f"`{name(scene)}`: {str(problem).splitlines()[0].replace(str(scene), name(scene))}")
    load_runs = measure_loading(options, left_out)
    facts = {
        "command": command_line,
        "date": datetime.date.today().isoformat(),
        "versions": [
            ("machine", f"{peers.machine()}; {options.threads} threads for each renderer"),
            ("settings", f"{options.size} pixels, {options.spp} samples per pixel, box filter; rounds: {options.rounds}"),
            ("Lichtweg", peers.lichtweg_version()),
            ("Mitsuba", f"{versions.get('mitsuba', 'not run')}, with {Path(llvm).name}"),
        ],
        "left_out": left_out,
    }
    report.write(options.output, report.document(results, load_runs, facts))
    say(f"wrote {options.output}")


def default_scenes():
    """The scenes beside the checkout, or else the project's own."""
    shared = [SHARED / scene / "scene.xml" for scene in SHARED_SCENES]
    return [scene for scene in shared if scene.exists()] or sorted((peers.ROOT / "scenes").glob("*.xml"))


def check(scene):
    """Refuses a scene that cannot be told its settings."""
    try:
        text = Path(scene).read_text()
    except OSError as error:
        raise peers.Missing(f"cannot be read: {error.strerror}") from error
    absent = [p for p in PARAMETERS if not re.search(rf'<default\s+name="{p}"', text)]
    if absent:
        raise peers.Missing(f"declares no <default> for {', '.join(absent)}")


def name(scene):
    """What to call a scene: its file, or the folder of a `scene.xml`."""
    path = Path(scene)
    return path.parent.name if path.stem.startswith("scene") else path.stem


def measure(scene, settings, options, python, llvm, versions):
    """All renders of one scene."""
    parameters = [f"{key}={value}" for key, value in settings.items()]
    ours = [word for parameter in parameters for word in ("-D", parameter)] + ["--threads", options.threads]
    variants = {}
    result = {"name": name(scene), "samples": settings["resx"] * settings["resy"] * settings["spp"]}
    result |= {"lichtweg": [], "mitsuba": {}}
    errors = []
    try:
        for variant in (report.LLVM, report.SCALAR):
            mitsuba = peers.Mitsuba(python, variant, options.threads, str(scene), parameters, llvm)
            variants[variant], versions["mitsuba"] = mitsuba, mitsuba.version
            first = mitsuba.render(seed=0)["seconds"]
            say(f"  {variant}: first render {first:.2f} s")
            result["mitsuba"][variant] = {"first_seconds": first, "runs": []}
        for seed in range(1, options.rounds + 1):
            statistics = peers.lichtweg(scene, [*ours, "--seed", seed])
            errors.append(statistics["result"]["mean_radiance_standard_error"])
            own = {
                "seconds": statistics["seconds"]["render"],
                "process_seconds": statistics["process_seconds"],
                "mean": statistics["result"]["mean_radiance"],
            }
            result["lichtweg"].append(own)
            for variant, mitsuba in variants.items():
                result["mitsuba"][variant]["runs"].append(mitsuba.render(seed))
            theirs = ", ".join(f"{v} {result['mitsuba'][v]['runs'][-1]['seconds']:.2f} s" for v in variants)
            say(f"  round {seed}: lichtweg {own['seconds']:.2f} s, {theirs}")
    finally:
        for mitsuba in variants.values():
            mitsuba.close()
    # Of the mean over all rounds.
    result["standard_error"] = [sum((e or 0.0) ** 2 for e in channel) ** 0.5 / len(errors) for channel in zip(*errors)]
    return result


def measure_loading(options, left_out):
    """Loads a scene a few times; one sample of a few pixels is rendered along the way."""
    if not Path(options.loading).exists():
        left_out.append(f"loading of `{name(options.loading)}`: the scene is not there")
        return []
    say(f"{options.loading}")
    runs = []
    for _ in range(options.rounds):
        settings = ["--size", "16x16", "--spp", 1, "--threads", options.threads, "--lenient"]
        runs.append(peers.lichtweg(options.loading, settings) | {"name": name(options.loading)})
    return runs


def say(text):
    """Progress."""
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
