"""Pictures of a run: pictures.jsonl (file, title, dataset, method, kind) and the files beside it, inlined. Of panels side by
side it names the columns and what stands on each, row after row."""

import base64
import json
import re
from dataclasses import dataclass
from pathlib import Path

TYPES = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".webp": "image/webp"}
SCRIPT = re.compile(r"<script\b|\son\w+\s*=|javascript:", re.IGNORECASE)


@dataclass
class Picture:
    title: str
    task: str
    dataset: str
    method: str
    kind: str
    caption: str
    uri: str
    columns: int = 0
    panels: tuple = ()


def read(folders):
    """(pictures, warnings). A picture that cannot be shown costs a warning, not the report."""
    found, warnings = {}, []
    for folder in map(Path, folders):
        indexes = sorted(folder.rglob("pictures.jsonl")) if folder.is_dir() else []
        if not indexes:
            warnings.append(f"{folder}: no pictures.jsonl here")
        for index in indexes:
            for number, line in enumerate(index.read_text(errors="replace").splitlines(), 1):
                if not line.strip():
                    continue
                try:
                    entry = json.loads(line)
                    found[index.parent / entry["file"]] = _picture(entry, index)  # a resumed run lists some again
                except (ValueError, KeyError, AttributeError, TypeError, OSError, RecursionError) as error:
                    warnings.append(f"{index}:{number}: picture left out: {error}")
    return list(found.values()), warnings


def _picture(entry, index):
    path = index.parent / entry["file"]
    task = _text(entry, "task") or index.parent.name
    title, dataset, method, kind, caption = (_text(entry, name) for name in ("title", "dataset", "method", "kind", "caption"))
    panels, columns = entry.get("panels") or [], entry.get("columns") or 0
    if not isinstance(panels, list) or type(columns) is not int or not (1 if panels else 0) <= columns <= len(panels):
        raise ValueError(f"its panels are {_short(panels)} in {_short(columns)} columns")
    panels = tuple(_clean(name, "a panel") for name in panels)
    return Picture(title or path.stem, task, dataset, method, kind or "picture", caption, _uri(path), columns, panels)


def _text(entry, name):
    return _clean(entry.get(name) or "", name)


def _clean(value, name):
    """Halves of a pair that stand alone can be in JSON, but not in a file."""
    if not isinstance(value, str):
        raise ValueError(f"{name} is {_short(value)}, no text")
    return value.encode("utf-8", "replace").decode()


def _short(value):
    text = repr(value)
    return text if len(text) < 40 else text[:40] + "…"


def _uri(path):
    suffix = path.suffix.lower()
    if suffix == ".svg":  # as an image it cannot run scripts or load anything
        text = path.read_text()
        if SCRIPT.search(text):
            raise ValueError(f"{path.name} holds a script")
        return "data:image/svg+xml;base64," + base64.b64encode(text.encode()).decode()
    if suffix not in TYPES:
        raise ValueError(f"{path.name} is neither PNG, JPEG, WebP nor SVG")
    data = path.read_bytes()
    if not data:
        raise ValueError(f"{path.name} is empty")
    return f"data:{TYPES[suffix]};base64," + base64.b64encode(data).decode()
