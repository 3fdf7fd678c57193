"""Writes abbe/_verbs.py, abbe/_fields and the types of the page from the façade; --check tells whether they are up to
date.

The native module gives the JSON Schema of options and result of every verb, and the defaults of the options. Only what
is neither stands here: what a verb takes besides, and a sentence.
"""

from __future__ import annotations

import importlib.util
import json
import keyword
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parent / "abbe"
INTERFACES = Path(__file__).parent.parent / "web" / "src" / "evaluator" / "results.ts"
WIDTH = 120


class Verb:
    """A method: class of its result, options that may be given by position, other arguments, a sentence."""

    def __init__(self, result: str, about: str, *, first: tuple[str, ...] = (), words: tuple[str, ...] = ()) -> None:
        self.result, self.about, self.first, self.words = result, about, first, words


VERBS = {
    "eval": Verb("EvalResult", "Evaluates poses one by one: deviation, E_VE, and what each error contributes."),
    "equations": Verb("EquationsResult", "Returns the closed forms: E_VE and deviations as polynomials in the errors."),
    "convert": Verb("ConvertResult", "Returns the same machine under other conventions.", first=("to",)),
    "map": Verb("MapResult", "Maps the error over the volume."),
    "reach": Verb("ReachResult", "Returns the tips and directions of the tool within reach over a box."),
    "place": Verb("PlacementResult", "Tries the part of a job at places of the table: reach and deviation at each."),
    "compare": Verb("CompareResult", "Compares the machine with others on the same tool poses."),
    "budget": Verb("BudgetResult", "Returns what tolerances do to the volumetric error, and which to tighten first."),
    "enumerate": Verb("EnumerateResult", "Ranks all arrangements of the axes on the same work."),
    "instrument": Verb("InstrumentResult", "Returns the readings of an instrument.", first=("instrument",)),
    "identify": Verb("IdentifyResult", "Fits errors to measurements."),
    "fit_monomials": Verb("MonomialResult", "Fits monomials of order 2, component by component, as the papers do."),
    "plan": Verb("PlanResult", "Returns poses worth measuring, and the uncertainty that the parameters will have."),
    "predict": Verb("PredictResult", "Compares readings with the prediction of the machine, without a fit."),
    "locate": Verb(
        "LocateResult",
        "Returns the location errors that a control's own calibration found, beside those of the machine file.",
        words=("path",),
    ),
    "compare_targets": Verb(
        "TargetsResult", "Compares what the files of each target leave of the errors of the machine."
    ),
    "compile": Verb("CompileResult", "Compiles the files of a controller, with their certificate.", first=("target",)),
    "verify": Verb(
        "CertificateResult", "Replays the files in a folder, and certifies the residual.", words=("folder",)
    ),
    "diff_sets": Verb("SetDiffResult", "Returns what two sets of files differ in.", words=("old", "new")),
    "diff": Verb("DiffResult", "Returns what two machines differ in, and what each difference does."),
    "report": Verb("ReportResult", "Returns one self-contained page of HTML for a design review."),
    "import_readings": Verb(
        "ImportResult", "Makes a table of error curves of a measurement as an instrument exports it.", words=("path",)
    ),
    "import_touches": Verb(
        "TouchImportResult",
        "Reads what a touch probe logged at balls: touches for a fit, centres with their covariance.",
        words=("path",),
    ),
    "measure": Verb("MeasureResult", "Writes the program of a controller that touches balls.", words=("sets",)),
    "figures": Verb(
        "FiguresResult", "Returns figures of the ISO 230 series from the readings of a test.", words=("path",)
    ),
    "testpiece": Verb("TestPieceResult", "Makes a test piece of a standard as a job.", first=("kind",)),
    "record": Verb("RecordResult", "Makes the record of a calibration from its description.", words=("description",)),
    "record_trend": Verb(
        "TrendResult", "Puts records of one machine in a line: every error over the dates.", words=("*folders",)
    ),
}

#: Verbs whose result has the fields of another verb's.
SAME_FIELDS = {"compile": "verify"}

#: Results without options of their own.
PLAIN = {"classify": "ClassifyFields", "check_record": "CheckRecordFields"}

