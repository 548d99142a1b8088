"""Helpers of the experiments' plot.py files: CSV rows, tables, pictures, documents, and where the programs and results are."""
import csv
import hashlib
import math
import pathlib
import subprocess
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from PIL import Image  # noqa: E402  matplotlib brings it

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs" / "lab"
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#444444"]  # Okabe-Ito
plt.rcParams.update({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
                     "axes.spines.right": False, "figure.dpi": 110, "svg.hashsalt": "surefoot",
                     "axes.prop_cycle": plt.cycler(color=COLOURS)})


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]


def save(figure, name):
    """Writes a picture of the lab notebook. Returns the line that shows it."""
    save_at(figure, DOCS / "img" / f"{name}.png")
    return f"![{name}](img/{name}.png)"


def save_at(figure, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)
    Image.open(path).convert("RGB").save(path)
    subprocess.run([ROOT / "tools/small_png", path], check=True)


def fill(name, lines, part="measured"):
    """Replaces the text between the markers of a document."""
    path = DOCS / f"{name}.md"
    begin, end = f"<!-- {part}: begin -->", f"<!-- {part}: end -->"
    text = path.read_text()
    head, rest = text.split(begin)
    tail = rest.split(end)[1]
    path.write_text(head + begin + "\n" + "\n".join(lines) + "\n" + end + tail)
    print(f"{path.relative_to(ROOT)} filled")


class Lab:
    """Where an experiment finds its programs and data, and where its CSV files are kept."""

    def __init__(self, arguments):
        self.build, self.data, self.scratch = arguments.build, arguments.data, arguments.scratch
        self.redraw = arguments.redraw

    def run(self, program, *words):
        if self.redraw:
            return
        subprocess.run([str(self.build / "lab" / program), *map(str, words)], check=True)

    def set_aside_older_results(self, program, folder):
        """Renames a folder whose results come from another build of the program, and makes an empty one."""
        if self.redraw:
            return
        mark = folder / "program.txt"
        now = hashlib.sha256((self.build / "lab" / program).read_bytes()).hexdigest()[:8]
        before = mark.read_text() if mark.exists() else "unknown"
        if before != now and any(folder.iterdir()):
            folder.rename(folder.with_name(f"{folder.name}_{before}_{time.time_ns()}"))
            folder.mkdir()
        mark.write_text(now)

    def folder(self, name):
        path = self.scratch / name
        path.mkdir(parents=True, exist_ok=True)
        return path


def quantile(values, share):
    values = sorted(values)
    return values[round(share * (len(values) - 1))] if values else math.nan


def render_room(lab, folder, frames, start, seed):
    """Renders a recording of the textured room along a real hand-held path, unless it exists."""
    if (folder / "mav0/imu0/data.csv").exists():  # written last
        return
    script = lab.data.parent / "tools" / "render_room.py"
    subprocess.run(["/usr/bin/python3", str(script), str(folder), "--frames", str(frames), "--start", str(start), "--seed",
                    str(seed)], check=True, capture_output=True)


def kept(lab, program, file, *words):
    """Rows of a long run. The run is made once; its file is kept."""
    if not file.exists() and not lab.redraw:
        lab.run(program, file.with_suffix(".part"), *words)
        file.with_suffix(".part").rename(file)
    return read(file) if file.exists() else []


def worst(rows, key, digits):
    """The largest absolute value over the seeds; - where none was measured."""
    values = [abs(float(row[key])) for row in rows if row[key] != "nan"]
    return f"{max(values):.{digits}f}" if values else "-"


def bound_of(missed, asked):
    """Missed of asked. With no miss: the upper bound of 95 % by the rule of three."""
    if not asked:
        return "-"
    if missed == 0 and asked <= 3:
        return f"0 of {asked}"
    return f"0 of {asked} (< {3 / asked:.1e})" if missed == 0 else f"**{missed} of {asked}** ({missed / asked:.1e})"
