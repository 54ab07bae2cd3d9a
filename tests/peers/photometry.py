"""Compares `caustix photometry` with an independent computation, and the files that it writes with what other programs read.

    python photometry.py path/to/caustix [DATA]

DATA (or CAUSTIX_TEST_DATA) is a folder with `ies` and `ldt`. Of 28 files in LM-63 and 12 in EULUMDAT, read here by a reader of
its own, beam and field angles, zonal lumens and the CIE flux code must be those of `--json` to 1e-9. Each table of type C is
then written as LM-63-2002, LM-63-2019 and EULUMDAT and read by photompy and eulumdat (those that are not installed are said and
left out): nodes must be the table's to nine digits, and the flux that the reader gives must be what its own published rule
gives here for the table's nodes, to 1e-6. (Of EULUMDAT with symmetric planes neither reader counts as a witness: photompy 0.3.1
takes Mc for the number of stored planes, eulumdat 0.7.1 mirrors Isym 3.) Exit status 1 where anything differs.
"""

import importlib.metadata
import json
import os
import re
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

FILES = {"ies": 28, "ldt": 12}
SAME = 1e-9
# Nine digits, and the product of two rounded numbers.
DIGITS = 5.1e-9
FLUX = 1e-6


class Table:
    """Intensities in cd: `cd[h, v]`, with the factors that `caustix` emits apart; `lamps_lm` None for absolute photometry."""

    def __init__(self, kind, v, h, cd, factor, lamps_lm):
        self.kind, self.v, self.factor, self.lamps_lm = kind, v, factor, lamps_lm
        self.h, self.cd = (h, cd) if kind == "B" else circle(h, cd)

    def plane(self, c):
        """Intensities over v in the plane c of type C, linear between planes."""
        c = c if 0 <= c <= 360 else c % 360
        return np.array([np.interp(c, self.h, column) for column in self.cd.T])

    def nodes(self, h, v):
        """Intensities with factors at the angles of a reader."""
        rows = [np.interp(v, self.v, self.plane(c), left=0, right=0) for c in h]
        return self.factor * np.array(rows)


def circle(h, cd):
    """The planes of type C over 0..360."""
    if len(h) == 1:
        return np.array([0.0, 360.0]), np.vstack([cd, cd])
    if h[0] == 0 and h[-1] == 90:
        h, cd = np.append(h, 180 - h[-2::-1]), np.vstack([cd, cd[-2::-1]])
    if h[0] == 0 and h[-1] == 180:
        return np.append(h, 360 - h[-2::-1]), np.vstack([cd, cd[-2::-1]])
    if h[0] == 0 and h[-1] == 360:
        return h, cd
    if h[0] == 90 and h[-1] == 270:
        # Mirrored in the 90-270 plane: h stands for 180 - h, too.
        h, cd = np.append(h, 540 - h[-2::-1]), np.vstack([cd, cd[-2::-1]])
    h, order = np.unique(h % 360 if h[-1] - h[0] >= 360 else h, return_index=True)
    cd = cd[order]
    angles = np.concatenate([h - 360, h, h + 360])
    extended = np.vstack([cd, cd, cd])
    at = np.unique(np.concatenate([[0.0, 360.0], angles[(angles >= 0) & (angles <= 360)]]))
    return at, np.array([[np.interp(a, angles, column) for column in extended.T] for a in at])


def read_ies(path):
    text = path.read_bytes().decode("latin-1")
    tilt = re.search(r"^\s*TILT\s*=\s*(.*?)\s*$", text, re.M | re.I)
    year = re.match(r"\s*IES(?:NA)?:?\s*(?:LM-63-)?(\d+)", text)
    year = int(year.group(1)) if year else 1986
    words = re.split(r"[\s,]+", text[tilt.end() :].strip())
    if tilt.group(1).upper() == "INCLUDE":
        words = words[2 + 2 * int(words[1]) :]
    lamps, lumens, multiplier, n_v, n_h, kind = (float(word) for word in words[:6])
    n_v, n_h = int(n_v), int(n_h)
    ballast, field12 = float(words[10]), float(words[11])
    numbers = np.array([float(word) for word in words[13 : 13 + n_v + n_h + n_v * n_h]])
    v, h, cd = np.split(numbers, [n_v, n_v + n_h])
    factor = ballast * (field12 if year in (86, 91, 1986, 1991) else 1)
    kind = {1: "C", 2: "B", 3: "A"}[int(kind)]
    return Table(kind, v, h, cd.reshape(n_h, n_v) * multiplier, factor, None if lumens < 0 else lamps * lumens)