#: Names that a field cannot have as an attribute, of all results and of some.
NO_ATTRIBUTES = {"keys", "values", "items", "get"}
OF_RESULTS = {
    "MapFields": {"rows", "grid"},
    "BudgetFields": {"state"},
    "EnumerateFields": {"state"},
    "TrendFields": {"records"},
}

#: Verbs without a machine: functions.
FREE = ("import_readings", "figures", "testpiece", "record", "record_trend")

#: Verbs that take further machines: their number in words, for the docstring.
OTHERS = {"compare": "*others: Verbs", "report": "*others: Verbs", "diff": "other: Verbs"}

#: Options that take files: columns in memory do as well.
DATA = "Iterable[Table] | Table"

#: Options that take a table: a file, or columns in memory.
TABLES = {"tool_poses", "axis_poses", "pose_file"}

#: Words that name a folder with a set of files: one in memory does as well.
FOLDERS = {"verify": ("folder",), "diff_sets": ("old", "new"), "locate": ("path",)}

#: Verbs whose options have a type of their own, for what hands them on.
HANDED_ON = ("budget", "enumerate", "identify", "reach")

#: Fields that are `None` where the data do not determine them.
IF_DETERMINED = ("value", "smallest", "largest")

#: Types that the façade writes as text although most of their values are numbers.
NUMBERS_AS_TEXT = {"Order": "Union[int, Literal['exact', '1', '2', '3', '4', '5', '6']]"}

#: Options that the package sets itself.
OWN = {"identify": {"texts"}, "fit_monomials": {"texts"}, "predict": {"texts"}}

HEAD = '''"""The verbs as methods. python/generate.py writes this file from the options of the façade."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypedDict, Union

from . import _abbe
from ._calls import call, order_of
from ._readings import files_and_texts, folders_and_texts
from ._results import (
    %s,
)
from ._types import At, Poses, Progress, Table, Text
from ._types import Plane as PlaneOfAxes

'''


class Types:
    """Types of Python for the schemas of the options; those with names are collected."""

    def __init__(self) -> None:
        self.named: dict[str, str] = {}

    def of(self, schema: dict[str, Any], definitions: dict[str, Any]) -> str:
        """Returns the type of a schema."""
        if "$ref" in schema:
            name = str(schema["$ref"]).rsplit("/", 1)[1]
            if name not in self.named:
                # Those that it needs come before it.
                text = self.definition(name, definitions[name], definitions)
                self.named[name] = text
            return name
        if "const" in schema:
            return f'Literal["{schema["const"]}"]'
        if "enum" in schema:
            return f"Literal[{', '.join(json.dumps(word) for word in schema['enum'])}]"
        for key in ("anyOf", "oneOf"):
            if key in schema:
                return self.union([self.of(one, definitions) for one in schema[key]])
        kind = schema.get("type")
        if isinstance(kind, list):
            return self.union([self.of({**schema, "type": one}, definitions) for one in kind])
        if kind == "array" and "prefixItems" in schema:
            return f"tuple[{', '.join(self.of(one, definitions) for one in schema['prefixItems'])}]"
        if kind == "array":
            return f"Sequence[{self.of(schema['items'], definitions)}]"
        if kind == "object" and "properties" not in schema:
            return f"Mapping[str, {self.of(schema['additionalProperties'], definitions)}]"
        if kind == "object":
            name = "".join(word.capitalize() for key in schema["properties"] for word in key.split("_")) + "Choice"
            fields = {key: self.option(key, one, definitions) for key, one in schema["properties"].items()}
            body = ", ".join(f'"{key}": {annotation(of)}' for key, of in fields.items())
            self.named[name] = f'{name} = TypedDict("{name}", {{{body}}})'
            return name
        plain = {"string": "Text", "integer": "int", "number": "float", "boolean": "bool", "null": "None"}
        if kind in plain:
            return plain[kind]
        raise SystemExit(f"no type for {schema}")

    def option(self, name: str, schema: dict[str, Any], definitions: dict[str, Any]) -> str:
        """Returns the type of a field by its name: what Python takes besides the words of the façade."""
        kind = self.of(schema, definitions)
        instead = {"class": "ClassName", "target": "TargetName", "targets": "TargetName", "at": "At"}
        instead |= {"plane": "PlaneOfAxes"} | dict.fromkeys(TABLES, "Table")
        return re.sub(r"\bText\b", instead[name], kind) if name in instead else kind

    def union(self, kinds: list[str]) -> str:
        words = [kind[len("Literal[") : -1] for kind in kinds if kind.startswith("Literal[")]
        others = [kind for kind in dict.fromkeys(kinds) if not kind.startswith("Literal[")]
        return " | ".join(([f"Literal[{', '.join(words)}]"] if words else []) + others)

    def definition(self, name: str, schema: dict[str, Any], definitions: dict[str, Any]) -> str:
        """Returns the definition of a named type."""
        about = wrap("#: ", prose(schema.get("description", "")))
        if "properties" in schema:
            fields = [
                f'        "{key}": {annotation(self.option(key, one, definitions))},'
                for key, one in schema["properties"].items()
            ]
            docs = [wrap("#: ", f"``{key}``: {prose(described(one))}") for key, one in schema["properties"].items()]
            return "\n".join(
                [about, *docs, f'{name} = TypedDict(\n    "{name}",\n    {{', *fields, "    },", "    total=False,\n)"]
            )
        kind = NUMBERS_AS_TEXT.get(name) or annotation(self.of(schema, definitions))
        return f"{about}\n{name} = {kind}"


