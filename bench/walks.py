#!/usr/bin/env python3
"""One unknown of large linear systems: `lichtweg solve` beside SciPy, faer, fast-pagerank and NetworkX.

    cargo build --release --features faer
    python3 bench/walks.py                   all systems, about half an hour
    python3 bench/walks.py --small           the same kinds, a hundredth of the size
    python3 bench/walks.py screened pagerank some of them

Makes a virtual environment in target/walks-venv with SciPy and the others from PyPI where there is none, writes the systems
as Matrix Market files into target/walks, and prints a table in Markdown. All programs run on the same machine one after
the other. Times are of the solve alone: reading and preparing (for lichtweg: splitting A, for SciPy: nothing, it gets its
arrays from memory) are listed apart. lichtweg's methods take turns in processes of their own, and the best time of each
counts. faer is `--method direct`.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
BINARY = TARGET / "release" / "lichtweg"
FOLDER = TARGET / "walks"
# Seconds that a program may take.
PATIENCE = 120
# Whose rows are wanted; fast-pagerank and NetworkX go with SciPy.
PROGRAMS = {"scipy", "lichtweg"}
PACKAGES = ["numpy", "scipy", "networkx", "fast-pagerank"]


def enter_environment():
    """Runs this script again in an environment that has the packages."""
    folder = Path(os.environ.get("WALKS_VENV", TARGET / "walks-venv"))
    python = folder / "bin" / "python"
    # In favour of SciPy: its vectors are short for two threads, which wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if Path(sys.prefix).resolve() == folder.resolve():
        return
    if not python.exists():
        print(f"making a virtual environment in {folder}", file=sys.stderr)
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    os.execv(python, [str(python), *sys.argv])


def lichtweg(*arguments):
    """One answer as JSON, or the refusal."""
    command = [str(BINARY), "solve", "--json", *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return {"refused": f"not done in {PATIENCE} s"}
    if done.returncode != 0:
        return {"refused": done.stderr.strip().removeprefix("error: ")}
    found = json.loads(done.stdout)
    return {**found["answers"][0], "load": found["load_seconds"]}


class Table:
    """Rows of one system."""

    def __init__(self, title):
        print(f"\n### {title}\n")
        print("| program | value | interval | solve | walks | transitions and entries used |")
        print("|---|---|---|---|---|---|", flush=True)

    def row(self, program, value, interval="", seconds=None, walks="", operations=""):
        shown = "" if seconds is None else f"{seconds * 1e3:,.1f} ms"
        counts = [f"{n:,}" if isinstance(n, int) else n for n in (walks, operations)]
        print(f"| {program} | {value:.6g} | {interval} | {shown} | {counts[0]} | {counts[1]} |", flush=True)

    def method(self, name, answer):
        """A row of lichtweg's; the seconds."""
        if "refused" in answer:
            print(f"| `{name}` | refused | {answer['refused'].splitlines()[0][:90]} | | | |", flush=True)
            return None
        interval = "" if answer["half_width"] is None else f"± {answer['half_width']:.1e} {answer['evidence']}"
        if not answer["reached"]:
            interval += ", not reached"
        label = name if name != "auto" else f"auto: {answer['method']}"
        operations = answer["steps"] + answer["matrix_entries_used"]
        self.row(f"`{label}`", answer["value"], interval, answer["seconds"], answer["walks"], operations)
        return answer["seconds"]


def methods(table, names, arguments, repeats=5):
    """The planner and each method in turns, the best time of each; those that take long fewer times."""
    names = ["auto", *names]
    answers = {name: [] for name in names}
    for repeat in range(repeats):
        for name in names:
            seconds = [answer["seconds"] for answer in answers[name] if "seconds" in answer]
            if repeat == 0 or (seconds and sum(seconds) < 5):
                answers[name].append(lichtweg(*arguments, "--method", name))
    found = {}
    for name in names:
        best = min(answers[name], key=lambda answer: answer.get("seconds", 1e9))
        found[name] = (best, table.method(name, best))
        if name == "auto" and "load" in best:
            load = min(answer["load"] for answer in answers[name])
            print(f"| (reading and preparing) | | | {load * 1e3:,.0f} ms | | |", flush=True)
    reached = {n: s for n, (a, s) in found.items() if n != "auto" and s is not None and a["reached"]}
    auto = found["auto"][1]
    if auto is not None and reached:
        best = min(reached, key=reached.get)
        why = found["auto"][0]["why"]
        print(f"\nPlanned: {why}. It took {auto / reached[best]:.2f} times the best method asked for, `{best}`.")
    return found


def timed(solve, repeats=3):
    """A result, and the least seconds of some runs."""
    least = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        result = solve()
        least = min(least, time.perf_counter() - start)
        if least > 5:
            break
    return result, least


