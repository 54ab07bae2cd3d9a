"""Renders the scenes of this folder with caustix and with Mitsuba and compares them; docs/VALIDATION.md shows the results.

    python run.py --caustix ../../target/release/caustix receivers
    python run.py --caustix ../../target/release/caustix cameras
    python run.py --caustix ../../target/release/caustix faults
    python run.py --caustix ../../target/release/caustix camera-faults

`receivers`: illuminance maps, cell by cell. `cameras`: pictures. `faults`: receivers again, with something wrong in our copy of the
scene: each of these comparisons must fail; `camera-faults`: the same for pictures. Exit code 1 if a comparison does not come out as it must.
"""

import argparse
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

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



class Picture(NamedTuple):
    """A picture to compare."""

    scene: str
    settings: str  # lines for the end of our [camera]
    integrator: str  # the peer's
    samples: int  # the peer's, a pixel
    channels: str = "Y"
    strict: bool = True  # whether no bias is taken off the differences
    changes: tuple = ()  # (text in the scene, what stands there instead), for both sides


# The eye in the ball, where no path is caught by total reflection: closer to the centre than radius / ior.
IN_THE_BALL = (
    ("position = [0.3, -1.5, 0.5]", "position = [-0.13, -0.05, 0.19]"),
    ("look_at = [0.0, 0.0, 0.5]", "look_at = [0.3, -0.1, 0.0]"),
    ("fov_deg = 55", "fov_deg = 75"),
)

# Splats have no bias; maps of a narrow radius have little of it and must do without its being taken off, too.
PICTURES = {
    "direct, splat": Picture("direct", 'method = "splat"', "path", 256),
    "direct, map": Picture("direct", "", "path", 256, strict=False),
    "direct, map, 10 mm": Picture("direct", "radius = 0.01", "path", 256),
    "enclosure, splat": Picture("enclosure", 'method = "splat"', "path", 64, "YRGB"),
    "enclosure, map": Picture("enclosure", "", "path", 64, strict=False),
    "enclosure, map, 20 mm": Picture("enclosure", "radius = 0.02", "path", 64, "YRGB"),
    "caustic, splat": Picture("caustic", 'method = "splat"', "ptracer", 1024),
    "caustic, map": Picture("caustic", "", "ptracer", 1024, strict=False),
    "caustic, map, 4 mm": Picture("caustic", "radius = 0.004", "ptracer", 1024),
    "glass, map": Picture("glass", "", "path", 64, strict=False),
    "glass, map, 4 mm": Picture("glass", "radius = 0.004", "path", 64, "YRGB"),
    "glass, in the ball, map, 4 mm": Picture("glass", "radius = 0.004", "path", 64, "YRGB", changes=IN_THE_BALL),
}

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

# Key in PICTURES, text in the scene, what we trace instead, what it is.
PICTURE_FAULTS = [
    ("direct, splat", "fov_deg = 45", "fov_deg = 45.45", "field of view 1 % wider"),
    ("direct, splat", "look_at = [0.2,", "look_at = [0.2054,", "camera turned by half a pixel"),
    ("direct, map, 10 mm", "max = [-0.1, 0.2, 0.4]", "max = [-0.1, 0.2, 0.41]", "box 10 mm too high"),
    ("enclosure, splat", "reflectance = 0.8", "reflectance = 0.79", "walls' reflectance 0.79 for 0.80"),
    ("caustic, splat", "ior = 1.5", "ior = 1.505", "index of the ball 1.505 for 1.500"),
    ("caustic, splat", "radius = 0.1", "radius = 0.0995", "ball 0.5 % too small"),
    ("glass, map, 4 mm", "reflectance = 0.9", "reflectance = 0.89", "mirror 0.89 for 0.90"),
    ("glass, in the ball, map, 4 mm", "ior = 1.5\n", "ior = 1.505\n", "index around the eye 1.505 for 1.500"),
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
    if not output.exists() or output.stat().st_mtime < scene.stat().st_mtime:
        output.parent.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, HERE / "peer.py", scene, "-o", output, "--samples", samples]
        command += ["--renders", arguments.runs, *extra]
        subprocess.run([str(part) for part in command], check=True)
    return output


