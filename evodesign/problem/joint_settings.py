"""The `[baseline]` table of a problem file as the joint problem takes it."""

from __future__ import annotations

from collections.abc import Mapping

from evodesign.design.parameter import ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.nlp.method import SolverOptions
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.codesign import JointSettings
from evodesign.posture.limit_groups import Enforced
from evodesign.posture.postures import Symmetry
from evodesign.posture.terms.paper_tasks import Tasks, TaskWeights
from evodesign.problem.file import ProblemFile
from evodesign.problem.unknown_names import refuse_unknown
from evodesign.records import Genome, ProblemSource


def joint_settings(
    tables: ProblemFile,
    source: ProblemSource,
    space: DesignSpace,
    efforts: EffortWeights,
    symmetry: Symmetry,
) -> JointSettings:
    """Costs and limits of the joint problem.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        space: design parameters.
        efforts: weights of the agents' torques.
        symmetry: of the problem's postures.
    Raises:
        InputError: preferred densities are asked for and missing, or there is no density to prefer.
    """
    table, weights = tables.baseline, tables.baseline.weights
    preferred = table.preferred_densities_kg_per_m3
    if weights.density:
        if not preferred:
            key = "baseline.preferred_densities_kg_per_m3"
            raise InputError(source.path, key, "densities, as baseline.weights.density asks for", "none")
        if all(parameter.kind is not ParameterKind.DENSITY for parameter in space.parameters):
            key = "baseline.weights.density"
            raise InputError(source.path, key, "0.0 without a [[design.density]]", f"{weights.density:g}")
    return JointSettings(
        efforts=efforts,
        tasks=Tasks(
            TaskWeights(weights.torque, weights.density, weights.center_of_pressure, weights.mass_height),
            preferred,
        ),
        enforced=Enforced(table.joint_limits, table.contact_limits, table.stance_limits, table.length_bounds),
        options=SolverOptions(iterations=table.iterations, seconds=table.seconds, compiled=table.compile),
        symmetric=symmetry is not Symmetry.OFF,
    )


def joint_start(
    tables: ProblemFile, source: ProblemSource, known: Mapping[str, Genome]
) -> tuple[Genome, ...]:
    """The genomes with which the starts begin.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        known: genomes of the designs of `search.start`, by name.
    Raises:
        InputError: a name that is not among them.
    """
    names = tables.baseline.start
    if names is None:
        return tuple(known.values())
    if tables.search.start is None:
        raise InputError(source.path, "baseline.start", "search.start, the file that holds designs", "none")
    for position, name in enumerate(names):
        refuse_unknown(source, f"baseline.start[{position}]", "design", name, known, tables.search.start)
    return tuple(known[name] for name in names)
