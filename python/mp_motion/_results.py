"""Results of lists of problems, which ``mp many`` writes."""

from __future__ import annotations

import json
import os
from collections.abc import Generator, Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from . import _mp
from ._errors import Error
from ._report import Report

if TYPE_CHECKING:
    import pandas as pd

    from ._scene import File

# What a table has no column for: arrays, and what is not the same in all rows.
_NO_COLUMNS = {"path", "first_path", "columns", "stages", "version", "path_file", "picture_file", "certificate_file", "_scene"}


def read_results(file: File, *, partial: bool = False) -> Results:
    """Read the results that ``mp many`` or ``mp merge`` has written.

    Parameters
    ----------
    file : path
        The results.
    partial : bool
        Whether results may be missing at the end, as the run goes on, or was killed. Otherwise that is an error.

    Raises
    ------
    Error
        When the file is missing, or holds no results.

    Examples
    --------
    >>> for item, result in mp.read_results("results.jsonl"):  # doctest: +SKIP
    ...     if isinstance(result, mp.Report) and result.solved:
    ...         print(item, result.seed, result.path.shape)
    >>> mp.read_results("results.jsonl").to_pandas().groupby("planner")["solved"].mean()  # doctest: +SKIP
    """
    return Results(file, partial=partial)


class Results:
    """The results in a file: an iterable of pairs, the number of an item in its list, and its report or its error.

    Items are read one at a time and checked: memory does not grow with their number. What is wrong in the file is raised where
    it is, and at the end when the checksum is not that of the file. Made by :func:`read_results`.

    Attributes
    ----------
    header : dict
        What the results are of: list, scenes, number of items, shard (docs/formats/many.md).
    """

    __slots__ = ("_file", "_partial", "header")
    header: dict[str, Any]

    def __init__(self, file: File, *, partial: bool = False) -> None:
        self._file, self._partial = os.fspath(file), partial
        self.header = json.loads(_mp.Results(self._file, partial).header)

    def __iter__(self) -> Iterator[tuple[int, Report | Error]]:
        return self._items()

    def _items(self) -> Generator[tuple[int, Report | Error], None, None]:
        for item, result in _mp.Results(self._file, self._partial):
            yield item, result if isinstance(result, Error) else Report._of(*result, scene=None)

    def to_pandas(self) -> pd.DataFrame:
        """Return a table with a row for each item: the members of its report but arrays, and ``error``.

        The index is the number of the item. Of an item that could not be planned all but ``error`` is missing.
        """
        import pandas as pd

        names = [f.name for f in fields(Report) if f.name not in _NO_COLUMNS]
        items: list[int] = []
        rows: list[list[Any]] = []
        for item, result in self:
            items.append(item)
            if isinstance(result, Error):
                rows.append([None] * len(names) + [str(result)])
            else:
                rows.append([getattr(result, name) for name in names] + [None])
        return pd.DataFrame(rows, columns=[*names, "error"], index=pd.Index(items, name="item"))

    def __repr__(self) -> str:
        return f"<Results of {self.header['list']}: shard {self.header['shard']} of {self.header['items']} items>"
