"""The server: for this computer only, at this address only, until it is interrupted."""

from __future__ import annotations

import logging
import signal
import socket
import warnings
from collections.abc import Callable
from typing import Any

import jinja2
import panel as pn
from bokeh.server.server import Server
from bokeh.util.warnings import BokehUserWarning
from panel.io.resources import LOCAL_DIST
from panel.io.server import get_server
from tornado.httputil import HTTPServerRequest
from tornado.web import Application, ErrorHandler
from tornado.websocket import WebSocketClosedError

from workbench.core import InputError
from workbench.core.palette import COLOURS, LINES

from .bench import Bench
from .live import Live
from .page import Page
from .widgets import style_sheet

_HOST = "127.0.0.1"
_TICK_MS = 500


def serve(bench: Bench, port: int, ready: Callable[[str], None]) -> None:
    """Serve the bench until interrupted.

    Args:
        bench: with or without something chosen.
        port: 0 for a free one.
        ready: told the address once it can be opened.

    Raises:
        InputError: the port is taken.
    """
    port = _free(port)
    _hush()
    pn.extension(notifications=False)
    lives: list[Live] = []
    server: Server = get_server(
        {"/": lambda: _document(lives[0])},
        port=port,
        address=_HOST,
        websocket_origin=[f"{_HOST}:{port}", f"localhost:{port}"],
        show=False,
        start=False,
        title="workbench",
    )
    loop = server.io_loop
    interrupted = _stop_on_interrupt(loop)
    live = Live(bench, loop.add_callback, loop.call_later)
    lives.append(live)
    chosen = bench.chosen
    if chosen is not None:
        loop.add_callback(lambda: live.take(chosen))
    _only_by_own_name(server._tornado, {f"{_HOST}:{port}", f"localhost:{port}"})
    server.start()
    ready(f"http://{_HOST}:{port}/")
    try:
        loop.start()
    finally:
        live.close()
        server.stop()
    if interrupted:
        raise KeyboardInterrupt


def _stop_on_interrupt(loop: Any) -> list[int]:
    """End the loop at Ctrl-C; what is returned is no longer empty then.

    An exception that the signal raises itself is lost in a finaliser or in a weak reference's callback.
    """
    caught: list[int] = []

    def stop(number: int, frame: object) -> None:
        caught.append(number)
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a second one need not wait for the loop
        loop.asyncio_loop.call_soon_threadsafe(loop.stop)

    signal.signal(signal.SIGINT, stop)
    return caught


def _only_by_own_name(application: Application, hosts: set[str]) -> None:
    """Answer no request that was sent to another name: a stranger's page may have its own name point here."""
    find = application.find_handler

    def find_handler(request: HTTPServerRequest, **options: Any) -> Any:
        if request.host in hosts:
            return find(request, **options)
        return application.get_handler_delegate(request, ErrorHandler, {"status_code": 403})

    application.find_handler = find_handler


def _document(live: Live) -> Any:
    """A tab was opened."""
    template = pn.Template(_page())
    document = pn.state.curdoc
    # a slow browser connects when the session that sent its page has ended: Panel would then name its style
    # sheets on the network
    if document is not None:
        document.template_variables.setdefault("dist_url", LOCAL_DIST)
    page = Page(live, document)
    for name, view in page.roots.items():
        template.add_panel(name, view)
    ticking = pn.state.add_periodic_callback(page.tick, _TICK_MS)

    def closed(context: Any) -> None:
        ticking.stop()
        page.close()

    pn.state.on_session_destroyed(closed)
    return template


def _page() -> str:
    """The page as the template that Panel fills: what is known beforehand stands in it already."""
    fill = jinja2.Environment(
        variable_start_string="<<", variable_end_string=">>", block_start_string="<%", block_end_string="%>",
        autoescape=False,
    )  # fmt: skip
    looks = {
        name: {"colour": look.colour, "dash": list(look.dash), "width": look.width}
        for name, look in LINES.items()
    }
    return fill.from_string(style_sheet("page.html")).render(
        palette=COLOURS, looks=looks, css=style_sheet("page.css"), script=style_sheet("page.js")
    )


def _hush() -> None:
    """Keep from the terminal what is no one's business: tabs that close, and strangers turned away."""
    logging.getLogger("asyncio").addFilter(_worth_saying)
    for name, level in (("bokeh.server.views.ws", logging.CRITICAL), ("tornado.access", logging.ERROR)):
        logging.getLogger(name).setLevel(level)
    warnings.filterwarnings("ignore", "reference already known", BokehUserWarning)


def _worth_saying(record: logging.LogRecord) -> bool:
    """Not that a tab closed while something was being sent to it, which nobody awaits."""
    return not (record.exc_info and isinstance(record.exc_info[1], WebSocketClosedError))


def _free(port: int) -> int:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((_HOST, port))
        except OSError as error:
            raise InputError(
                f"port {port} cannot be used: {error.strerror}", remedy="give another one: --port"
            ) from error
        return probe.getsockname()[1]
