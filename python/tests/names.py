"""Write mp_motion/_names.py from the registry: ``python python/tests/names.py``."""

from pathlib import Path

import mp_motion as mp

FILE = Path(mp.__file__).parent / "_names.py"


def text() -> str:
    """Return what the file must be."""

    def literal(name: str, values: list[str]) -> str:
        lines = "".join(f'    "{value}",\n' for value in values)
        return f"{name}: TypeAlias = Literal[\n{lines}]\n"

    return (
        '"""Names for type checkers, from the registry of the engine: tests/names.py writes this file."""\n\n'
        "from typing import Literal, TypeAlias\n\n"
        + literal("PlannerName", sorted(p.name for p in mp.planners()))
        + literal("MetricName", list(mp.metrics()))
    )


if __name__ == "__main__":
    FILE.write_text(text())
