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
                except (ValueError, KeyError, AttributeError, TypeError, OSError) as error:
                    warnings.append(f"{index}:{number}: picture left out: {error}")
    return list(found.values()), warnings


def _picture(entry, index):
    path = index.parent / entry["file"]
    task = entry.get("task") or index.parent.name
    panels = tuple(str(p) for p in entry.get("panels") or ())
    columns = int(entry.get("columns") or 0)
    if bool(panels) != (columns > 0):
        raise ValueError(f"{len(panels)} panels in {columns} columns")
    return Picture(entry.get("title") or path.stem, task, entry.get("dataset") or "", entry.get("method") or "",
                   entry.get("kind") or "picture", entry.get("caption") or "", _uri(path), columns, panels)  # fmt: skip


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
