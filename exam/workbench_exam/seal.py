"""A truth that is fixed before answers come and read only after: a salted hash, and the text under a key.

The hash is of the truth with its salt; the text is added bit by bit to a stream of SHA-256 blocks of key,
name and counter. Whoever has the key reads it, and whoever has read it can check that it is what was sealed.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from .reading import read_json

#: The key of the open set, which hides nothing.
OPEN_KEY = "open"


def seal(truth: dict[str, Any], name: str, key: str) -> dict[str, str]:
    """The sealed form of a truth, for `sealed.json`."""
    salt = hashlib.sha256(f"salt {key} {name}".encode()).hexdigest()[:32]
    text = json.dumps({"salt": salt, **truth}, sort_keys=True).encode()
    return {"sha256": hashlib.sha256(text).hexdigest(), "text": _mixed(text, name, key).hex()}


def unseal(sealed: dict[str, str], name: str, key: str) -> dict[str, Any]:
    """The truth of a sealed form.

    Raises:
        ValueError: the key is not that of the seal.
    """
    text = _mixed(bytes.fromhex(sealed["text"]), name, key)
    if hashlib.sha256(text).hexdigest() != sealed["sha256"]:
        raise ValueError(f"{name}: this key does not open it")
    truth = json.loads(text)
    del truth["salt"]
    return truth


def truth_of(folder: Path, key: str) -> dict[str, Any]:
    """The truth of a case's folder."""
    return unseal(read_json(folder / "sealed.json"), folder.name, key)


def _mixed(text: bytes, name: str, key: str) -> bytes:
    blocks = (
        hashlib.sha256(f"text {key} {name} {block}".encode()).digest() for block in range(len(text) // 32 + 1)
    )
    return bytes(a ^ b for a, b in zip(text, b"".join(blocks), strict=False))
