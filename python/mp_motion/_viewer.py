"""A page that stays open and shows what the program sends."""

from __future__ import annotations

import html
import importlib
import secrets
import threading
import warnings
import webbrowser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from math import isfinite
from typing import TYPE_CHECKING, Any, cast

from ._arguments import text
from ._errors import Error
from ._view import in_notebook, refuse_own, rows_of, told

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import TracebackType

    from numpy.typing import ArrayLike

    from ._scene import PathRows, Scene

#: The name under which :meth:`Viewer.move` shows its configuration.
CONFIGURATION = "configuration"
#: A page that is gone is noticed when something is sent to it: nothing at all, this often, seconds.
PULSE = 2.0


class Page:
    """What one open page has not been sent yet: of each name the newest."""

    def __init__(self, first: dict[str, bytes]) -> None:
        self.waiting = first
        self.changed = threading.Condition()
        self.closed = False

    def put(self, name: str, message: bytes) -> None:
        with self.changed:
            # What was given last is shown last.
            self.waiting.pop(name, None)
            self.waiting[name] = message
            self.changed.notify()

    def close(self) -> None:
        with self.changed:
            self.closed = True
            self.changed.notify()

    def take(self) -> list[bytes] | None:
        """Return what is new, perhaps nothing after a while; ``None`` at the end."""
        with self.changed:
            self.changed.wait_for(lambda: self.waiting or self.closed, PULSE)
            if self.closed and not self.waiting:
                return None
            new, self.waiting = list(self.waiting.values()), {}
            return new


class Viewer:
    """A page in the browser, or below the cell of a notebook, that shows what it is given while the program goes on.

    :meth:`Scene.view` makes one. It lasts until :meth:`close`, or until the program ends; what was shown stays in the page.
    The page comes from a server of this process, on this machine only (127.0.0.1): whoever has the address sees the scene.

    Examples
    --------
    >>> viewer = scene.view()                           # doctest: +SKIP
    >>> for seed in range(3):                           # doctest: +SKIP
    ...     viewer.show(scene.plan(seed=seed), name=f"seed {seed}")
    >>> for configuration in report.resample(200):      # doctest: +SKIP
    ...     viewer.move(configuration)
    >>> viewer.wait()                                   # doctest: +SKIP
    """

    def __init__(self, scene: Scene, path: PathRows | None, *, open: bool) -> None:
        refuse_own(scene)
        self._scene = scene
        self._page: bytes = scene._native.page(told(path), rows_of(scene, path))
        self._shown: dict[str, bytes] = {}
        self._pages: set[Page] = set()
        self._lock = threading.Condition()
        self._seen = self._closed = False
        # Other users of this machine can read the arguments of programs: the browser is started with an address that works
        # once.
        self._token, self._ticket = secrets.token_urlsafe(24), secrets.token_urlsafe(24)
        self._server = Server(self)
        threading.Thread(target=self._server.serve_forever, name="mp viewer", daemon=True).start()
        if not open:
            return
        if in_notebook():
            display: Any = importlib.import_module("IPython.display")
            display.display(self)
        elif not webbrowser.open(self._address(self._ticket)):
            warnings.warn(f"there is no browser here: open {self.address}", stacklevel=3)

    @property
    def address(self) -> str:
        """The address of the page. Several tabs may show it."""
        return self._address(f"{self._token}/")

    def _address(self, rest: str) -> str:
        return f"http://127.0.0.1:{self._server.server_port}/{rest}"

    def show(self, path: PathRows, *, name: str = "path") -> None:
        """Show a path, or the path of a report, in the place of the one with the same name.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished
            The path. The verifier of the scene says whether it is free.
        name : str
            How it is called in the page.

        Raises
        ------
        Error
            When there is no path, or its configurations have not one number for each column.
        """
        self._send(text("name", name), self._scene._path(path))

    def move(self, configuration: ArrayLike | Mapping[str, float]) -> None:
        """Show the robot in a configuration. Where they come faster than the page draws, it shows the newest.

        Parameters
        ----------
        configuration : array_like, shape (columns,), or mapping of columns to numbers
            Where the robot is: metres and radians, as :attr:`Scene.columns` says.

        Raises
        ------
        Error
            When it has not one finite number for each column.
        """
        row = self._scene._row(configuration)
        if not all(map(isfinite, row)):
            raise Error("the configuration has numbers that are not finite", remedy="leave it out")
        self._send(CONFIGURATION, self._scene._path([row]))

    def _send(self, name: str, rows: Any) -> None:
        if self._closed:
            raise Error("the viewer is closed", remedy="open another one by scene.view()")
        message = self._scene._native.path_for_page(name, rows)
        with self._lock:
            # The last one shown is the one that a page that is opened later shows.
            self._shown.pop(name, None)
            self._shown[name] = message
            pages = list(self._pages)
        for page in pages:
            page.put(name, message)

    def wait(self) -> None:
        """Wait until the page was open and no tab shows it any more."""
        with self._lock:
            # In steps, so that Ctrl-C is heard on all systems.
            while not (self._seen and not self._pages):
                self._lock.wait(0.2)

    def close(self) -> None:
        """End the server. What is shown stays in the page; to show more then is an error."""
        self._closed = True
        self._server.shutdown()
        self._server.server_close()
        with self._lock:
            pages = list(self._pages)
        for page in pages:
            page.close()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Viewer of {self._scene.name} at {self.address}>"

    def _repr_html_(self) -> str:
        return (
            f'<iframe title="{html.escape(self._scene.name)}" src="{html.escape(self.address)}" '
            'style="width: 100%; height: 480px; border: 0" sandbox="allow-scripts allow-downloads allow-same-origin"></iframe>'
        )


class Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, viewer: Viewer) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.viewer = viewer

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of tabs that are closed."""


class Handler(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        server = cast("Server", self.server)
        viewer, port = server.viewer, server.server_port
        # Under another name of this machine a page of somebody else may ask.
        if self.headers.get("Host") not in {f"127.0.0.1:{port}", f"localhost:{port}"}:
            return self._refuse(403, "This server answers at 127.0.0.1 only.")
        first, _, rest = self.path.lstrip("/").partition("/")
        if viewer._ticket and secrets.compare_digest(first.encode(), viewer._ticket.encode()):
            viewer._ticket = ""
            self.send_response(303)
            self.send_header("Location", f"/{viewer._token}/")
            return self.end_headers()
        if not secrets.compare_digest(first.encode(), viewer._token.encode()):
            return self._refuse(403, "The address has not the token of this viewer.")
        if rest == "":
            return self._answer(200, "text/html; charset=utf-8", viewer._page)
        if rest == "shown":
            return self._stream(viewer)
        return self._refuse(404, "There is nothing at this address.")

    def _answer(self, status: int, kind: str, content: bytes) -> None:
        self.send_response(status)
        for name, value in (("Content-Type", kind), ("Cache-Control", "no-store"), ("Referrer-Policy", "no-referrer")):
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def _refuse(self, status: int, sentence: str) -> None:
        self._answer(status, "text/plain; charset=utf-8", sentence.encode())

    def _stream(self, viewer: Viewer) -> None:
        """Send what is shown and what is shown from now on: of each message its length (u32, little-endian) and its bytes."""
        with viewer._lock:
            page = Page(dict(viewer._shown))
            viewer._pages.add(page)
            viewer._seen = True
        try:
            self.send_response(200)
            self.send_header("Content-Type", "application/octet-stream")
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            while (new := page.take()) is not None:
                for message in new or [b""]:
                    self.wfile.write(len(message).to_bytes(4, "little") + message)
        except OSError:
            pass
        finally:
            with viewer._lock:
                viewer._pages.discard(page)
                viewer._lock.notify_all()

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing: the terminal is the program's."""
