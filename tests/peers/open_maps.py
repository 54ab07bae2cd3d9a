"""Open a run's maps as their users do, and compare them with the table of the same run.

    caustix render SCENE.toml -o out
    python open_maps.py out [receiver ...]

A receiver's EXR is opened with OpenCV, imageio, OpenEXR, OpenImageIO and Mitsuba, a mesh's .vtp with VTK and its .ply with plyfile. Whatever is not
installed is said and left out. Illuminance (and, where a reader gives all channels, standard error and hits) must be the
CSV's to 1e-6 of its value. report.json must have the hash of every file. Exit status 1 where anything differs.
"""

import csv
import hashlib
import importlib.metadata
import json
import os
import sys
from pathlib import Path

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"

import numpy as np

LARGEST = 1e-6
# Channels and the table's columns.
COLUMNS = {"Y": "illuminance_lx", "standard_error": "standard_error_lx", "hits": "hits"}


def with_opencv(path):
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED | cv2.IMREAD_ANYDEPTH)
    if image is None:
        raise ValueError("cv2.imread gives None; is it built with OpenEXR? The wheels of 5.0 are not")
    # A file with Y alone is grey; colours are blue, green, red, all the same.
    return {"Y": image if image.ndim == 2 else image[..., 0]}


def with_imageio(path):
    import cv2
    import imageio.v3 as imageio

    # Without the flag imageio makes 8 bits of every file that OpenCV reads.
    image = imageio.imread(path, plugin="opencv", flags=cv2.IMREAD_UNCHANGED, colorspace=None)
    return {"Y": image if image.ndim == 2 else image[..., 0]}


def with_openexr(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def with_openimageio(path):
    import OpenImageIO as oiio

    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT)
    return {name: pixels[..., k] for k, name in enumerate(image.spec().channelnames)}


def with_mitsuba(path):
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    bitmap = mitsuba.Bitmap(str(path))
    if bitmap.component_format() != mitsuba.Struct.Type.Float32:
        raise ValueError(f"components are {bitmap.component_format()}")
    pixels = np.array(bitmap)
    pixels = pixels if pixels.ndim == 3 else pixels[..., None]
    names = [field.name for field in bitmap.struct_()]
    return {name.split(".")[-1]: pixels[..., k] for k, name in enumerate(names)}


def with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    data = mesh.GetCellData()
    arrays = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}
    for face in range(mesh.GetNumberOfCells()):
        if mesh.GetCell(face).GetNumberOfPoints() != 3:
            raise ValueError(f"face {face} is no triangle")
    return arrays


def with_plyfile(path):
    from plyfile import PlyData

    faces = PlyData.read(str(path))["face"]
    return {channel: np.asarray(faces[column]) for channel, column in COLUMNS.items()}


READERS = [
    ("exr", "opencv-python-headless", with_opencv, {"Y"}),
    ("exr", "imageio", with_imageio, {"Y"}),
    ("exr", "OpenEXR", with_openexr, set(COLUMNS)),
    ("exr", "OpenImageIO", with_openimageio, set(COLUMNS)),
    ("exr", "mitsuba", with_mitsuba, set(COLUMNS)),
    ("vtp", "vtk", with_vtk, set(COLUMNS)),
    ("ply", "plyfile", with_plyfile, set(COLUMNS)),
]


def table(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {
        channel: np.array([float(row[column]) if row[column] else np.nan for row in rows])
        for channel, column in COLUMNS.items()
    }


def deviation(values, expected):
    """Largest relative difference; the pixels beyond the last face of a mesh are left out."""
    values = np.asarray(values, dtype=np.float64).ravel()[: expected.size]
    if values.size != expected.size or (np.isnan(values) != np.isnan(expected)).any():
        return np.inf
    scale = np.where(expected == 0, 1, np.abs(expected))
    return np.nanmax(np.abs(values - expected) / scale, initial=0.0)


def check(folder, receiver):
    expected, good = table(folder / f"{receiver}.csv"), True
    for ending, package, read, required in READERS:
        path = folder / f"{receiver}.{ending}"
        if not path.exists():
            continue
        try:
            channels = read(path)
            missing = required - set(channels)
            worst = {name: deviation(channels[name], expected[name]) for name in COLUMNS if name in channels}
            passed = not missing and max(worst.values()) <= LARGEST
            told = ", ".join(f"{name} {value:.1e}" for name, value in worst.items())
            told += f", without {', '.join(sorted(missing))}" if missing else ""
        except ImportError:
            print(f"{path.name:24} {package:24} not installed")
            continue
        except Exception as error:  # whatever a reader throws is its answer
            passed, told = False, str(error)
        version = importlib.metadata.version(package)
        print(f"{path.name:24} {package:24} {version:12} {'ok ' if passed else 'BAD'} {told}")
        good &= passed
    return good


def vouched(folder):
    report = json.loads((folder / "report.json").read_text())
    wrong = [
        name
        for name, expected in report["files"].items()
        if hashlib.sha256((folder / name).read_bytes()).hexdigest() != expected
    ]
    print(f"report.json: {len(report['files'])} files, wrong: {wrong or 'none'}")
    return report, not wrong


def main():
    folder = Path(sys.argv[1])
    report, good = vouched(folder)
    names = sys.argv[2:] or [receiver["name"] for receiver in report["receivers"]]
    for name in names:
        good &= check(folder, name)
    raise SystemExit(not good)


main()
