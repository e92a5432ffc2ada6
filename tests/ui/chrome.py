"""A headless Chromium that a test drives: DevTools' protocol over a pipe, standard library only."""

from __future__ import annotations

import base64
import json
import os
import subprocess
import time
from pathlib import Path
from types import TracebackType
from typing import Any

from tests.report.browser import CHROMIUM

_QUIET = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--hide-scrollbars",
    # whatever is not this machine is not there
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE localhost, EXCLUDE 127.0.0.1",
)


class Chrome:
    """One browser with one page.

    `errors` are what the console complained of, `requests` every address that was asked for.
    """

    def __init__(self, profile: Path) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._next, self._buffer = 0, b""
        to_chrome, self._write = os.pipe()
        self._read, from_chrome = os.pipe()
        self._process = subprocess.Popen(
            [
                "bash",
                "-c",
                f'exec "$0" "$@" 3<&{to_chrome} 4>&{from_chrome}',
                str(CHROMIUM),
                *(*_QUIET, "--remote-debugging-pipe", f"--user-data-dir={profile}"),
            ],
            pass_fds=(to_chrome, from_chrome),
            stderr=subprocess.DEVNULL,
        )
        os.close(to_chrome)
        os.close(from_chrome)
        target = self._send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def __enter__(self) -> Chrome:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.terminate()
        self._process.wait(20)
        os.close(self._write)
        os.close(self._read)

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Ask the page something and wait for the answer."""
        return self._send(method, self._session, **parameters)

    def look(self, width: int = 1280, height: int = 900, *, dark: bool = False) -> None:
        """Size of the window and scheme of its colours."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.send("Emulation.setEmulatedMedia", features=[scheme])

    def open(self, url: str) -> None:
        """Go to an address."""
        self.send("Page.navigate", url=url)

    def ask(self, expression: str) -> Any:
        """The value of a JavaScript expression; `deep(selector)` in it looks into shadow roots too."""
        answer = self.send(
            "Runtime.evaluate",
            expression=f"(() => {{ {_DEEP} return {expression} }})()",
            returnByValue=True,
            awaitPromise=True,
        )
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", expression))
        return answer["result"].get("value")

    def wait(self, expression: str, seconds: float = 60.0) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + seconds
        while True:
            # between two pages there is none
            if self.ask("document.readyState === 'complete'") and self.ask(f"!!({expression})"):
                return
            if time.monotonic() > end:
                text = self.ask("words()")
                raise TimeoutError(
                    f"{expression} is not true after {seconds} s; console: {self.errors}; {text}"
                )
            time.sleep(0.1)

    def key(self, name: str, code: int = 0, text: str = "") -> None:
        """Press a key."""
        common = {"key": name, "code": name, "windowsVirtualKeyCode": code}
        self.send("Input.dispatchKeyEvent", type="keyDown", **common, **({"text": text} if text else {}))
        self.send("Input.dispatchKeyEvent", type="keyUp", **common)

    def tap(self, x: float, y: float) -> None:
        """Touch the window at a place [px]."""
        self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self, path: Path, *, whole: bool = True) -> None:
        """What the page looks like, as PNG."""
        data = self.send("Page.captureScreenshot", captureBeyondViewport=whole)["data"]
        path.write_bytes(base64.b64decode(data))

    def _send(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        self._next += 1
        message = {"id": self._next, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == message["id"]:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self._note(answer)

    def _receive(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            piece = os.read(self._read, 1 << 20)
            if not piece:
                raise RuntimeError("the browser is gone")
            self._buffer += piece
        text, self._buffer = self._buffer.split(b"\0", 1)
        return json.loads(text)

    def _note(self, event: dict[str, Any]) -> None:
        content = event.get("params", {})
        match event.get("method"):
            case "Runtime.consoleAPICalled" if content["type"] in ("error", "warning", "assert"):
                self.errors.append(
                    " ".join(str(a.get("value", a.get("description"))) for a in content["args"])
                )
            case "Runtime.exceptionThrown":
                details = content["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description", details["text"]))
            case "Log.entryAdded" if content["entry"]["level"] in ("error", "warning"):
                self.errors.append(f"{content['entry']['text']} {content['entry'].get('url', '')}")
            case "Network.requestWillBeSent":
                self.requests.append(content["request"]["url"])


_DEEP = """
const every = (selector, root = document) => {
  const out = [...root.querySelectorAll(selector)];
  for (const e of root.querySelectorAll('*')) if (e.shadowRoot) out.push(...every(selector, e.shadowRoot));
  return out;
};
const deep = (selector) => every(selector)[0];
const button = (text) => every('button').find((b) => b.textContent.trim().startsWith(text));
const inside = (root) => [...root.childNodes, ...(root.shadowRoot?.childNodes ?? [])];
const words = (root = document.body) => inside(root).map((node) =>
  node.nodeType === 3 ? node.textContent.trim()
    : ['STYLE', 'SCRIPT'].includes(node.tagName) ? '' : words(node),
).filter(Boolean).join(' ').replaceAll('\\u00a0', ' ');
"""
