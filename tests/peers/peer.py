"""Renders a caustix scene with Mitsuba, several times with independent seeds.

    python peer.py direct.toml --receiver floor --eye 0.6 0 0.5 -o floor.npz
    python peer.py direct.toml --camera -o camera.npz

The result holds `renders`, of shape (renders, rows, columns, 3): illuminance in lx of each cell of a receiver, or luminance in
cd/m2 of each pixel of the scene's camera, by channel of linear sRGB.
"""

import argparse
import math
import time

import mitsuba_scene
import mitsuba as mi
import numpy as np


def _render(world, integrator, seeds, samples):
    mi.logger().clear_appenders()  # progress bars, which no log level silences; errors come as exceptions
    scene = mi.load_dict(world | {"integrator": integrator})
    return np.stack([np.array(mi.render(scene, spp=samples, seed=seed), dtype=np.float64) for seed in seeds])


def main():
    """Reads the command line, renders, writes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--receiver", help="look at this receiver cell by cell")
    what.add_argument("--camera", action="store_true", help="the scene's own camera")
    parser.add_argument("--eye", type=float, nargs=3, help="where to look at the receiver from: nothing may stand between")
    parser.add_argument("--integrator", choices=["path", "ptracer"], default="path")
    parser.add_argument("--samples", type=int, default=64, help="samples a pixel, each render; the particle tracer: photons a pixel")
    parser.add_argument("--renders", type=int, default=16)
    parser.add_argument("--seed", type=int, default=1, help="the first render's; the others follow")
    parser.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()

    scene = mitsuba_scene.read(arguments.scene)
    if arguments.camera:
        sensor, factor, events = mitsuba_scene.camera_sensor(scene), 1.0, "all"
        part = (slice(None), slice(None))
    else:
        if arguments.eye is None:
            parser.error("--receiver needs --eye")
        name = arguments.receiver
        sensor, part = mitsuba_scene.receiver_sensor(scene, name, arguments.eye)
        # A lambertian surface has luminance reflectance / pi times its illuminance.
        factor = math.pi / mitsuba_scene.receiver_reflectance(scene, name)
        events = mitsuba_scene.receiver_events(scene, name)

    world = mitsuba_scene.world(scene) | {"sensor": sensor}
    integrator = {"type": arguments.integrator, "max_depth": 2 if events == "direct" else -1}
    seeds = range(arguments.seed, arguments.seed + arguments.renders)
    start = time.time()
    renders = _render(world, integrator, seeds, arguments.samples)
    if events == "indirect":
        direct_only = integrator | {"max_depth": 2}
        other_seeds = range(1_000_000 + arguments.seed, 1_000_000 + arguments.seed + arguments.renders)
        renders -= _render(world, direct_only, other_seeds, arguments.samples)
    np.savez_compressed(arguments.output, renders=renders[:, *part] * factor, version=mi.__version__)
    print(f"{arguments.output}: {arguments.renders} renders with Mitsuba {mi.__version__}, {time.time() - start:.0f} s")


if __name__ == "__main__":
    main()
