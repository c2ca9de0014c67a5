"""Exceptions."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._report import Report


class Error(Exception):
    """Something given is not valid: a file, a scene, a request, a start in collision.

    Where an argument is not valid it is a ``ValueError`` too; where a file is not, an ``OSError``, and a ``FileNotFoundError``
    where it is missing. An argument of a wrong type is a ``TypeError``.

    Attributes
    ----------
    message : str
        What is wrong.
    kind : str
        What it is about: ``"start-not-free"``, ``"goal-not-free"``, ``"planner"``, ``"request"``, ``"missing"``, ``"file"`` or
        ``"other"``.
    remedy : str or None
        What to do about it.
    file : str or None
        The file that is not valid, if there is one.
    line, column : int or None
        The place in the file, from 1.
    report : str
        A few lines for a person, with the line of the file.
    """

    def __init__(
        self,
        message: str,
        *,
        kind: str = "other",
        remedy: str | None = None,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        report: str | None = None,
    ) -> None:
        self.message = message
        self.kind = kind
        self.remedy = remedy
        self.file = file
        self.line = line
        self.column = column
        self.report = report if report is not None else _report(message, remedy)
        super().__init__(self.report.removeprefix("error: "))

    def __reduce__(self) -> tuple[object, ...]:
        return _error, (self.message, self.kind, self.remedy, self.file, self.line, self.column, self.report)


class RequestError(Error, ValueError):
    """An argument is not valid."""


class FileError(Error, OSError):
    """A file is not valid, or cannot be read or written."""


class MissingError(Error, FileNotFoundError):
    """There is no such file."""


_CLASSES: dict[str, type[Error]] = {
    "planner": RequestError,
    "request": RequestError,
    "file": FileError,
    "missing": MissingError,
}


def _report(message: str, remedy: str | None) -> str:
    return f"error: {message}" if remedy is None else f"error: {message}\n  help: {remedy}"


def _error(
    message: str, kind: str, remedy: str | None, file: str | None, line: int | None, column: int | None, report: str
) -> Error:
    """Make an exception of the class for its kind."""
    return _CLASSES.get(kind, Error)(message, kind=kind, remedy=remedy, file=file, line=line, column=column, report=report)


class InternalError(RuntimeError):
    """A fault of this package. Please report it with what you did."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a run.

    Attributes
    ----------
    report : Report
        What was done until then. An anytime planner may have found a path.
    """

    def __init__(self, report: Report) -> None:
        self.report = report
        super().__init__(str(report))
