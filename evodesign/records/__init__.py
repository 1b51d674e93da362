"""What is remembered: the values that cross process borders and reach the disk.

Every record is immutable, refuses unknown fields, and is written as JSON. Units are SI; torque norms
are Euclidean norms over an agent's moving joints [N m]. A value that does not exist (the torque of a
case that was not solved) is absent or None, never a large number.
"""

from __future__ import annotations

from evodesign.records.cases import Case, Sense, Status, task_names, worst_status
from evodesign.records.evaluations import (
    NO_SECONDS,
    Assessed,
    Assessment,
    CaseGradient,
    CaseOutcome,
    Detail,
    Evaluation,
    Front,
    Generation,
    Gradients,
    ReachOutcome,
    SampledDesign,
    SampledPeople,
    Turn,
    WeakestPush,
)
from evodesign.records.parameters import (
    Constraint,
    Genome,
    Objective,
    Parameter,
    choice_at,
    design_of,
    materials_of,
    middle_of,
)
from evodesign.records.postures import (
    ActiveLimit,
    AgentDetail,
    CaseDetail,
    InstantDetail,
    LoadCaseDetail,
    evenly,
)
from evodesign.records.runs import (
    FORMAT_VERSION,
    SUM,
    Descriptor,
    ProblemSource,
    RunHeader,
    SearchSettings,
    SearchStage,
)
from evodesign.tasks import Hold, Lift, Record, Task

__all__ = [
    "FORMAT_VERSION",
    "NO_SECONDS",
    "SUM",
    "ActiveLimit",
    "AgentDetail",
    "Assessed",
    "Assessment",
    "Case",
    "CaseDetail",
    "CaseGradient",
    "CaseOutcome",
    "Constraint",
    "Descriptor",
    "Detail",
    "Evaluation",
    "Front",
    "Generation",
    "Genome",
    "Gradients",
    "Hold",
    "InstantDetail",
    "Lift",
    "LoadCaseDetail",
    "Objective",
    "Parameter",
    "ProblemSource",
    "ReachOutcome",
    "Record",
    "RunHeader",
    "SampledDesign",
    "SampledPeople",
    "SearchSettings",
    "SearchStage",
    "Sense",
    "Status",
    "Task",
    "Turn",
    "WeakestPush",
    "choice_at",
    "design_of",
    "evenly",
    "materials_of",
    "middle_of",
    "task_names",
    "worst_status",
]
