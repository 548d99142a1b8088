"""Lists the required figures of a measured page that are missed and not listed in state/known_misses.txt.

A page lists its requirements in tables with the header HEADER. The last column is "yes" or "**no**", or "-" without a
requirement. The names in the first column are unique within a page.
"""
import pathlib
import sys

HEADER = "| case | result | required | met |"
KNOWN_MISSES = pathlib.Path(__file__).resolve().parent.parent / "state" / "known_misses.txt"


def figures(text):
    """Returns (what, found, required, met) of every row of such tables."""
    rows, inside = [], False
    for line in text.splitlines():
        if line == HEADER:
            inside = True
        elif not line.startswith("|"):
            inside = False
        elif inside and not line.startswith("|---"):
            rows.append(tuple(cell.strip() for cell in line.strip("|").split(" | ")))
    return rows


def known_misses(text, page):
    """{what: why} of the lines `PAGE | WHAT | WHY`; # begins a comment."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    entries = [[word.strip() for word in line.split(" | ")] for line in lines]
    return {entry[1]: " | ".join(entry[2:]) for entry in entries if entry[0] == page}


def complaints(rows, known):
    """One message for each problem of the page; empty = no problem."""
    found = [] if rows else ["the page holds no required figure at all"]
    names = [row[0] for row in rows]
    found += [f"{name}: stands there {names.count(name)} times" for name in dict.fromkeys(names) if names.count(name) > 1]
    for row in rows:
        if len(row) != 4 or (row[3] not in ("yes", "**no**") and row[2:] != ("-", "-")):
            found.append(f"{row[0]}: not a row of what, found, required and met (yes or **no**)")
        elif row[3] == "**no**" and row[0] not in known:
            found.append(f"{row[0]}: {row[1]}; required {row[2]}")
    found += [f"{name}: known as a miss without a reason" for name, why in known.items() if not why]
    return found + [f"{name}: known as a miss, but no row has this name" for name in known if name not in names]


def check(page):
    """Exit status: 1 if the page has a complaint."""
    rows = figures(page.read_text())
    known = known_misses(KNOWN_MISSES.read_text(), page.stem)
    found = complaints(rows, known)
    for sentence in found:
        print(f"{page.name}: {sentence}", file=sys.stderr)
    for row in rows:
        if row[0] in known and row[3] == "yes":
            print(f"{page.name}: {row[0]}: met this time ({row[1]}); if that repeats, remove it from {KNOWN_MISSES.name}")
    print(f"{page.name}: {len(rows)} figures, {len(known)} known misses, {len(found)} complaints")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(max(check(pathlib.Path(page)) for page in sys.argv[1:]))
