"""The measurements as Markdown, and their place in a document."""

import math
import statistics
from pathlib import Path

MARKERS = ("<!-- benchmarks: begin -->", "<!-- benchmarks: end -->")
LLVM, SCALAR = "llvm_ad_rgb", "scalar_rgb"


def spread(values, form):
    """Median with minimum and maximum."""
    low, middle, high = min(values), statistics.median(values), max(values)
    return form(middle) if len(values) == 1 else f"{form(middle)} ({form(low)} – {form(high)})"


def significant(value):
    """Three digits."""
    if value == 0:
        return "-"
    if not math.isfinite(value):
        return f"{value}"
    return f"{value:.{max(0, 2 - math.floor(math.log10(abs(value))))}f}"


def table(head, rows):
    """A Markdown table; all columns but the first to the right."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def speed(results):
    """Samples per second and their ratios."""
    rows = []
    for result in results:
        samples, ours, theirs = result["samples"], result["lichtweg"], result["mitsuba"]
        millions = lambda runs: [samples / run["seconds"] * 1e-6 for run in runs]
        ratios = lambda runs: [run["seconds"] / own["seconds"] for own, run in zip(ours, runs)]
        times = lambda value: f"{value:.2f}×"
        rows.append(
            [result["name"], spread(ratios(theirs[LLVM]["runs"]), times), spread(ratios(theirs[SCALAR]["runs"]), times)]
            + [spread(millions(runs), significant) for runs in (ours, theirs[LLVM]["runs"], theirs[SCALAR]["runs"])]
        )
    head = ["scene", f"Lichtweg / {LLVM}", f"Lichtweg / {SCALAR}", "Lichtweg, 10⁶/s", f"{LLVM}, 10⁶/s", f"{SCALAR}, 10⁶/s"]
    return table(head, rows)


def seconds(results):
    """Seconds of the renders, and of what surrounds them."""
    rows = []
    for result in results:
        ours, theirs = result["lichtweg"], result["mitsuba"]
        render = lambda runs: spread([run["seconds"] for run in runs], significant)
        llvm = theirs[LLVM]
        compiling = max(0.0, llvm["first_seconds"] - statistics.median(run["seconds"] for run in llvm["runs"]))
        process = spread([run["process_seconds"] for run in ours], significant)
        rows.append(
            [result["name"], render(ours), process, render(llvm["runs"]), significant(compiling)]
            + [render(theirs[SCALAR]["runs"])]
        )
    head = ["scene", "Lichtweg, render", "Lichtweg, process", f"{LLVM}, render", f"{LLVM}, compile", f"{SCALAR}, render"]
    return table(head, rows)


def means(results):
    """Mean radiance: do the renderers compute the same thing?"""
    rows = []
    for result in results:
        ours, error = mean(result["lichtweg"]), result["standard_error"]
        row = [result["name"], triple(ours), triple(error)]
        suspicious = False
        for variant in (LLVM, SCALAR):
            theirs = mean(result["mitsuba"][variant]["runs"])
            row.append(" ".join(f"{100 * (b / a - 1):+.2f} %" if a else "-" for a, b in zip(ours, theirs)))
            suspicious |= any(differs(a, b, e) for a, b, e in zip(ours, theirs, error))
        rows.append(row + ["**differs**" if suspicious else "agrees"])
    head = ["scene", "Lichtweg, R G B", "standard error", f"{LLVM}", f"{SCALAR}", "verdict"]
    return table(head, rows)


def mean(runs):
    """The mean over runs of equal numbers of samples."""
    return [statistics.fmean(channel) for channel in zip(*(run["mean"] for run in runs))]


def triple(values):
    """Three numbers of one colour."""
    return " ".join(f"{value:.3g}" if value < 1e-3 else f"{value:.5f}" for value in values)


def differs(ours, theirs, error):
    """Whether two means differ by more than 3.5 standard errors, or by more than 2 %. The error of theirs is taken to be
    as large as ours: both have the same number of samples of the same estimator."""
    difference = abs(ours - theirs)
    return difference > 3.5 * math.sqrt(2) * error or difference > 0.02 * abs(ours)


def loading(runs):
    """Stages of loading a scene, in seconds."""
    stages = ["load", "load_parse", "load_meshes", "load_images", "compile", "build"]
    row = [spread([run["seconds"][stage] for run in runs], significant) for stage in stages]
    peak = max(run["memory"]["peak_bytes"] or 0 for run in runs) / 2**20
    counts = [f"{runs[0]['scene']['shapes']:,}", f"{runs[0]['scene']['triangles']:,}"]
    head = ["scene", "shapes", "triangles", "load", "parse", "meshes", "images", "compile", "BVH build", "peak memory"]
    return table(head, [[runs[0]["name"], *counts, *row, f"{peak:.0f} MiB"]])


def document(results, load_runs, facts):
    """The whole section."""
    parts = [f"Made by `{facts['command']}` on {facts['date']}."]
    parts.append("\n".join(f"- {name}: {value}" for name, value in facts["versions"]))
    if results:
        parts += [
            "### Samples per second",
            "Numbers above 1× are in favour of Lichtweg. Medians over the rounds (minimum – maximum).",
            speed(results),
            "### Seconds",
            "*Render* is the rendering alone. *Process* is the whole command: start, load, build, render, write. *Compile* "
            "is the first render of the process less the median of the later ones.",
            seconds(results),
            "### Mean radiance",
            "Mitsuba's columns are relative differences from Lichtweg's mean, per channel. They *differ* beyond 3.5 standard "
            "errors or beyond 2 %.",
            means(results),
        ]
    if load_runs:
        parts += [
            "### Loading a pbrt scene",
            "Seconds. *Parse*, *meshes* and *images* are parts of *load*, the latter two summed over threads; a dash is a "
            "stage that takes no time or is not told apart.",
            loading(load_runs),
        ]
    parts += [f"Left out: {reason}" for reason in facts["left_out"]]
    return "\n\n".join(parts)


def write(path, text, markers=MARKERS):
    """Puts the text between the markers of a document, or at its end where it has none."""
    begin, end = markers
    path = Path(path)
    old = path.read_text() if path.exists() else "# Benchmarks\n"
    if begin in old and end in old:
        before, rest = old.split(begin, 1)
        after = rest.split(end, 1)[1]
    else:
        before, after = old.rstrip("\n") + "\n\n", "\n"
    temporary = path.with_name(path.name + ".tmp")
    temporary.write_text(f"{before}{begin}\n\n{text}\n\n{end}{after}")
    temporary.replace(path)
