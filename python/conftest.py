from __future__ import annotations

import os
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest

import mp_motion as mp

ROOT = Path(__file__).parents[1]

# Tests send this signal to themselves. A script that has them in the background may have had it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def program() -> str:
    """Return the program ``mp``: that of the variable MP, or one that was built."""
    places = [os.environ.get("MP"), *(ROOT / "target" / kind / "mp" for kind in ("release", "debug")), shutil.which("mp")]
    for place in places:
        if place and Path(place).is_file():
            return str(place)
    pytest.fail("there is no program `mp` to compare with: cargo build -p mp-motion-cli, or set MP")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, doctest_namespace: dict[str, object]) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    doctest_namespace |= {"mp": mp, "np": np}
    return tmp_path