def changed(text, right, wrong):
    """The text with one place replaced, which must be there once."""
    if text.count(right) != 1:
        raise SystemExit(f"the scene holds {right!r} {text.count(right)} times, once is required")
    return text.replace(right, wrong)


def compare(files, theirs, must_agree=True, channel="Y", strict=False):
    """Runs compare.py; True if it came out as it must."""
    command = [sys.executable, HERE / "compare.py", *files, theirs, "--channel", channel, *["--strict"] * strict]
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
    return peer(arguments, HERE / f"{scene}.toml", output, samples, "--receiver", receiver, "--eye", *eye, "--integrator", integrator)


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


def picture_peer(arguments, picture):
    """The scene's text, as both sides have it, and the peer's renders of it."""
    text = (HERE / f"{picture.scene}.toml").read_text()
    for right, other in picture.changes:
        text = changed(text, right, other)
    name = f"{picture.scene} camera" + " changed" * bool(picture.changes)
    scene = arguments.output / "peer" / f"{name}.toml"
    if not scene.exists() or scene.read_text() != text:
        scene.parent.mkdir(parents=True, exist_ok=True)
        scene.write_text(text)
    output = scene.with_suffix(".npz")
    return text, peer(arguments, scene, output, picture.samples, "--camera", "--integrator", picture.integrator)


def cameras(arguments):
    """Every picture; True for each channel of it that agrees."""
    for name, picture in PICTURES.items():
        if not name.startswith(arguments.only):
            continue
        text, theirs = picture_peer(arguments, picture)
        ours = caustix(arguments, f"{text}{picture.settings}\n", arguments.output / name)
        for channel in picture.channels:
            print(f"\n== {name}; channel {channel}, against {picture.integrator}", flush=True)
            yield compare([folder / "camera.exr" for folder in ours], theirs, channel=channel, strict=picture.strict)


def camera_faults(arguments):
    """Every fault of a picture; True for each that is found."""
    for number, (name, right, wrong, what) in enumerate(PICTURE_FAULTS):
        if not name.startswith(arguments.only):
            continue
        picture = PICTURES[name]
        text, theirs = picture_peer(arguments, picture)
        wrong_text = changed(text, right, wrong)
        ours = caustix(arguments, f"{wrong_text}{picture.settings}\n", arguments.output / f"camera fault {number}")
        print(f"\n== {name}: {what}; must differ", flush=True)
        yield compare([folder / "camera.exr" for folder in ours], theirs, must_agree=False, strict=picture.strict)


def faults(arguments):
    """Every fault; True for each that is found."""
    for number, (index, right, wrong, what) in enumerate(FAULTS):
        scene, receiver = RECEIVERS[index][:2]
        theirs = receiver_peer(arguments, RECEIVERS[index])
        text = without_camera(scene)
        ours = caustix(arguments, changed(text, right, wrong), arguments.output / f"fault {number}", "--replicates", "1")
        print(f"\n== {scene}, receiver \"{receiver}\": {what}; must differ", flush=True)
        yield compare([folder / f"{receiver}.exr" for folder in ours], theirs, must_agree=False)


def main():
    """Reads the command line, runs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["receivers", "cameras", "faults", "camera-faults"])
    parser.add_argument("--caustix", default=HERE / "../../target/release/caustix", help="the program")
    parser.add_argument("--photons", default="2^20", help="photons of each of our runs")
    parser.add_argument("--runs", type=int, default=16, help="runs of ours, and renders of the peer's")
    parser.add_argument("--only", default="", help="only pictures whose name begins so")
    parser.add_argument("-o", "--output", type=Path, default=Path("peers-out"))
    arguments = parser.parse_args()
    jobs = {"receivers": receivers, "cameras": cameras, "faults": faults, "camera-faults": camera_faults}
    outcomes = list(jobs[arguments.what](arguments))
    print(f"\n{sum(outcomes)} of {len(outcomes)} came out as they must")
    sys.exit(0 if all(outcomes) else 1)


if __name__ == "__main__":
    main()
