"""Compares a caustix map or picture with a peer's, in units of their combined standard error.

    python compare.py ours.exr theirs.npz
    python compare.py ours_seed1.exr ours_seed2.exr ... theirs.npz

Blocks of pixels are averaged first, so that a block's value is close to normal. The standard error of a block is the spread
of its value over independent runs: the peer's renders, and ours if several files are given. Of one file of ours the
channel `standard_error` is used, as if pixels were independent: quasi-Monte Carlo makes the true error of a map's block
smaller, and a density estimate, whose photons count in many pixels, makes it larger. Several files are right for both.

Three questions, each with a probability p of as much or more by chance: is the total the same; are the blocks together
(chi-square); is the worst block (Sidak). The comparison fails, exit code 1, if the least p is below 1e-3 / 3. Student's t is
used throughout: a deviation over a spread of few runs is turned into the normal deviate of the same probability.

A density estimate has bias besides. Where the file has a channel `bias` that is not zero, deviations are tested beyond
the bias that it claims, and both are told. With --strict nothing is taken off: for estimates whose radius is so narrow that
their bias is small against the standard error of a block.

The peer computes in single precision: what that may cost, ROUNDING of the value, is taken off always. It matters where there
is no noise at all, in blocks that show an emitter and nothing else.
"""

import argparse
import sys

import numpy as np
import OpenEXR
from scipy import stats

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
CHANNELS = {"Y": LUMINANCE, "R": np.array([1.0, 0, 0]), "G": np.array([0, 1.0, 0]), "B": np.array([0, 0, 1.0])}
LEVEL = 1e-3
ROUNDING = 2.0**-20


class Estimate:
    """Blocks' means of one renderer with variances, degrees of freedom and bias; the total likewise."""

    def __init__(self, runs, block, variance=None, bias=None):
        """`runs`: (runs, rows, columns). `variance` by pixel if there is but one run."""
        self.pixels = runs.mean(axis=0)
        means = np.stack([blocks(run, block) for run in runs])
        count = len(runs)
        self.mean = means.mean(axis=0)
        self.total = runs.mean()
        if count > 1:
            self.variance = means.var(axis=0, ddof=1) / count
            self.total_variance = runs.mean(axis=(1, 2)).var(ddof=1) / count
            self.freedom = float(count - 1)
        else:
            self.variance = blocks(variance, block) / block**2
            self.total_variance = variance.mean() / variance.size
            self.freedom = np.inf
        self.bias = np.zeros_like(self.mean) if bias is None else np.abs(blocks(bias, block))