def annotation(kind: str) -> str:
    """Returns a union for Python 3.10 at run time."""
    parts = split(kind)
    return parts[0] if len(parts) == 1 else f"Union[{', '.join(parts)}]"


def split(kind: str) -> list[str]:
    """Splits a union at its outermost bars."""
    parts, depth, start = [], 0, 0
    for at, letter in enumerate(kind):
        depth += (letter in "[(") - (letter in "])")
        if letter == "|" and depth == 0:
            parts.append(kind[start:at].strip())
            start = at + 1
    return [*parts, kind[start:].strip()]


def described(schema: dict[str, Any]) -> str:
    return str(schema.get("description", ""))


def prose(text: str) -> str:
    """Returns a sentence of rustdoc for Python."""
    # A link of rustdoc is the name that it links.
    plain = re.sub(r"\[`(?:\w+::)*(\w+)(?:\(\))?`\](?:\([\w:]*(?:\(\))?\))?", r"`\1`", text)
    return " ".join(plain.replace("`", "``").split())


def wrap(lead: str, text: str) -> str:
    return "\n".join(textwrap.wrap(text, WIDTH, initial_indent=lead, subsequent_indent=lead, break_long_words=False))


def python_name(name: str) -> str:
    """Returns the name of an option that is no word of Python: `class_` for `class`."""
    return f"{name}_" if keyword.iskeyword(name) else name


def option(name: str, schema: dict[str, Any], default: Any, types: Types, definitions: Any) -> tuple[str, str]:
    """Returns the parameter of an option, and its value in the JSON."""
    kind = types.option(name, schema, definitions)
    value = python_name(name)
    if split(kind)[0] in NUMBERS_AS_TEXT:
        value = f"order_of({name})"
    scalar = isinstance(default, (bool, int, float, str)) and default != 2**64 - 1
    if not scalar and "None" not in split(kind):
        kind += " | None"
    return f"{python_name(name)}: {kind} = {default_text(default) if scalar else 'None'}", value


def default_text(default: Any) -> str:
    return json.dumps(default) if isinstance(default, str) else repr(default)


