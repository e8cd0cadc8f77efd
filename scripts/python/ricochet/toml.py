"""TOML as the program reads it: scenes, and values of `--set`."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np


def document(scene: Mapping[str, Any]) -> str:
    """A scene as TOML text."""
    try:
        import tomli_w
    except ImportError as error:
        raise ImportError("a scene that is a dict needs tomli-w (pip install tomli-w); a text of TOML does not") from error
    return tomli_w.dumps(_plain(scene))


def value(item: Any) -> str:
    """One value on one line, tables inline; tomli-w writes whole documents only."""
    item = _plain(item)
    if isinstance(item, dict):
        return "{" + ", ".join(f"{_text(str(key))} = {value(part)}" for key, part in item.items()) + "}"
    if isinstance(item, list):
        return "[" + ", ".join(map(value, item)) + "]"
    if isinstance(item, str):
        return _text(item)
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, (int, float)):
        return repr(item)
    raise TypeError(f"{item!r} is no value of a scene: a number, text, bool, list, array or dict is wanted")


def _text(text: str) -> str:
    """Quoted: JSON's escapes are TOML's, but for one control character that JSON leaves as it is."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _plain(item: Any) -> Any:
    """Python's own types in place of numpy's, and text in place of paths."""
    if isinstance(item, (np.ndarray, np.generic)):
        return item.tolist()
    if isinstance(item, os.PathLike):
        return os.fspath(item)
    if isinstance(item, Mapping):
        return {key: _plain(part) for key, part in item.items()}
    if isinstance(item, (list, tuple)):
        return [_plain(part) for part in item]
    return item
