"""Objects of results: JSON objects whose keys are attributes too. Their types are generated, in ``_fields``."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar, Union, get_args, get_origin, get_type_hints

Value = TypeVar("Value")


class Record(Mapping[str, Any]):
    """An object of a result: its keys are attributes too. A field that is absent is ``None`` as an attribute."""

    __slots__ = ("_value",)

    @classmethod
    @functools.cache
    def _types(cls) -> dict[str, Any]:
        """Returns the declared types of the fields."""
        return {name: kind for name, kind in get_type_hints(cls).items() if not name.startswith("_")}

    @classmethod
    def field_docs(cls) -> dict[str, str]:
        """Returns what each field is, with its unit."""
        hints = get_type_hints(cls, include_extras=True)
        return {name: kind.__metadata__[0] for name, kind in hints.items() if get_origin(kind) is Annotated}

    def __init__(self, value: dict[str, Any]) -> None:
        self._value = value

    def __getitem__(self, key: str) -> Any:
        kind = self._types().get(key)
        # The datum made the number, not the data; ``to_dict`` has it.
        if self._value.get("determined") is False and key in self._value and type(None) in get_args(kind):
            return None
        return wrapped(self._value[key], kind)

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_"):
            if name in self._value:
                return self[name]
            if type(None) in get_args(self._types().get(name)):
                return None
        raise AttributeError(f"no field `{name}`: there are {', '.join(self._value)}")

    def __getstate__(self) -> Any:
        return self._value

    def __setstate__(self, state: Any) -> None:
        self._value = state

    def __iter__(self) -> Iterator[str]:
        return iter(self._value)

    def __len__(self) -> int:
        return len(self._value)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._value]

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            raise AttributeError(f"results do not change: `{name}` cannot be set")
        object.__setattr__(self, name, value)

    def __eq__(self, other: object) -> bool:
        return bool(self._value == (other._value if isinstance(other, Record) else other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._value!r})"

    def to_dict(self) -> dict[str, Any]:
        """Returns the object as plain Python values, which are the caller's own."""
        own: dict[str, Any] = copied(self._value)
        return own


class Named(Record, Generic[Value]):
    """Values of one kind by names, such as those of axes or errors; the names are attributes too."""

    __slots__ = ("_kind",)

    def __init__(self, value: dict[str, Any], kind: Any = None) -> None:
        super().__init__(value)
        self._kind = kind

    def __getitem__(self, key: str) -> Value:
        found: Value = wrapped(self._value[key], self._kind)
        return found

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Value: ...

    def __getstate__(self) -> Any:
        return self._value, self._kind

    def __setstate__(self, state: Any) -> None:
        self._value, self._kind = state


def copied(value: Any) -> Any:
    """Returns a copy of objects and lists of JSON."""
    if isinstance(value, dict):
        return {key: copied(inner) for key, inner in value.items()}
    return [copied(inner) for inner in value] if isinstance(value, list) else value


def wrapped(value: Any, kind: Any = None) -> Any:
    """Returns JSON objects as records of the class that a type names, also in lists."""
    if not isinstance(value, (dict, list)):
        return value
    if get_origin(kind) in (Union, UnionType):
        kind = next((one for one in get_args(kind) if holds(one, value)), None)
    if isinstance(value, list):
        inner = get_args(kind)[0] if get_origin(kind) is list else None
        return [wrapped(item, inner) for item in value]
    if get_origin(kind) is Named:
        return Named(value, get_args(kind)[0])
    return (kind if isinstance(kind, type) and issubclass(kind, Record) else Record)(value)


def holds(kind: Any, value: dict[str, Any] | list[Any]) -> bool:
    """True if a type is that of lists, or of objects."""
    origin = get_origin(kind) or kind
    return origin is list if isinstance(value, list) else isinstance(origin, type) and issubclass(origin, Record)
