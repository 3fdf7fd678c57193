"""Results against their declared types: every field is declared, present where it must be, and of its type."""

from __future__ import annotations

import keyword
import types
import typing
from typing import Any, Literal, Union

from abbe import Named, Record, Result

#: Fields of every document.
OF_DOCUMENTS = {"warnings", "more_warnings"}

_hints: dict[type, dict[str, Any]] = {}


def hints(of: type) -> dict[str, Any]:
    """Returns the declared fields of a class."""
    if of not in _hints:
        _hints[of] = {name: kind for name, kind in typing.get_type_hints(of).items() if not name.startswith("_")}
    return _hints[of]


def check_result(found: Record, place: str = "") -> None:
    """Fails where a result is not what its class declares."""
    declared = hints(type(found))
    place = place or type(found).__name__
    if type(found) is Record:
        raise AssertionError(f"{place} has no class of its own")
    for name in found:
        if name in OF_DOCUMENTS and isinstance(found, Result):
            continue
        if name in declared:
            check_value(found[name], declared[name], f"{place}.{name}")
        else:
            # Names that a method or a word of Python has.
            assert hasattr(type(found), name) or keyword.iskeyword(name), f"{place}.{name} is not declared"
    for name in set(declared) - set(found):
        assert type(None) in typing.get_args(declared[name]), f"{place}.{name} is missing"
        assert getattr(found, name) is None


def check_value(value: Any, kind: Any, place: str) -> None:
    """Fails where a value is not of its type."""
    if kind is Any:
        return
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin in (Union, types.UnionType):
        fitting = [one for one in inner if fits(value, one)]
        assert fitting, f"{place}: {value!r} is not {kind}"
        check_value(value, fitting[0], place)
        return
    assert fits(value, kind), f"{place}: {value!r} is not {kind}"
    if origin is list:
        for index, one in enumerate(value):
            check_value(one, inner[0], f"{place}[{index}]")
    elif origin is Named:
        for name in value:
            check_value(value[name], inner[0], f"{place}.{name}")
    elif isinstance(kind, type) and issubclass(kind, Record):
        check_result(value, place)


def fits(value: Any, kind: Any) -> bool:
    """True if a value is of a type, what is in it left aside."""
    origin = typing.get_origin(kind)
    if origin is Literal:
        return value in typing.get_args(kind)
    if kind is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if kind is int:
        return isinstance(value, int) and not isinstance(value, bool)
    return kind is Any or isinstance(value, origin or kind)
