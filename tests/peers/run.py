"""Renders the scenes of this folder with caustix and with Mitsuba and compares them; docs/VALIDATION.md shows the results.

    python run.py --caustix ../../target/release/caustix receivers
    python run.py --caustix ../../target/release/caustix cameras
    python run.py --caustix ../../target/release/caustix faults

`receivers`: illuminance maps, cell by cell. `cameras`: pictures. `faults`: receivers again, with something wrong in our copy of the
scene: each of these comparisons must fail. Exit code 1 if a comparison does not come out as it must.
"""

import argparse
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent

# Scene, receiver, the eye to look at it from, the peer's integrator, its samples a pixel.
RECEIVERS = [
    ("direct", "floor", (0.6, 0.0, 0.5), "path", 256),
    ("direct", "floor direct", (0.6, 0.0, 0.5), "path", 256),
    ("enclosure", "floor", (1.0, 0.8, 0.9), "path", 64),
    ("enclosure", "red wall", (1.0, 0.8, 0.6), "path", 64),
    ("enclosure", "far wall indirect", (1.0, 0.8, 0.6), "path", 64),
    ("caustic", "floor", (0.5, 0.0, 0.6), "ptracer", 256),
]

# Scene, our method, the peer's integrator, its samples a pixel, the channels to compare.
CAMERAS = [
    ("direct", "map", "path", 128, "Y"),
    ("direct", "splat", "path", 128, "Y"),
    ("enclosure", "map", "path", 32, "YRGB"),
    ("enclosure", "splat", "path", 32, "YRGB"),
    ("caustic", "splat", "ptracer", 512, "Y"),
    ("caustic", "map", "ptracer", 512, "Y"),
]

# Index in RECEIVERS, text in the scene, what we trace instead, what it is.
FAULTS = [
    (0, "flux_lm = 1000.0", "flux_lm = 1010.0", "panel 1 % too bright"),
    (0, "max = [-0.1, 0.2, 0.4]", "max = [-0.1, 0.2, 0.41]", "box 10 mm too high"),
    (1, "aim = [0.5, -0.4, -1.0]", "aim = [0.5, -0.4, -1.1]", "panel tilted 2.4 degrees less"),
    (2, "reflectance = 0.8", "reflectance = 0.79", "walls' reflectance 0.79 for 0.80"),
    (4, "reflectance = [0.75, 0.15, 0.1]", "reflectance = [0.15, 0.75, 0.1]", "red wall green"),
    (5, "ior = 1.5", "ior = 1.505", "index of the ball 1.505 for 1.500"),
    (5, "radius = 0.1", "radius = 0.0995", "ball 0.5 % too small"),
]


def caustix(arguments, scene_text, folder, *extra):
    """One run a seed of a scene; the folders of the results."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(scene_text)
    results = []
    for seed in range(1, arguments.runs + 1):
        result = folder / f"seed_{seed}"
        command = [arguments.caustix, "render", scene, "-o", result, "--seed", str(seed), "--photons", arguments.photons]
        subprocess.run([str(part) for part in [*command, "--quiet", *extra]], check=True)
        results.append(result)
    return results


def peer(arguments, scene, output, samples, *extra):
    """The peer's renders; those of an earlier call if the scene is as old as then (delete them to have others)."""
    if not output.exists() or output.stat().st_mtime < (HERE / f"{scene}.toml").stat().st_mtime:
        output.parent.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, HERE / "peer.py", HERE / f"{scene}.toml", "-o", output, "--samples", samples]
        command += ["--renders", arguments.runs, *extra]
        subprocess.run([str(part) for part in command], check=True)
    return output


def compare(files, theirs, must_agree=True, channel="Y"):
    """Runs compare.py; True if it came out as it must."""
    command = [sys.executable, HERE / "compare.py", *files, theirs, "--channel", channel]
    code = subprocess.run([str(part) for part in command], check=False).returncode
    if code not in (0, 1):
        raise SystemExit(code)
    return (code == 0) == must_agree


def without_camera(scene):
    """The scene's text up to its [camera], which stands last."""
    return (HERE / f"{scene}.toml").read_text().split("[camera]")[0]


def receiver_peer(arguments, case):
    """The peer's renders of a case of RECEIVERS."""
    scene, receiver, eye, integrator, samples = case
    output = arguments.output / "peer" / f"{scene} {receiver}.npz"
    return peer(arguments, scene, output, samples, "--receiver", receiver, "--eye", *eye, "--integrator", integrator)


def receivers(arguments):
    """Every receiver; True for each that agrees."""
    ours = {}
    for case in RECEIVERS:
        scene, receiver = case[:2]
        theirs = receiver_peer(arguments, case)
        if scene not in ours:
            ours[scene] = caustix(arguments, without_camera(scene), arguments.output / scene, "--replicates", "1")
        print(f"\n== {scene}, receiver \"{receiver}\", against {case[3]}", flush=True)
        yield compare([folder / f"{receiver}.exr" for folder in ours[scene]], theirs)


def cameras(arguments):
    """Every camera; True for each that agrees."""
    for scene, method, integrator, samples, channels in CAMERAS:
        output = arguments.output / "peer" / f"{scene} camera.npz"
        theirs = peer(arguments, scene, output, samples, "--camera", "--integrator", integrator)
        text = (HERE / f"{scene}.toml").read_text() + f'method = "{method}"\n'
        ours = caustix(arguments, text, arguments.output / f"{scene} {method}")
        for channel in channels:
            print(f"\n== {scene}, camera, {method}, channel {channel}, against {integrator}", flush=True)
            yield compare([folder / "camera.exr" for folder in ours], theirs, channel=channel)


def faults(arguments):
    """Every fault; True for each that is found."""
    for number, (index, right, wrong, what) in enumerate(FAULTS):
        scene, receiver = RECEIVERS[index][:2]
        theirs = receiver_peer(arguments, RECEIVERS[index])
        text = without_camera(scene)
        if text.count(right) != 1:
            raise SystemExit(f"{scene}.toml holds {right!r} {text.count(right)} times, once is required")
        ours = caustix(arguments, text.replace(right, wrong), arguments.output / f"fault {number}", "--replicates", "1")
        print(f"\n== {scene}, receiver \"{receiver}\": {what}; must differ", flush=True)
        yield compare([folder / f"{receiver}.exr" for folder in ours], theirs, must_agree=False)


def main():
    """Reads the command line, runs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["receivers", "cameras", "faults"])
    parser.add_argument("--caustix", default=HERE / "../../target/release/caustix", help="the program")
    parser.add_argument("--photons", default="2^20", help="photons of each of our runs")
    parser.add_argument("--runs", type=int, default=16, help="runs of ours, and renders of the peer's")
    parser.add_argument("-o", "--output", type=Path, default=Path("peers-out"))
    arguments = parser.parse_args()
    outcomes = list({"receivers": receivers, "cameras": cameras, "faults": faults}[arguments.what](arguments))
    print(f"\n{sum(outcomes)} of {len(outcomes)} came out as they must")
    sys.exit(0 if all(outcomes) else 1)


if __name__ == "__main__":
    main()
