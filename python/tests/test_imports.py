"""The modules of the package import each other one way: no two of them reach each other, directly or through others."""

from __future__ import annotations

import ast
from graphlib import TopologicalSorter
from pathlib import Path

from conftest import REPOSITORY

PACKAGE = REPOSITORY / "python" / "abbe"


def module_paths() -> dict[str, Path]:
    """Returns the files of all modules by dotted name; the compiled one by its stub."""
    paths = [*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.pyi")]
    parts = {path: path.relative_to(PACKAGE.parent).with_suffix("").parts for path in paths}
    return {".".join(p[:-1] if p[-1] == "__init__" else p): path for path, p in parts.items()}


def imported_modules(module: str, paths: dict[str, Path]) -> set[str]:
    """Returns the modules that a module imports, those inside of functions and for type checks too."""
    parts = module.split(".")
    package = parts if paths[module].stem == "__init__" else parts[:-1]
    found: set[str] = set()
    for node in ast.walk(ast.parse(paths[module].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*base, *filter(None, [node.module])])
            # A name that is no module is in the module that it comes from.
            found.update(name if name in paths else origin for name in (f"{origin}.{a.name}" for a in node.names))
    return found & paths.keys()


def test_no_circle_of_modules() -> None:
    paths = module_paths()
    graph = {module: imported_modules(module, paths) for module in paths}
    assert sum(map(len, graph.values())) > len(graph), "imports are not recognised"
    # Fails with the circle, if there is one.
    TopologicalSorter(graph).prepare()