def method(name: str, found: dict[str, Any], types: Types) -> str:
    """Returns the source of a method, or of a function for a verb without a machine."""
    verb, free = VERBS[name], name in FREE
    schema, defaults = found["schema"], found["default"]
    definitions = schema.get("$defs", {})
    options = {key: one for key, one in schema["properties"].items() if key not in OWN.get(name, ())}
    parameters, values, docs = {}, {}, []
    for key, one in options.items():
        parameters[key], values[key] = option(key, one, defaults.get(key), types, definitions)
    # Readings may be tables in memory where the façade takes texts.
    takes_texts = "data" in options and "texts" in schema["properties"]
    if name == "eval":
        parameters["poses"], values["poses"] = "poses: Poses | None = None", "self._listed(poses)"
    if takes_texts:
        parameters["data"], values["data"] = f"data: {DATA} | None = None", "paths"
    for key, one in options.items():
        docs.append(f"{python_name(key)}: {prose(described(one))}")
    takes = [] if free else ["self"]
    in_memory = FOLDERS.get(name, ())
    takes += [f"{word}: Text | Mapping[str, bytes]" if word in in_memory else f"{word}: Text" for word in verb.words]
    if takes_texts:
        takes.append(parameters.pop("data"))
    takes += [parameters.pop(key) for key in verb.first]
    takes += [OTHERS[name]] if name in OTHERS else []
    takes += [] if any(taken.startswith("*") for taken in takes) else ["*"]
    takes += ["rows: bool = False"] if name == "map" else []
    takes += [*parameters.values(), "threads: int | None = None", "progress: Progress | None = None"]
    if name in HANDED_ON:
        own = ("data", "rows", "threads", "progress")
        keys = [one.split(" = ")[0].split(": ", 1) for one in takes if " = " in one and not one.startswith(own)]
        fields = "".join(f'    "{key}": {annotation(of)},\n' for key, of in keys)
        types.named[f"{name}_options"] = (
            f"#: Options of :meth:`abbe.Machine.{name}`.\n{name.capitalize()}Options = "
            f'TypedDict(\n    "{name.capitalize()}Options",\n    {{\n{fields}    }},\n    total=False,\n)'
        )
    indent = "" if free else "    "
    if name == "compile":
        takes = [
            one.replace('target: TargetName = ""', "target: TargetName | Sequence[TargetName]", 1) for one in takes
        ]
        values["target"] = "targets[0]"
    lines = [f"def {name}(", *(f"    {one}," for one in takes), f") -> {verb.result}:"]
    text = [verb.about, ""]
    if name == "compile":
        text += ["``target`` may be two: one of kinematic parameters, and one of tables for what they leave.", ""]
    if name == "map":
        text += ["``rows`` keeps every pose with its deviation, for ``rows``, ``to_pandas`` and ``to_xarray``.", ""]
    text += ["Options, each with the default of the façade where it is ``None``:", ""]
    inner = indent + "    "
    body = [f'{inner}"""{text[0]}']
    for line in text[1:]:
        body += textwrap.wrap(line, WIDTH, initial_indent=inner, subsequent_indent=inner) or [""]
    for doc in docs:
        body += textwrap.wrap(
            f"* ``{doc.partition(':')[0]}``:{doc.partition(':')[2]}",
            WIDTH,
            initial_indent=inner,
            subsequent_indent=inner + "  ",
            break_long_words=False,
        )
    body += [f'{inner}"""']
    if takes_texts:
        body += [f"{inner}paths, texts = files_and_texts(data)"]
    body += [
        f"{inner}options: dict[str, Any] = {{",
        *(f'{inner}    "{key}": {value},' for key, value in values.items()),
        f"{inner}}}",
    ]
    machines = {"diff": "[self._native, other._native]"}.get(
        name, "[self._native, *(other._native for other in others)]"
    )
    machines = machines if name in OTHERS else "[]" if free else "[self._native]"
    words = f", words=[{', '.join(verb.words)}]" if verb.words else ""
    if name == "compile":
        body.insert(
            -len(values) - 2, f"{inner}targets = [target] if isinstance(target, (str, PathLike)) else [*target]"
        )
        words = ", words=targets"
    if takes_texts:
        words = ", texts=texts"
    if in_memory:
        body.append(f"{inner}words, texts = folders_and_texts({', '.join(verb.words)})")
        words = ", words=words, texts=texts"
    rows = ", rows=rows" if name == "map" else ""
    run = f'call("{name}", {machines}, options{words}{rows}, threads=threads, progress=progress)'
    again = {
        "map": ", self._picture_again(options, threads)",
        "identify": ", self._fit_picture_again(options, texts, threads)",
    }.get(name, "")
    body += [f"{inner}found = {run}", f"{inner}return {verb.result}(found{again})"]
    return "\n".join([*(indent + line for line in lines), *body])


FIELDS_HEAD = '''"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Union

from .._record import Named, Record
'''