def grid(side, dimensions, shift):
    """Finite differences on a cube of unknowns, with `shift` on the diagonal."""
    import scipy.sparse as sp

    line = sp.diags([-1.0, 2.0 + shift / dimensions, -1.0], [-1, 0, 1], shape=(side, side))
    one = sp.identity(side)
    total = line
    for _ in range(dimensions - 1):
        total = sp.kron(total, one) + sp.kron(sp.identity(total.shape[0]), line)
    return total.tocsr()


def written(name, matrix, vector):
    """Files of a system."""
    import scipy.io

    FOLDER.mkdir(parents=True, exist_ok=True)
    paths = FOLDER / f"{name}.mtx", FOLDER / f"{name}-b.mtx"
    scipy.io.mmwrite(paths[0], matrix, symmetry="general")
    scipy.io.mmwrite(paths[1], vector.reshape(-1, 1))
    return paths


def linear(name, title, matrix, vector, unknown, names, scipy_direct=True, most_steps=200_000_000):
    """A x = b by all programs, one unknown to 1 % at 95 %."""
    paths = written(name, matrix, vector)
    table = Table(f"{title}: {matrix.shape[0]:,} unknowns, {matrix.nnz:,} entries")
    cg, whole = by_scipy(table, matrix, vector, unknown, scipy_direct) if "scipy" in PROGRAMS else (None, None)
    if "lichtweg" not in PROGRAMS:
        return
    found = methods(table, names, [paths[0], "-b", paths[1], "-u", unknown + 1, "--max-steps", most_steps])
    auto = found["auto"][1]
    if auto and whole:
        print(f"\nSciPy's `cg` took {whole / auto:,.1f} times as long as `lichtweg solve` for all unknowns to 1 %.")
    if auto and cg:
        print(f"\nStopped as soon as this unknown is right, which it cannot know, it took {cg / auto:,.1f} times as long.")


def by_scipy(table, matrix, vector, unknown, direct):
    """Rows of SciPy's; the seconds of `cg` until this unknown is right to 1 %, and until all are."""
    import numpy as np
    import scipy.sparse.linalg as sl

    # In favour of the solver, it is stopped by someone who knows when the error stays below 1 %.
    values, limits = [], dict(rtol=1e-6, maxiter=3000)
    exact, _ = sl.cg(matrix, vector, callback=lambda x: values.append(x[unknown]), **limits)
    wrong = np.flatnonzero(np.abs(np.array(values) / values[-1] - 1) >= 0.01)
    needed = int(wrong[-1]) + 2 if len(wrong) else 1
    whole = None
    if len(values) < 100:
        errors = []
        sl.cg(matrix, vector, callback=lambda x: errors.append(np.max(np.abs(x / exact - 1))), **limits)
        all_needed = int(np.flatnonzero(np.array(errors) >= 0.01)[-1]) + 2
        (x, _), whole = timed(lambda: sl.cg(matrix, vector, rtol=0.0, maxiter=all_needed))
        table.row("SciPy `cg`", x[unknown], f"{all_needed} iterations: all unknowns to 1 %", whole)
    (x, _), cg = timed(lambda: sl.cg(matrix, vector, rtol=0.0, maxiter=needed))
    table.row("SciPy `cg`", x[unknown], f"{needed} iterations: this one to 1 %", cg)
    rtol = np.linalg.norm(vector - matrix @ x) / np.linalg.norm(vector)
    limit = dict(restart=50, maxiter=2)
    (x, failed), seconds = timed(lambda: sl.gmres(matrix, vector, rtol=rtol, **limit), 1)
    told = "100 iterations, not there" if failed else f"rtol {rtol:.1g}, as `cg` had"
    table.row("SciPy `gmres`", x[unknown], told, seconds)
    if direct:
        x, seconds = timed(lambda: sl.spsolve(matrix.tocsc(), vector), 1)
        table.row("SciPy `spsolve`", x[unknown], "exact", seconds)
    return cg, whole


def poisson(name, largest, dimensions, shift, scale):
    """Finite differences, with `shift` on the diagonal: where that is zero, walks leave at the boundary alone."""
    import numpy as np

    side = max(10, round(largest * scale ** (1 / dimensions)))
    matrix = grid(side, dimensions, shift)
    middle = matrix.shape[0] // 2 + side // 2
    # Factors of a large cube fill gigabytes, and SciPy's of a large square take minutes.
    small = scale < 0.1
    if shift:
        title = f"Screened Poisson, {dimensions}-D, rho(|M|) about {1 / (1 + shift / (2 * dimensions)):.3f}"
        names = ["adjoint", "push", "push-walk", "deterministic"]
        linear(name, title, matrix, np.random.default_rng(1).random(matrix.shape[0]), middle, names, small)
    else:
        names = ["adjoint", "push-walk", "deterministic"] + (["direct"] if dimensions == 2 or small else [])
        title = f"Poisson, {dimensions}-D, not screened"
        most_steps = 20_000_000 if dimensions == 2 else 200_000_000
        linear(name, title, matrix, np.ones(matrix.shape[0]), middle, names, dimensions == 2 or small, most_steps)


