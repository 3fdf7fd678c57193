"""Makes the package readable for mkdocstrings.

Roles of Sphinx are links, the texts of annotated fields are text, and results have their fields themselves.
"""

import re
from typing import Any

import griffe

ROLE = re.compile(r":(?:func|class|meth|mod|attr):`~?([\w.]+)`")


class Readable(griffe.Extension):
    """Rewrites what the sources say in the manner of Sphinx."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Walks through all objects of a package when it is read."""
        rewrite(pkg, pkg)
        fields = {name: kind for module in pkg["_fields"].modules.values() for name, kind in module.classes.items()}
        for result in pkg["_results"].classes.values():
            for base in map(str, result.bases):
                for name, field in fields[base.split(".")[-1]].members.items() if base.startswith("_fields.") else ():
                    result.set_member(name, griffe.Alias(name, field, parent=result))


def rewrite(place: griffe.Object, package: griffe.Module) -> None:
    """Rewrites an object and what it holds."""
    if place.docstring:
        place.docstring.value = ROLE.sub(lambda role: link(role[1], place, package), place.docstring.value)
    elif place.is_attribute and str(place.annotation).startswith("Annotated["):
        kind, words = place.annotation.slice.elements
        place.docstring = griffe.Docstring(str(words).strip("'\""), parent=place)
        place.annotation = kind
    for member in place.members.values():
        if not member.is_alias:
            rewrite(member, package)


def link(name: str, place: griffe.Object, package: griffe.Module) -> str:
    """Returns a reference to a public name: of the package, or of the class around it."""
    first = name.removeprefix("abbe.").split(".")[0]
    known = f"abbe.{name.removeprefix('abbe.')}" if first in package.members else None
    return f"[`{name}`][{known}]" if known else f"`{name}`"