#: Modules of fields by the verbs whose results they hold; what several need stands in the first of these.
FIELD_MODULES = {
    "deviations": ("eval", "map", "reach", "place", "compare"),
    "machines": ("show", "check", "classify", "convert", "diff", "equations"),
    "designs": ("budget", "enumerate", "report"),
    "measurements": (
        "instrument",
        "identify",
        "fit_monomials",
        "plan",
        "predict",
        "locate",
        "import_readings",
        "import_touches",
        "measure",
        "figures",
    ),
    "sets": (
        "compile",
        "compare_targets",
        "verify",
        "diff_sets",
        "targets",
        "testpiece",
        "record",
        "record_trend",
        "check_record",
    ),
}


class Fields:
    """Classes for the schemas of results, those that others need first, and the module of each."""

    def __init__(self, definitions: dict[str, Any], roots: dict[str, str]) -> None:
        self.definitions, self.roots = definitions, roots
        self.classes: dict[str, str] = {}
        self.modules: dict[str, str] = {}
        self.used: dict[str, set[str]] = {module: set() for module in FIELD_MODULES}
        self.module = ""

    def of(self, schema: Any) -> str:
        """Returns the type of a schema."""
        if not isinstance(schema, dict):
            return "Any"
        if "$ref" in schema:
            return self.named(str(schema["$ref"]).rsplit("/", 1)[1])
        for key in ("anyOf", "oneOf"):
            if key in schema:
                return self.union([self.of(one) for one in schema[key]])
        if "const" in schema:
            return f"Literal[{json.dumps(schema['const'])}]"
        if "enum" in schema:
            return f"Literal[{', '.join(json.dumps(word) for word in schema['enum'])}]"
        kind = schema.get("type")
        if isinstance(kind, list):
            return self.union([self.of({**schema, "type": one}) for one in kind])
        if kind == "array":
            inner = self.union([self.of(one) for one in schema.get("prefixItems") or [schema.get("items", True)]])
            return f"list[{annotation(inner)}]"
        if kind == "object" and "additionalProperties" in schema:
            return f"Named[{annotation(self.of(schema['additionalProperties']))}]"
        plain = {"string": "str", "integer": "int", "number": "float", "boolean": "bool", "null": "None"}
        return plain.get(str(kind), "Any")

    def union(self, kinds: list[str]) -> str:
        words = [kind[len("Literal[") : -1] for kind in kinds if kind.startswith("Literal[")]
        others = [kind for kind in dict.fromkeys(kinds) if not kind.startswith("Literal[")]
        return " | ".join(([f"Literal[{', '.join(words)}]"] if words else []) + others)

    def named(self, name: str) -> str:
        """Returns the type of a definition; the class of an object is written once."""
        schema = self.definitions[name]
        variants = [self.resolved(one) for one in schema.get("anyOf", schema.get("oneOf", []))]
        if variants and all("properties" in one for one in variants):
            schema = merged(schema, variants)
        if "properties" not in schema:
            return self.of(schema)
        written = self.roots.get(name, name)
        if written not in self.classes:
            self.classes[written] = ""
            text = self.source(written, schema)
            # Those that it needs come before it.
            del self.classes[written]
            self.classes[written] = text
            self.modules[written] = self.module
        self.used[self.module].add(written)
        return written

    def resolved(self, schema: dict[str, Any]) -> dict[str, Any]:
        """Returns a schema without its reference; the tag of a variant stands beside that."""
        if "$ref" not in schema:
            return schema
        found: dict[str, Any] = self.definitions[schema["$ref"].rsplit("/", 1)[1]]
        if "properties" not in schema:
            return found
        properties = {**schema["properties"], **found["properties"]}
        return {**found, "properties": properties, "required": [*schema["required"], *found.get("required", [])]}

    def source(self, name: str, schema: dict[str, Any]) -> str:
        taken = NO_ATTRIBUTES | OF_RESULTS.get(name, set())
        required, lines = set(schema.get("required", [])), []
        for field, one in schema["properties"].items():
            kind = self.of(one)
            if field not in required and "None" not in split(kind):
                kind += " | None"
            if field in IF_DETERMINED and "determined" in schema["properties"]:
                kind += " | None"
            if field.isidentifier() and not keyword.iskeyword(field) and field not in taken:
                about = json.dumps(prose(described(one)), ensure_ascii=False)
                lines.append(f"    {field}: Annotated[{annotation(kind)}, {about}]")
        about = prose(schema.get("description", "")) or f"Fields of {name}."
        return "\n".join([f"class {name}(Record):", f'    """{about}"""', "", *lines])

    def text(self, module: str) -> str:
        """Returns the text of a module."""
        classes = {name: text for name, text in self.classes.items() if self.modules[name] == module}
        used = sorted(name for name in self.used[module] if self.modules[name] != module)
        others = {name: [one for one in used if self.modules[one] == name] for name in FIELD_MODULES}
        imports = [f"from .{name} import {', '.join(names)}" for name, names in others.items() if names]
        return "\n".join([FIELDS_HEAD.rstrip(), *imports, "", "", "\n\n\n".join(classes.values()), ""])


