"""What the report says about each task: titles, units and how its error is meant. An unknown task gets plain words."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TaskText:
    title: str
    question: str
    element: str  # what a dataset is made of
    query: str
    error: str  # name of the primary metric, as an axis title


TASKS = {
    "knn": TaskText(
        "Neighbours in point clouds",
        "Which points lie nearest to a query, within a radius of it, or inside a box?",
        "point", "query", "mean relative error"),
    "ray": TaskText(
        "Rays through triangle meshes",
        "Which triangle does a ray meet first, and does it meet any?",
        "triangle", "ray", "mean relative error"),
}  # fmt: skip


def text(task):
    return TASKS.get(task) or TaskText(task, "", "element", "query", "error")