def blocks(image, size):
    """Means over blocks of size x size pixels; an incomplete rest at the right and bottom is left out."""
    rows, columns = (n // size for n in image.shape)
    return image[: rows * size, : columns * size].reshape(rows, size, columns, size).mean(axis=(1, 3))


def read_exr(path, channel):
    """Value, standard error and bias by pixel of a caustix EXR file."""
    # Channels apart: the library would else join R, G and B.
    with OpenEXR.File(str(path), separate_channels=True) as file:
        planes = {name: data.pixels.astype(np.float64) for name, data in file.channels().items()}
    grey = next((planes[name] for name in ("illuminance", "Y") if name in planes), None)
    if grey is not None:
        if channel != "Y":
            raise SystemExit(f"{path}: there is no colour in it to compare")
        value = grey
    else:
        value = sum(weight * planes[name] for name, weight in zip("RGB", CHANNELS[channel]))
    nothing = np.zeros_like(value)
    return value, planes.get("standard_error", nothing), planes.get("bias", nothing)


def read_ours(paths, block, channel):
    """Our side: one file with its own standard error, or several of different seeds."""
    values, errors, biases = (np.stack(part) for part in zip(*(read_exr(path, channel) for path in paths)))
    if len(paths) == 1 and channel != "Y":
        raise SystemExit("one file's standard error is that of luminance; give several files for another channel")
    if len(paths) == 1 and not np.isfinite(errors).all():
        raise SystemExit(f"{paths[0]}: no standard error everywhere; give several files of different seeds")
    return Estimate(values, block, errors[0] ** 2, biases.mean(axis=0))


def read_theirs(path, block, channel):
    """The peer's side."""
    return Estimate(np.load(path)["renders"] @ CHANNELS[channel], block)


def deviate(difference, variance_a, freedom_a, variance_b, freedom_b):
    """Normal deviate of a difference; Welch's degrees of freedom. 0 where both agree exactly."""
    variance = variance_a + variance_b
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(difference == 0, 0.0, difference / np.sqrt(variance))
        freedom = variance**2 / (variance_a**2 / freedom_a + variance_b**2 / freedom_b)
    freedom = np.where(np.isfinite(freedom), freedom, max(min(freedom_a, freedom_b), 1.0))
    # By logarithms: p of a large deviate is too small for a float.
    log_p = stats.t.logsf(np.abs(t), freedom)
    return np.sign(difference) * np.clip(-stats.norm.ppf(np.maximum(np.exp(log_p), 1e-300)), 0.0, None)


def judge(ours, theirs, allowed_bias):
    """The three p and what they are of. `allowed_bias`, by block, is taken off the differences."""
    difference = ours.mean - theirs.mean
    excess = np.sign(difference) * np.maximum(np.abs(difference) - allowed_bias, 0.0)
    z = deviate(excess, ours.variance, ours.freedom, theirs.variance, theirs.freedom)
    total_difference = ours.total - theirs.total
    total_excess = np.sign(total_difference) * max(abs(total_difference) - allowed_bias.mean(), 0.0)
    z_total = float(
        deviate(total_excess, ours.total_variance, ours.freedom, theirs.total_variance, theirs.freedom)
    )
    # A block of black, or of an emitter and nothing else, has no noise: where it agrees it must not dilute the others.
    noisy = np.sqrt(ours.variance + theirs.variance) > ROUNDING * np.abs(theirs.mean)
    counted = noisy | (z != 0)
    z_counted = z[counted]
    # Kept below 1 where no block differs at all: the logarithm below would not exist.
    p_of_worst = min(2 * stats.norm.sf(np.abs(z).max()), 1 - 2.0**-53)
    return {
        "z": z,
        "counted": counted,
        "z_total": z_total,
        "p_total": float(2 * stats.norm.sf(abs(z_total))),
        "p_blocks": float(stats.chi2.sf((z**2).sum(), z_counted.size)),
        "p_worst": float(-np.expm1(z_counted.size * np.log1p(-p_of_worst))),
    }


def report(ours, theirs, block, strict):
    """Prints the comparison; True if nothing speaks against agreement."""
    rounding = ROUNDING * np.abs(theirs.mean)
    verdict = judge(ours, theirs, rounding if strict else ours.bias + rounding)
    z, counted = verdict["z"], verdict["counted"]
    z_counted = z[counted]
    ratio = ours.total / theirs.total
    ratio_error = abs(ratio) * np.hypot(
        np.sqrt(ours.total_variance) / ours.total, np.sqrt(theirs.total_variance) / theirs.total
    )
    relative = np.sqrt(np.mean(ours.variance)) / theirs.total, np.sqrt(np.mean(theirs.variance)) / theirs.total
    row, column = np.unravel_index(np.abs(z).argmax(), z.shape)
    print(f"mean            {ours.total:.6g} ours, {theirs.total:.6g} theirs")
    print(f"ratio of totals {ratio:.5f} +- {ratio_error:.5f}  (p = {verdict['p_total']:.3g})")
    print(f"blocks          {z_counted.size} of {block} x {block}; errors {relative[0]:.3%} ours, {relative[1]:.3%} theirs, of the mean")
    print(f"                rms z {np.sqrt(np.mean(z_counted**2)):.3f}  (p = {verdict['p_blocks']:.3g})")
    print(f"                |z| > 2: {np.mean(np.abs(z_counted) > 2):.2%} (4.55 %), |z| > 3: {np.mean(np.abs(z_counted) > 3):.2%} (0.27 %)")
    print(
        f"worst block     row {row}, column {column}: {ours.mean[row, column]:.6g} ours, "
        f"{theirs.mean[row, column]:.6g} theirs, z {z[row, column]:+.2f}  (p = {verdict['p_worst']:.3g})"
    )
    if ours.bias.any():
        plain = judge(ours, theirs, rounding)
        error = np.sqrt(ours.variance + theirs.variance)
        beyond = np.abs(ours.mean - theirs.mean) - rounding
        share = np.median(ours.bias[theirs.mean > 0] / theirs.mean[theirs.mean > 0])
        print(f"bias            median {share:.2%} of the block, {'not ' if strict else ''}taken off above; without: rms z {np.sqrt(np.mean(plain['z'][plain['counted']] ** 2)):.3f}")
        within = [np.mean((beyond <= allowed)[counted]) for allowed in (ours.bias, 3 * error, ours.bias + 3 * error)]
        print("                within bias {:.1%}, 3 standard errors {:.1%}, both {:.1%} of blocks".format(*within))
    # Not a number must not pass.
    agree = bool(np.min([verdict[p] for p in ("p_total", "p_blocks", "p_worst")]) >= LEVEL / 3)
    print("agree" if agree else f"DIFFER: a p is below {LEVEL:g} / 3")
    return agree


def main():
    """Reads the command line, compares, exits 1 if the two differ."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ours", nargs="+", help="EXR files of caustix, or one npz of the peer")
    parser.add_argument("theirs", help="npz of peer.py")
    parser.add_argument("--block", type=int, default=8, help="pixels along a block's side")
    parser.add_argument("--channel", choices=sorted(CHANNELS), default="Y")
    parser.add_argument("--strict", action="store_true", help="take no bias off the differences")
    parser.add_argument("--scale", type=float, default=1.0, help="multiply ours: a comparison that must fail, for trial")
    arguments = parser.parse_args()

    if arguments.ours[0].endswith(".npz"):
        ours = read_theirs(arguments.ours[0], arguments.block, arguments.channel)
    else:
        ours = read_ours(arguments.ours, arguments.block, arguments.channel)
    theirs = read_theirs(arguments.theirs, arguments.block, arguments.channel)
    if ours.pixels.shape != theirs.pixels.shape:
        raise SystemExit(f"{ours.pixels.shape} pixels ours, {theirs.pixels.shape} theirs")
    ours.mean, ours.total = ours.mean * arguments.scale, ours.total * arguments.scale
    sys.exit(0 if report(ours, theirs, arguments.block, arguments.strict) else 1)


if __name__ == "__main__":
    main()
