"""Runs the program under test; helpers for temporary folders, grids and images."""
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest
import zlib

BINARY = pathlib.Path(os.environ["SUREFOOT_BINARY"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("SUREFOOT_DATA_DIR", ROOT.parent / "shared" / "data"))
# A service writes its token file into the user's folder; this folder replaces the real one during tests.
STATE = tempfile.TemporaryDirectory(prefix="surefoot-state-")
os.environ["XDG_STATE_HOME"] = STATE.name


def surefoot(*arguments, cwd=None, timeout=600, **options):
    """Runs one verb; returns the completed process with text output."""
    return subprocess.run([str(BINARY), *map(str, arguments)], cwd=cwd, capture_output=True, text=True,
                          timeout=timeout, env={**os.environ, "NO_COLOR": "1"}, **options)


class CliTest(unittest.TestCase):
    """A test with its own temporary folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="surefoot-test-")
        self.addCleanup(folder.cleanup)
        self.dir = pathlib.Path(folder.name)

    def run_ok(self, *arguments, **options):
        process = surefoot(*arguments, **options)
        self.assertEqual(process.returncode, 0, f"surefoot {' '.join(map(str, arguments))}\n{process.stderr}")
        return process

    def json_of(self, *arguments, **options):
        return json.loads(self.run_ok(*arguments, "--json", **options).stdout)

    def data(self, *parts):
        """Returns a folder of the optional data. Prints a line and skips the test if the folder is missing."""
        path = DATA.joinpath(*parts)
        if not path.exists():
            # `make test` counts these lines.
            print(f"skipped 1 check: {path} is not there (set SUREFOOT_DATA_DIR)", flush=True)
            self.skipTest(f"{path} is not there")
        return path


def read_tum(path):
    rows = [[float(x) for x in line.split()] for line in path.read_text().splitlines() if line and line[0] != "#"]
    return rows


def read_asc(path):
    """Returns (header dict, rows); the first row has the largest y; NODATA = None."""
    header, rows = {}, []
    for line in path.read_text().splitlines():
        words = line.split()
        if words and words[0][0].isalpha():
            header[words[0].lower()] = float(words[1])
        elif words:
            rows.append([None if float(x) == header["nodata_value"] else float(x) for x in words])
    return header, rows


def png_of(image):
    """An 8-bit grey PNG of rows of values (W3C PNG specification; chunks IHDR, IDAT, IEND)."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    rows = b"".join(b"\0" + bytes(row) for row in image)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(image[0]), len(image), 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def grey_png(width, height):
    """A uniform grey PNG."""
    return png_of([[128] * width] * height)
