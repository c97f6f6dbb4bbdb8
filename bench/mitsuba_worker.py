"""Renders one scene with one variant of Mitsuba 3, again and again, as it is told.

    python mitsuba_worker.py VARIANT THREADS SCENE.xml [NAME=VALUE ...]

The process loads the scene once and answers requests, one JSON object a line. The first answer is about loading:
{"mitsuba": version, "load_seconds": s}, or {"error": message}. Then each line {"seed": n} on standard input renders the
scene and is answered by {"seconds": s, "mean": [r, g, b]}. The seconds end when the image is a numpy array, for the LLVM
variants compute nothing before someone asks for the numbers. The first render of an LLVM variant compiles its kernels.
"""

import json
import os
import sys
import time


def main():
    variant, threads, scene_file, *parameters = sys.argv[1:]
    # Libraries may print; the answers go where standard output was.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)

    def answer(**values):
        print(json.dumps(values), file=answers, flush=True)

    try:
        import drjit
        import mitsuba
        import numpy

        mitsuba.set_variant(variant)
        drjit.set_thread_count(int(threads))
        start = time.perf_counter()
        scene = mitsuba.load_file(scene_file, **dict(p.split("=", 1) for p in parameters))
        load_seconds = time.perf_counter() - start
    except Exception as error:
        answer(error=f"{type(error).__name__}: {error}")
        return 1
    answer(mitsuba=mitsuba.__version__, load_seconds=load_seconds)

    for request in sys.stdin:
        seed = json.loads(request)["seed"]
        start = time.perf_counter()
        image = numpy.array(mitsuba.render(scene, seed=seed))
        seconds = time.perf_counter() - start
        answer(seconds=seconds, mean=image[..., :3].mean(axis=(0, 1), dtype="float64").tolist())
    return 0


if __name__ == "__main__":
    sys.exit(main())