def read_ldt(path):
    lines = path.read_bytes().decode("latin-1").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    number = lambda i: float(lines[i].split()[0].replace(",", "."))
    isym, mc, ng = int(number(2)), int(number(3)), int(number(5))
    conversion, sets = number(23), int(number(25))
    lamps, lamps_lm = number(26), number(28)
    rest = [float(w.replace(",", ".")) for line in lines[26 + 6 * sets + 10 :] for w in line.split()]
    c, v, rest = np.array(rest[:mc]), np.array(rest[mc : mc + ng]), rest[mc + ng :]
    stored = {0: mc, 1: 1, 2: mc // 2 + 1, 3: mc // 2 + 1, 4: mc // 4 + 1}[isym]
    cd = np.array(rest[: stored * ng]).reshape(stored, ng) * conversion * lamps_lm / 1000
    h = {0: c, 1: c[:1] * 0, 2: np.append(c, 360.0)[:stored], 4: np.append(c, 360.0)[:stored]}.get(isym)
    if isym == 3:
        # From C270 over C0 to C90: as 90..270, of which C is the image.
        at = np.append(c[3 * mc // 4 :] - 360, c[: mc // 4 + 1])
        h, cd = (180 - at)[::-1], cd[::-1]
    return Table("C", v, h, cd, 1.0, None if lamps < 0 else lamps_lm)


def zone(table, low, high):
    """Flux between two angles: mean of neighbouring candela, each band shared by solid angle."""
    around = np.trapezoid(table.cd, np.radians(table.h), axis=0)
    edges = np.radians(table.v)
    from_, to = (np.clip(np.radians(end), edges[:-1], edges[1:]) for end in (low, high))
    return float(np.sum(0.5 * (around[1:] + around[:-1]) * (np.cos(from_) - np.cos(to))))


def lobe(angles, intensities, share, closed=False):
    """Full angle of the lobe of the maximum, to where it has fallen to its share."""
    if not intensities.max() > 0:
        return None
    equal = np.flatnonzero(intensities == intensities.max())
    peak = equal[np.argmin(np.abs(angles[equal]))]
    level = share * intensities[peak]
    widths = []
    for sign in (1, -1):
        if closed:
            count = len(angles) - 1
            order = (peak + sign * np.arange(count + 1)) % count
            steps = np.diff(angles)[(order[:-1] if sign > 0 else order[1:])]
            distance, values = np.append(0, np.cumsum(steps)), intensities[order]
        else:
            distance, values = np.abs(angles - angles[peak])[peak::sign], intensities[peak::sign]
            if sign < 0 and peak == 0:
                distance, values = distance[:1], values[:1]
        fallen = np.flatnonzero(values[1:] <= level * (1 + 1e-15))
        if len(fallen):
            i = fallen[0]
            part = (values[i] - level) / (values[i] - values[i + 1])
            widths.append(distance[i] + min(part, 1) * (distance[i + 1] - distance[i]))
        elif closed:
            return 360.0
        else:
            widths.append(distance[-1])
    return min(sum(widths), 360.0)


def angles_of(table, share):
    """In C0-C180 (B: V = 0), across, and through the maximum."""
    at_max = np.unravel_index(np.argmax(table.cd), table.cd.shape)
    if table.kind == "B":
        h, cd = table.h, table.cd
        v = table.v
        if v[0] == 0 and len(v) > 1:
            v, cd = np.append(-v[:0:-1], v), np.hstack([cd[:, :0:-1], cd])
        if h[0] == 0 and len(h) > 1:
            h, cd = np.append(-h[:0:-1], h), np.vstack([cd[:0:-1], cd])
        row = lambda angle: np.array([np.interp(angle, v, line) for line in cd])
        column = np.array([np.interp(0, h, line) for line in cd.T])
        return lobe(h, row(0), share), lobe(v, column, share), lobe(h, row(table.v[at_max[1]]), share)
    full = []
    for c in (0, 90, table.h[at_max[0]]):
        v, ahead, behind = table.v, table.plane(c), table.plane(c + 180)
        dark = [-v[0], v[0]] if v[0] > 0 else []
        back = slice(None, 0, -1) if v[0] == 0 else slice(None, None, -1)
        angles = np.concatenate([-v[back], dark, v])
        values = np.concatenate([behind[back], np.zeros(len(dark)), ahead])
        full.append(lobe(angles, values, share, v[-1] == 180))
    return tuple(full)


def flux_code(table):
    edges = [np.degrees(np.arccos(1 - k / 4)) for k in (1, 2, 3)] + [90]
    parts = [zone(table, 0, edge) for edge in edges]
    whole = zone(table, 0, 180)
    lamps = whole if table.lamps_lm is None else table.lamps_lm
    percent = lambda part, of: 100 * part / of if of > 0 else None
    return [*(percent(part, parts[3]) for part in parts[:3]), percent(parts[3], whole), percent(whole, lamps)]


class Findings:
    def __init__(self):
        self.count, self.worst, self.bad = 0, 0.0, []

    def compare(self, where, got, expected, most):
        self.count += 1
        if got is None or expected is None:
            if got is not expected:
                self.bad.append(f"{where}: {got}, expected {expected}")
            return
        off = np.abs(np.asarray(got) - expected) / np.maximum(np.abs(expected), 1e-9 * np.max(np.abs(expected), initial=0) + 1e-300)
        off = float(np.max(off, initial=0))
        self.worst = max(self.worst, off)
        if not off <= most:
            self.bad.append(f"{where}: {got}, expected {expected}: off by {off:.1e}")

    def told(self, what):
        print(f"{what:44} {self.count:5} compared, worst {self.worst:.1e}, {len(self.bad)} wrong")
        for line in self.bad[:20]:
            print("   ", line[:400])
        return not self.bad


def check_numbers(findings, name, table, summary):
    for share, key in ((0.5, "beam_angle"), (0.1, "field_angle")):
        for got, suffix in zip(angles_of(table, share), ("", "_across", "_at_max")):
            # Angles near 0 degrees are differences: to 1e-9 of the half circle.
            given = summary[f"{key}{suffix}_deg"]
            shift = lambda angle: None if angle is None else angle + 180
            findings.compare(f"{name} {key}{suffix}", shift(given), shift(got), SAME)
    if table.kind != "C":
        for key in ("zonal_lumens", "cie_flux_code", "flux_downward_lm"):
            findings.compare(f"{name} {key}", summary[key], None, SAME)
        return
    whole = zone(table, 0, 180)
    findings.compare(f"{name} flux", summary["flux_lm"], whole, SAME)
    zones = summary["zonal_lumens"]
    for given in zones["zones"] + zones["tens"]:
        expected = zone(table, given["from_deg"], given["to_deg"])
        findings.compare(f"{name} zone {given}", given["flux_lm"] + whole, expected + whole, SAME)
    for given, expected in zip(summary["cie_flux_code"], flux_code(table)):
        findings.compare(f"{name} code", given, expected, SAME)


def photompy_rule(v, h, cd):
    """Each angle for the band halfway to its neighbours, the ends half a band beyond themselves (photompy 0.3.1)."""
    middle = (v[1:] + v[:-1]) / 2
    edges = np.concatenate([[v[0] - (v[1] - v[0]) / 2], middle, [v[-1] + (v[-1] - v[-2]) / 2]])
    bands = -np.diff(np.cos(np.radians(np.clip(edges, 0, 180)))) * 2 * np.pi
    if len(h) == 1:
        return float(cd[0] @ bands)
    widths = np.diff(np.concatenate([[h[0]], (h[1:] + h[:-1]) / 2, [h[-1]]]))
    return float(widths / widths.sum() @ cd @ bands)


def eulumdat_rule(v, h, cd):
    """Each plane for the sector up to the next one, mean of neighbours over gamma (eulumdat 0.7.1)."""
    bands = -np.diff(np.cos(np.radians(v))) * 2 * np.pi
    planes = 0.5 * (cd[:, 1:] + cd[:, :-1]) @ bands
    return float(planes @ np.diff(np.append(h, 360))) / 360


def with_photompy(path):
    from photompy.ies import IESFile
    from photompy.ldt import LDTFile

    file = (LDTFile if path.suffix == ".ldt" else IESFile).read(path)
    table = file.photometry
    return table.thetas, table.phis, table.values, table.total(), photompy_rule


def with_eulumdat(path):
    import eulumdat

    file = eulumdat.Eulumdat.from_file(str(path))
    klm = file.total_luminous_flux() / 1000
    h = np.array(file.c_angles[: len(file.intensities)])
    flux = file.photometric_summary().calculated_flux * klm
    return np.array(file.g_angles), h, np.array(file.intensities) * klm, flux, eulumdat_rule


READERS = [("photompy", with_photompy, ("ies", "ies2019", "ldt")), ("eulumdat", with_eulumdat, ("ldt",))]


def check_written(found, caustix, path, table, folder):
    for to in ("ies", "ies2019", "ldt"):
        target = folder / f"written.{'ldt' if to == 'ldt' else 'ies'}"
        run = subprocess.run([caustix, "photometry", path, "--to", to, "-o", target], capture_output=True, text=True)
        if run.returncode:
            if "flux of 0" not in run.stderr:
                found["caustix", to].bad.append(f"{path.name}: {run.stderr}")
            continue
        isym = int(target.read_bytes().split(b"\r\n")[2]) if to == "ldt" else None
        for package, read, formats in READERS:
            if to not in formats or isym not in (None, 0, 1):
                continue
            findings = found[package, to]
            try:
                v, h, cd, flux, rule = read(target)
            except ImportError:
                findings.missing = True
                continue
            except Exception as error:  # whatever a reader throws is its answer
                findings.bad.append(f"{path.name}: {type(error).__name__}: {error}")
                continue
            expected = table.nodes(h, v)
            findings.compare(f"{path.name} nodes", cd, expected, DIGITS)
            findings.flux.compare(f"{path.name} flux", flux, rule(v, h, expected), FLUX)


def real_files(folder, ending):
    """Without those that are broken on purpose, which are for other tests."""
    files = sorted(path for path in (folder / ending).rglob("*") if path.suffix.lower() == f".{ending}")
    return [path for path in files if not {"derived", "made"} & set(path.parts)]


def main():
    caustix = sys.argv[1]
    folder = Path(sys.argv[2] if len(sys.argv) > 2 else os.environ["CAUSTIX_TEST_DATA"])
    warnings.simplefilter("ignore")
    numbers, found, good, left_out = Findings(), {}, True, []
    for key in [("caustix", "ies"), ("caustix", "ies2019"), ("caustix", "ldt")] + [(p, to) for p, _, all_ in READERS for to in all_]:
        found[key] = Findings()
        found[key].flux, found[key].missing = Findings(), False
    with tempfile.TemporaryDirectory() as scratch:
        for ending, count in FILES.items():
            readable = []
            for path in real_files(folder, ending):
                run = subprocess.run([caustix, "photometry", path, "--json"], capture_output=True, text=True)
                if run.returncode:
                    continue
                try:
                    table = (read_ies if ending == "ies" else read_ldt)(path)
                except (ValueError, IndexError, AttributeError, KeyError) as error:
                    left_out.append(f"{path.name} ({type(error).__name__} in the reader here)")
                    continue
                readable.append((path, table, json.loads(run.stdout)))
            picks = np.unique(np.linspace(0, len(readable) - 1, count).round().astype(int)) if readable else []
            for path, table, summary in (readable[i] for i in picks):
                check_numbers(numbers, path.name, table, summary)
                if table.kind == "C":
                    check_written(found, caustix, path, table, Path(scratch))
            print(f"{ending}: {len(picks)} of {len(readable)} readable files")
    for line in left_out:
        print("left out:", line)
    good &= numbers.told("angles, zones, flux code")
    for (package, to), findings in found.items():
        if package == "caustix":
            good &= not findings.bad
            for line in findings.bad:
                print("BAD", line)
            continue
        if findings.missing:
            print(f"{package:10} {to:10} not installed")
            continue
        version = importlib.metadata.version(package)
        good &= findings.told(f"{package} {version} reads {to}: nodes")
        good &= findings.flux.told(f"{package} {version} reads {to}: flux")
    raise SystemExit(not good)


main()