def merged(schema: dict[str, Any], variants: list[dict[str, Any]]) -> dict[str, Any]:
    """Returns one object for several: what not all of them require is optional."""
    # What all have stands beside the variants.
    properties: dict[str, Any] = dict(schema.get("properties", {}))
    for one in variants:
        for field, of in one["properties"].items():
            known = properties.setdefault(field, of)
            if "const" in of and known != of:
                properties[field] = {"enum": [*known.get("enum", [known.get("const")]), of["const"]]}
    required = set.intersection(*(set(one.get("required", [])) for one in variants)) | set(schema.get("required", []))
    return {"description": schema.get("description", ""), "properties": properties, "required": sorted(required)}


def fields_sources(found: dict[str, Any]) -> dict[str, str]:
    """Returns the texts of the modules of fields by their names."""
    results, roots = found["results"], {}
    names = {verb: of.result.removesuffix("Result") + "Fields" for verb, of in VERBS.items()} | PLAIN
    for verb, name in names.items():
        if verb not in SAME_FIELDS:
            roots[str(results[verb]["$ref"]).rsplit("/", 1)[1]] = name
    if set(results) != {verb for verbs in FIELD_MODULES.values() for verb in verbs}:
        raise SystemExit("FIELD_MODULES does not name every result once")
    fields = Fields(found["definitions"], roots)
    for module, verbs in FIELD_MODULES.items():
        fields.module = module
        for verb in verbs:
            if verb not in SAME_FIELDS:
                fields.of(results[verb])
    return {f"_fields/{module}.py": fields.text(module) for module in FIELD_MODULES}


class Interfaces:
    """Interfaces of TypeScript for the schemas of answers."""

    HEAD = "/** Answers of the library. python/generate.py writes this file from the results of the façade. */\n"

    def __init__(self, definitions: dict[str, Any]) -> None:
        self.definitions = definitions

    def of(self, schema: Any) -> str:
        """Returns the type of a schema."""
        if not isinstance(schema, dict):
            return "unknown"
        variants = [self.of(one) for key in ("anyOf", "oneOf") for one in schema.get(key, [])]
        own = [self.members(schema)] if "properties" in schema else []
        if "$ref" in schema:
            own.append(str(schema["$ref"]).rsplit("/", 1)[1])
        if variants or own:
            union = " | ".join(dict.fromkeys(variants))
            return " & ".join([*own, *([f"({union})" if own else union] if union else [])])
        if "const" in schema:
            return json.dumps(schema["const"])
        if "enum" in schema:
            return " | ".join(json.dumps(word) for word in schema["enum"])
        kind = schema.get("type")
        if isinstance(kind, list):
            return " | ".join(self.of({**schema, "type": one}) for one in kind)
        if kind == "array":
            return self.array(schema)
        if kind == "object":
            return f"Record<string, {self.of(schema.get('additionalProperties', True))}>"
        plain = {"string": "string", "integer": "number", "number": "number", "boolean": "boolean", "null": "null"}
        return plain.get(str(kind), "unknown")

    def array(self, schema: dict[str, Any]) -> str:
        """Returns the type of a list; of a short one with a fixed length a tuple."""
        if "prefixItems" in schema:
            return f"[{', '.join(self.of(one) for one in schema['prefixItems'])}]"
        item, count = self.of(schema.get("items", True)), schema.get("minItems")
        if count and count == schema.get("maxItems") and count <= 4:
            return f"[{', '.join([item] * count)}]"
        return f"({item})[]" if " " in item else f"{item}[]"

    def members(self, schema: dict[str, Any], indent: str = "") -> str:
        required = set(schema.get("required", []))
        lines = []
        for field, one in schema["properties"].items():
            if described(one):
                lines.append(f"{indent}  /** {' '.join(described(one).split())} */")
            lines.append(f"{indent}  {field}{'' if field in required else '?'}: {self.of(one)};")
        return "\n".join(["{", *lines, indent + "}"])

    def text(self) -> str:
        """Returns the text of the module."""
        return "\n".join([self.HEAD, *(self.definition(name) for name in sorted(self.definitions))])

    def definition(self, name: str) -> str:
        schema = self.definitions[name]
        about = f"/** {' '.join(described(schema).split())} */\n" if described(schema) else ""
        if "properties" in schema and not {"anyOf", "oneOf"} & set(schema):
            return f"{about}export interface {name} {self.members(schema)}\n"
        return f"{about}export type {name} = {self.of(schema)};\n"


