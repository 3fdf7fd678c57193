"""Makes links of the roles in docstrings, ``:meth:`Machine.map``` and their like."""

import re
from typing import Any

import griffe

ROLE = re.compile(r":(?:func|class|meth|mod|attr):`~?([\w.]+)`")


class Roles(griffe.Extension):
    """Writes each role as a reference of mkdocstrings."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Rewrites the docstring of a module, class, function or attribute."""
        if obj.docstring:
            obj.docstring.value = ROLE.sub(lambda role: target(role[1], obj), obj.docstring.value)


def target(name: str, place: griffe.Object) -> str:
    """Returns the link; public names stand in the package, a method without one in its class."""
    known = name if name.startswith("abbe") else f"abbe.{name}" if name[0].isupper() or place.is_module else ""
    return f"[`{name}`][{known}]" if known else f"`{name}`"
