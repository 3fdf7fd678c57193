"""Objects of results: JSON objects whose keys are attributes too. Their types are generated, in ``_fields``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, TypeVar, Union

Value = TypeVar("Value")


class Record(Mapping[str, Any]):
    """An object of a result: its keys are attributes too. A field that is absent is ``None`` as an attribute."""

    __slots__ = ("_value",)

    #: The classes of objects in fields, at any depth of lists.
    _kinds: ClassVar[Mapping[str, Kind]] = {}
    #: Fields that may be absent.
    _optional: ClassVar[frozenset[str]] = frozenset()

    def __init__(self, value: dict[str, Any]) -> None:
        self._value = value

    def __getitem__(self, key: str) -> Any:
        return wrapped(self._value[key], self._kinds.get(key))

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_"):
            if name in self._value:
                return self[name]
            if name in self._optional:
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

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._value == other._value

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._value!r})"

    def to_dict(self) -> dict[str, Any]:
        """Returns the object as plain Python values."""
        return self._value


class Named(Record, Generic[Value]):
    """Values of one kind by names, such as those of axes or errors; the names are attributes too."""

    __slots__ = ("_kind",)

    def __init__(self, value: dict[str, Any], kind: Kind | None = None) -> None:
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


class Names(NamedTuple):
    """The kind of values by names; none for plain values."""

    of: Any


Kind = Union[type[Record], Names]


def wrapped(value: Any, kind: Kind | None = None) -> Any:
    """Returns JSON objects as records of a kind, also in lists."""
    if isinstance(value, dict):
        if isinstance(kind, Names):
            return Named(value, kind.of)
        return (kind or Record)(value)
    if isinstance(value, list):
        return [wrapped(item, kind) for item in value]
    return value