def native() -> Any:
    """Returns the native module by itself: the package imports what is generated here."""
    package = importlib.util.find_spec("abbe")
    folders = package.submodule_search_locations if package else None
    for folder in folders or []:
        for file in sorted(Path(folder).glob("_abbe*.so")):
            spec = importlib.util.spec_from_file_location("_abbe", file)
            if spec is not None and spec.loader is not None:
                module = importlib.util.module_from_spec(spec)
                spec.loader.exec_module(module)
                return module
    raise SystemExit("the native module is not built: maturin develop")


def verbs_source(verbs: dict[str, Any], names: tuple[list[str], list[str]]) -> str:
    """Returns the text of the module of verbs."""
    if set(verbs) != set(VERBS):
        raise SystemExit(f"verbs without an entry here, or the other way round: {set(verbs) ^ set(VERBS)}")
    types = Types()
    classes, targets = names
    types.named["ClassName"] = f"#: Classes of machines.\nClassName = Literal{json.dumps(classes)}"
    types.named["TargetName"] = (
        "#: Controllers; a path names one of templates of your own.\n"
        f"TargetName = Union[Literal{json.dumps(targets)}, PathLike[str]]"
    )
    methods = {name: method(name, verbs[name], types) for name in VERBS}
    functions = "\n\n\n".join(methods.pop(name) for name in FREE)
    head = HEAD % ",\n    ".join(sorted({verb.result for verb in VERBS.values()}))
    first = [
        "class Verbs:",
        '    """The verbs of a machine."""',
        "",
        "    _native: _abbe.NativeMachine",
        "",
        "    def _picture_again(self, options: Mapping[str, Any], threads: int | None) -> Callable[[], Any]:",
        "        raise NotImplementedError",
        "",
        "    def _fit_picture_again(",
        "        self, options: Mapping[str, Any], texts: list[tuple[str, str]], threads: int | None",
        "    ) -> Callable[[], Any]:",
        "        raise NotImplementedError",
        "",
        "    def _listed(self, poses: Poses | None) -> list[list[float]] | None:",
        "        raise NotImplementedError",
        "",
    ]
    named = "\n\n".join(types.named.values())
    return (
        head + named + "\n\n\n" + "\n".join(first) + "\n" + "\n\n".join(methods.values()) + "\n\n\n" + functions + "\n"
    )


def main() -> None:
    """Writes the modules, or compares them."""
    module = native()
    found = json.loads(module.run("targets", [], [], "{}", [], False, 1).json())["targets"]
    names = (list(module.CLASS_NAMES), [target["target"] for target in found])
    texts = {
        "_verbs.py": verbs_source(json.loads(module.verbs()), names),
        **fields_sources(json.loads(module.results())),
    }
    outputs = {PACKAGE / name: text for name, text in texts.items()}
    outputs[INTERFACES] = Interfaces(json.loads(module.answers())).text()
    for out, text in outputs.items():
        if sys.argv[1:] != ["--check"]:
            out.write_text(text, encoding="utf-8")
        elif not out.exists() or out.read_text(encoding="utf-8") != text:
            raise SystemExit(f"{out.name} is not what the façade has: run python/generate.py")


if __name__ == "__main__":
    main()