def resistors(scale):
    """A grid of random conductances with shortcuts, grounded through one node in fifty: potentials by injected currents."""
    import numpy as np
    import scipy.sparse as sp

    random = np.random.default_rng(2)
    side = max(10, round(500 * scale**0.5))
    n = side * side
    node = np.arange(n).reshape(side, side)
    pairs = np.concatenate([
        np.stack([node[:, :-1].ravel(), node[:, 1:].ravel()], 1),
        np.stack([node[:-1].ravel(), node[1:].ravel()], 1),
        random.integers(0, n, (n // 20, 2)),
    ])
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    conductance = np.exp(random.normal(0, 1, len(pairs)))
    links = sp.coo_matrix((conductance, pairs.T), shape=(n, n)).tocsr()
    links = links + links.T
    ground = np.where(random.random(n) < 0.02, 5.0, 0.0)
    ground[0] = 5.0
    matrix = (sp.diags(np.asarray(links.sum(1)).ravel() + ground) - links).tocsr()
    names = ["adjoint", "push-walk", "deterministic", "direct"]
    linear("resistors", "Resistor network", matrix, random.random(n), n // 2 + side // 2, names, scale < 0.1)


def pagerank(scale):
    """A power-law graph by preferential attachment of ends to ends, and one pair of its nodes."""
    import fast_pagerank
    import networkx as nx
    import numpy as np
    import scipy.io
    import scipy.sparse as sp

    random = np.random.default_rng(3)
    nodes, edges = round(1_000_000 * scale), round(10_000_000 * scale)
    rank = random.permutation(nodes)
    sources = rank[(nodes * random.random(edges) ** 2).astype(np.int64)]
    ends = rank[(nodes * random.random(edges) ** 3).astype(np.int64)]
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / "graph.mtx"
    adjacency = sp.coo_matrix((np.ones(edges), (sources, ends)), shape=(nodes, nodes)).tocsr()
    scipy.io.mmwrite(path, adjacency.astype(np.int64))
    start = int(sources[0])
    # One of the hundred nodes with the most edges in, so that walks alone have a chance.
    target = int(np.argsort(np.asarray(adjacency.sum(0)).ravel())[-50])
    personal = np.zeros(nodes)
    personal[start] = 1.0
    table = Table(f"Personalised PageRank of one pair, power-law graph: {nodes:,} nodes, {adjacency.nnz:,} edges")
    rivals = "scipy" in PROGRAMS
    if rivals:
        x, seconds = timed(lambda: fast_pagerank.pagerank_power(adjacency, p=0.85, personalize=personal, tol=1e-8), 1)
        table.row("fast-pagerank `pagerank_power`", x[target], "all nodes", seconds)
    if rivals and scale < 0.1:
        graph = nx.from_scipy_sparse_array(adjacency, create_using=nx.DiGraph)
        ranks, seconds = timed(lambda: nx.pagerank(graph, personalization={start: 1}, tol=1e-12), 1)
        table.row("NetworkX `pagerank`", ranks[target], "all nodes", seconds)
    arguments = [path, "--problem", "pagerank", "--start", start + 1, "-u", target + 1]
    arguments += ["--tolerance", 0.05, "--max-steps", 500_000_000]
    if "lichtweg" not in PROGRAMS:
        return
    found = methods(table, ["forward", "push", "bidirectional"], arguments, 2)
    count = lambda name: found[name][0]["steps"] + found[name][0]["matrix_entries_used"]
    if found["forward"][1] and found["bidirectional"][1]:
        ratio = count("forward") / count("bidirectional")
        print(f"\nWalks alone used {ratio:,.1f} times the operations of bidirectional.")


SYSTEMS = {
    "screened": partial(poisson, "screened", 1000, 2, 0.21),
    "screened-3d": partial(poisson, "screened-3d", 100, 3, 0.316),
    "poisson": partial(poisson, "poisson", 1000, 2, 0.0),
    "poisson-3d": partial(poisson, "poisson-3d", 100, 3, 0.0),
    "resistors": resistors,
    "pagerank": pagerank,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("systems", nargs="*", choices=[*SYSTEMS, []], help="default: all")
    parser.add_argument("--small", action="store_true", help="a hundredth of the size")
    parser.add_argument("--program", choices=["scipy", "lichtweg"], help="one of the programs alone")
    arguments = parser.parse_args()
    if not BINARY.exists():
        sys.exit(f"{BINARY} is missing: cargo build --release --features faer")
    enter_environment()
    if arguments.program:
        PROGRAMS.intersection_update([arguments.program])
    for name in arguments.systems or SYSTEMS:
        SYSTEMS[name](0.01 if arguments.small else 1.0)


if __name__ == "__main__":
    main()
