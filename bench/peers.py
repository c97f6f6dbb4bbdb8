"""What the comparison needs besides the scenes: Mitsuba in a virtual environment, libLLVM, and the two renderers.

Every failure a user can mend is a `Missing` whose text says how.
"""

import glob
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
BINARY = TARGET / "release" / "lichtweg"
WORKER = Path(__file__).resolve().parent / "mitsuba_worker.py"
PACKAGES = ["mitsuba>=3.9,<4", "numpy"]

# Where distributions put the library; version 19 is the one that the comparison was made with, so it goes first.
LLVM_FOLDERS = ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib/llvm-{}/lib", "/usr/lib64", "/usr/lib"]
LLVM_NAMES = ["libLLVM.so.{}*", "libLLVM*.so.{}*", "libLLVM-{}.so*"]
LLVM_VERSIONS = [19, 20, 18, 17, 16, 15]


class Missing(Exception):
    """Something is not there, or failed; the text says what to do."""


def mitsuba_python(folder):
    """The Python of a virtual environment that has Mitsuba; makes the environment where there is none."""
    python = Path(folder) / "bin" / "python"
    if not python.exists():
        print(f"making a virtual environment in {folder}", file=sys.stderr)
        run([sys.executable, "-m", "venv", str(folder)], "install Debian's python3-venv")
    if subprocess.run([python, "-c", "import mitsuba, numpy"], capture_output=True).returncode != 0:
        run([python, "-m", "pip", "install", "--quiet", *PACKAGES], "Mitsuba could not be installed from PyPI")
    return python


def find_llvm():
    """Path of libLLVM, from the environment or by search."""
    stated = os.environ.get("DRJIT_LIBLLVM_PATH")
    if stated:
        if not Path(stated).exists():
            raise Missing(f"DRJIT_LIBLLVM_PATH is {stated}, which is not there")
        return stated
    for version in LLVM_VERSIONS:
        for folder in LLVM_FOLDERS:
            for name in LLVM_NAMES:
                found = sorted(glob.glob(f"{folder}/{name}".format(*[version] * 2)))
                if found:
                    return found[0]
    raise Missing(
        "libLLVM was not found: install it (Debian: apt-get install libllvm19), or set DRJIT_LIBLLVM_PATH to the library"
    )


def build():
    """Builds the command, optimised."""
    run(["cargo", "build", "--release"], "cargo could not build lichtweg", cwd=ROOT)


@contextmanager
def bench(no_build):
    """A folder for the time of a measurement with the command, built now unless told not to; what is missing ends the program."""
    try:
        if not no_build:
            build()
        with tempfile.TemporaryDirectory() as folder:
            yield Path(folder)
    except Missing as problem:
        sys.exit(f"error: {problem}")


def run(command, otherwise, cwd=None):
    """Runs a command whose failure ends the comparison."""
    if subprocess.run(list(map(str, command)), cwd=cwd).returncode != 0:
        raise Missing(f"failed: {' '.join(map(str, command))}\n{otherwise}")


def machine():
    """The processor and the operating system, in a few words."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        model = platform.processor() or platform.machine()
    return f"{model}, {os.cpu_count()} logical processors, {platform.system()}"


def lichtweg_version():
    """The version, and the commit where it is known."""
    version = subprocess.run([BINARY, "--version"], capture_output=True, text=True).stdout.split()[-1:]
    commit = subprocess.run(
        ["git", "-C", ROOT, "describe", "--always", "--dirty"], capture_output=True, text=True
    ).stdout.strip()
    return " ".join(version + ([f"({commit})"] if commit else []))


def lichtweg(scene, arguments):
    """One run of the command. Returns its statistics, with the wall-clock seconds of the process as `process_seconds`."""
    with tempfile.TemporaryDirectory() as folder:
        statistics = Path(folder) / "stats.json"
        image = Path(folder) / "image.exr"
        command = [BINARY, "render", scene, "-o", image, "--stats", statistics, "--quiet", *arguments]
        start = time.perf_counter()
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        seconds = time.perf_counter() - start
        if done.returncode != 0:
            raise Missing(f"lichtweg cannot render {scene}:\n{done.stderr}")
        return json.loads(statistics.read_text()) | {"process_seconds": seconds}


class Mitsuba:
    """A process with one scene in one variant."""

    def __init__(self, python, variant, threads, scene, parameters, llvm):
        # An empty home: Dr.Jit keeps compiled kernels there, and would not compile a second time.
        self.home = tempfile.TemporaryDirectory()
        environment = os.environ | {"HOME": self.home.name, "DRJIT_LIBLLVM_PATH": llvm}
        self.process = subprocess.Popen(
            [python, WORKER, variant, str(threads), scene, *parameters],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )
        hello = self.read()
        if "error" in hello:
            self.close()
            raise Missing(f"Mitsuba ({variant}) cannot load {scene}: {hello['error']}")
        self.version = hello["mitsuba"]

    def read(self):
        """The next answer."""
        line = self.process.stdout.readline()
        return json.loads(line) if line else {"error": "the process ended"}

    def render(self, seed):
        """One render: {"seconds", "mean"}."""
        self.process.stdin.write(json.dumps({"seed": seed}) + "\n")
        self.process.stdin.flush()
        result = self.read()
        if "error" in result:
            raise Missing(f"Mitsuba failed to render: {result['error']}")
        return result

    def close(self):
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()
        self.home.cleanup()
