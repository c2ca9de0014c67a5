"""What a check by samples says of each exhibit: what the tool of the report looked at, at the customary resolution."""

import math
import re
from itertools import pairwise
from pathlib import Path

import mp_motion as mp

HERE = Path(__file__).parent
Row = list[float]


def l1(scene: mp.Scene, a: Row, b: Row) -> float:
    """As MoveIt: 0.5% of the sum of the ranges of all joints (`longest_valid_segment_fraction` 0.005); a joint without limits counts π."""
    extent = sum(high - low if math.isfinite(high - low) else math.pi for low, high in scene.limits)
    return sum(abs(y - x) for x, y in zip(a, b, strict=True)) / (0.005 * extent)


def l2(scene: mp.Scene, a: Row, b: Row) -> float:
    """As OMPL: 1% of the diagonal of the bounds."""
    extent = math.hypot(*(high - low for low, high in scene.limits if math.isfinite(high - low)))
    return math.dist(a, b) / (0.01 * extent)


def points(scene: mp.Scene, a: Row, b: Row) -> float:
    """The points alone."""
    return 1


# The file that was looked at, its scene, the steps between two points, and what is done to the numbers first.
EXHIBITS = {
    "knots": ("knots.csv", "knots.toml", points, 1),
    "fence": ("fence.csv", "fence.toml", l2, 1),
    "shortcut": ("shortcut.csv", "shortcut.toml", l2, 1),
    "flip": ("flip.csv", "flip.toml", points, 1),
    "wrap": ("wrap.yaml", "wrap.toml", l1, 1),
    "carried": ("carried.json", "carried-as-planned.toml", l1, 1),
    "names": ("names.csv", "names.toml", l1, 1),
    "degrees": ("degrees.csv", "degrees.toml", l1, math.pi / 180),
    "blend": ("blend-as-planned.csv", "blend.toml", l1, 1),
    "turn": ("turn.csv", "turn.toml", l1, 1),
    "spline": ("spline.csv", "spline.toml", l1, 1),
    "start": ("start.csv", "start.toml", l1, 1),
}


def read(file: Path, width: int) -> list[Row]:
    """The positions in a file, in its own order: names and units are not looked at."""
    text = file.read_text()
    if file.suffix != ".csv":
        return [[float(x) for x in row.split(",")] for row in re.findall(r'positions"?: \[(.*?)]', text)]
    names, *rows = [line.split(",") for line in text.splitlines()]
    first = 1 if names[0].startswith("time") else 0
    return [[float(x) for x in row[first : first + width]] for row in rows]


def verdict(name: str) -> str:
    """How many configurations are looked at, and whether all are free."""
    file, world, steps, factor = EXHIBITS[name]
    scene = mp.Scene(HERE / world)
    rows = [[factor * x for x in row] for row in read(HERE / file, len(scene.columns))]
    looked_at = rows[:1]
    for a, b in pairwise(rows):
        # As OMPL counts them, less a grain of rounding.
        count = max(1, math.ceil(steps(scene, a, b) - 1e-9))
        looked_at += [[x + (y - x) * k / count for x, y in zip(a, b, strict=True)] for k in range(1, count + 1)]
    hits = sum(not scene.is_free(row) for row in looked_at)
    return f"{len(looked_at)} configurations, {f'{hits} in collision' if hits else 'all free'}"


if __name__ == "__main__":
    for name in EXHIBITS:
        print(f"{name}: {verdict(name)}")
