"""abbe: from a machine-tool configuration to volumetric compensation.

A YAML file describes a machine tool: its kinematic chain and its geometric errors (ISO 230-1). :func:`load` reads it;
the methods of a :class:`Machine` compute error maps, budgets and comparisons, identify errors from measurements, and
compile the files that a CNC controller loads.

Deviations are actual minus nominal, tool relative to workpiece. Lengths are in mm and angles in rad unless a name ends
in another unit; positions of rotary axes are in deg as programmed.
"""

from ._abbe import __version__
from ._calls import set_threads
from ._diagnostics import Diagnostic, DiagnosticError, DiagnosticWarning, Place
from ._functions import (
    check,
    check_record,
    classify,
    explain,
    figures,
    import_readings,
    record,
    record_trend,
    schema,
    starter,
    targets,
    testpiece,
)
from ._machine import Deviations, ErrorTerm, Machine, load, loads
from ._record import Named, Record
from ._results import (
    BudgetResult,
    CertificateResult,
    CheckRecordResult,
    ClassifyResult,
    CompareResult,
    CompileResult,
    ConvertResult,
    DiffResult,
    EnumerateResult,
    EquationsResult,
    EvalResult,
    FiguresResult,
    IdentifyResult,
    ImportResult,
    InstrumentResult,
    LocateResult,
    MapResult,
    MonomialResult,
    PlacementResult,
    PlanResult,
    ReachResult,
    RecordResult,
    ReportResult,
    Result,
    SetDiffResult,
    TestPieceResult,
    TrendResult,
)

__all__ = [
    "BudgetResult",
    "CertificateResult",
    "CheckRecordResult",
    "ClassifyResult",
    "CompareResult",
    "CompileResult",
    "ConvertResult",
    "Deviations",
    "Diagnostic",
    "DiagnosticError",
    "DiagnosticWarning",
    "DiffResult",
    "EnumerateResult",
    "EquationsResult",
    "ErrorTerm",
    "EvalResult",
    "FiguresResult",
    "IdentifyResult",
    "ImportResult",
    "InstrumentResult",
    "LocateResult",
    "Machine",
    "MapResult",
    "MonomialResult",
    "Named",
    "Place",
    "PlacementResult",
    "PlanResult",
    "ReachResult",
    "Record",
    "RecordResult",
    "ReportResult",
    "Result",
    "SetDiffResult",
    "TestPieceResult",
    "TrendResult",
    "__version__",
    "check",
    "check_record",
    "classify",
    "explain",
    "figures",
    "import_readings",
    "load",
    "loads",
    "record",
    "record_trend",
    "schema",
    "set_threads",
    "starter",
    "targets",
    "testpiece",
]
