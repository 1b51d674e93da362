"""Every field of every record counts in the key that it belongs to, unless it is excepted by name.

The records are those of the shipped problems, found by walking; a field that somebody adds is found too.
"""

from __future__ import annotations

import copy
import dataclasses
import math
import typing
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache, partial
from pathlib import Path
from types import NoneType
from typing import Any

import msgspec
import pytest

from evodesign.collision.rules import CollisionRules
from evodesign.evaluation.factory import NO_PART_OF_EVALUATIONS, problem_digest
from evodesign.evaluation.precompute import precompute_setting
from evodesign.identity import Exceptions
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.formulations.base import NO_PART_OF_PROGRAMS, program_key
from evodesign.posture.postures import Symmetry
from evodesign.posture.precompute.keys import NO_PART_OF, key_of, no_part_of
from evodesign.posture.precompute.plan import Piece, PrecomputeSetting, Subject
from evodesign.problem.build import build_problem
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml, read_source
from evodesign.records import Hold, ProblemSource

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Change:
    """A value with one field of one record in it changed.

    Args:
        kind: the record's class.
        place: where the field lies, and its new value.
        excepted: whether this field, or one that holds the record, is named as an exception.
        value: the whole with the change.
    """

    kind: type
    place: str
    excepted: bool
    value: Any


def fields_of(record: Any) -> tuple[str, ...] | None:
    if isinstance(record, msgspec.Struct):
        return record.__struct_fields__
    return tuple(f.name for f in dataclasses.fields(record)) if dataclasses.is_dataclass(record) else None


def with_field(record: Any, name: str, value: Any) -> Any:
    """The record with another value in a field, whatever its constructor would say to that."""
    changed = copy.copy(record)
    setter = msgspec.structs.force_setattr if isinstance(record, msgspec.Struct) else object.__setattr__
    setter(changed, name, value)
    return changed


def with_part(whole: Any, key: Any, part: Any) -> Any:
    """The tuple or mapping with another part."""
    return {**whole, key: part} if isinstance(whole, Mapping) else (*whole[:key], part, *whole[key + 1 :])


def changes(whole: Any, without: Exceptions) -> Iterator[Change]:
    """Each field of each record changed, one at a time; of records in like places each field of the first is.

    Of the others those fields are that the first has empty: a person's strengths beside a robot's none.
    """
    seen: set[tuple[str, type]] = set()

    def walk(value: Any, place: str, excepted: bool, rebuilt: Callable[[Any], Any]) -> Iterator[Change]:
        names = fields_of(value)
        if isinstance(value, tuple | Mapping):
            parts = dict(value) if isinstance(value, Mapping) else dict(enumerate(value))
            for key, part in parts.items():
                again = partial(with_part, value, key)
                yield from walk(part, f"{place}[]", excepted, lambda new, again=again: rebuilt(again(new)))
        elif names is not None:
            hints = typing.get_type_hints(type(value))
            for name in names:
                out = excepted or name in without.get(type(value), {})
                part, again = getattr(value, name), partial(with_field, value, name)
                met = (f"{place}.{name}", type(part) if part else NoneType)
                if met not in seen:
                    seen.add(met)
                    for other in others(part, hints[name]):
                        yield Change(type(value), f"{met[0]}: {other!r:.60}", out, rebuilt(again(other)))
                yield from walk(part, f"{place}.{name}", out, lambda new, again=again: rebuilt(again(new)))

    yield from walk(whole, type(whole).__name__, False, lambda new: new)


FEW = 4
"""Parts of a tuple that are digested whatever they are."""


def thinned(value: Any, place: str, met: set[tuple[str, type]]) -> Any:
    """The value, of whose long tuples only the first parts are left, and those in which a new record lies.

    So it is digested quickly, hundreds of times; of records in like places one is changed anyway.
    """
    names = fields_of(value)
    if isinstance(value, Mapping):
        return {key: thinned(part, f"{place}[]", met) for key, part in value.items()}
    if isinstance(value, tuple):
        kept = []
        for number, part in enumerate(value):
            before = len(met)
            part = thinned(part, f"{place}[]", met)
            if number < FEW or len(met) > before:
                kept.append(part)
        return tuple(kept)
    if names is not None:
        met.add((place, type(value)))
        for name in names:
            value = with_field(value, name, thinned(getattr(value, name), f"{place}.{name}", met))
    return value


def others(value: Any, hint: Any) -> Iterator[Any]:
    """Other values of a field's type that look valid; none for a record, whose own fields are changed."""
    match value:
        case bool():
            yield not value
        case Enum():
            kinds = list(type(value))
            yield kinds[kinds.index(value) - 1]
        case int():
            yield value + 1
        case float():
            yield value + 1.0 if math.isfinite(value) else 1.0
        case str():
            yield f"{value}x"
        case tuple():
            yield from (value[:-1], (*value, value[-1])) if value else (sample(hint),)
            yield from (with_part(value, 0, other) for first in value[:1] for other in others(first, None))
        case Mapping():
            yield {**value, **sample(hint)}
            first = list(value)[:1]
            yield from (with_part(value, key, other) for key in first for other in others(value[key], None))
        case None:
            yield sample(hint)


def sample(hint: Any) -> Any:
    """Some value of a type that is not None."""
    arguments = [part for part in typing.get_args(hint) if part is not NoneType]
    origin = typing.get_origin(hint) or hint
    if origin is tuple:
        return tuple(sample(part) for part in arguments if part is not Ellipsis)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {sample(arguments[0]): sample(arguments[1])}
    if arguments:
        return sample(arguments[0])
    if isinstance(hint, type) and issubclass(hint, Enum):
        return list(hint)[-1]
    if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
        return hint(**{f.name: sample(f.type) for f in msgspec.structs.fields(hint) if f.required})
    if dataclasses.is_dataclass(hint):
        hints, none = typing.get_type_hints(hint), dataclasses.MISSING
        needed = [f for f in dataclasses.fields(hint) if f.default is none and f.default_factory is none]
        return hint(**{f.name: sample(hints[f.name]) for f in needed})
    return {str: "x", bool: True, int: 1, float: 1.0, Any: 1.0}[hint]


def see_every_field_count(whole: Any, without: Exceptions, key: Callable[[Any], str]) -> set[str]:
    """See that a key changes with every field but the excepted ones; gives the names of the classes met."""
    whole = thinned(whole, type(whole).__name__, set())
    before, seen = key(whole), set()
    for change in changes(whole, without):
        assert (key(change.value) == before) is change.excepted, change.place
        seen.add(change.kind.__name__)
    return seen


def source_of(name: str) -> ProblemSource:
    return read_source(Path(__file__).parents[1] / "problems" / f"{name}.toml")


@cache
def setting_of(name: str) -> PrecomputeSetting:
    return precompute_setting(build_problem(source_of(name)))


def key(scene: Scene) -> str:
    """Of a program in which nobody has a body."""
    return program_key("reach", scene.only())


@pytest.mark.parametrize("problem", ["shared_lifting", "three_people_three_loads"])
def test_every_field_of_a_scene_counts_in_the_key_of_its_programs(problem: str) -> None:
    setting = setting_of(problem)
    scene = setting.middle
    with_all = {kind: names for kind, names in NO_PART_OF_PROGRAMS.items() if kind is not Scene}
    see_every_field_count(scene, NO_PART_OF_PROGRAMS, key)
    seen = see_every_field_count(scene, with_all, lambda s: program_key("joint", s, *s.agents))
    assert {"Scene", "Payload", "Agent", "Tree", "Link", "Joint", "StanceLimits", "Ground"} <= seen
    assert "JointStrength" in seen, "which only people have"


def test_who_has_no_body_in_a_program_counts_by_the_place() -> None:
    scene = setting_of("shared_lifting").scenes[0]
    robot, person = scene.agents
    before = program_key("reach", scene, robot)
    other = scene.with_agents(replace(person, tree=robot.tree))
    aside = scene.with_agents(replace(person, quarters=1))
    assert program_key("reach", other, robot) == before != program_key("reach", aside, robot)


def test_a_field_that_a_key_ignores_is_found() -> None:
    scene = setting_of("shared_lifting").scenes[0]
    without = {kind: names for kind, names in NO_PART_OF_PROGRAMS.items() if kind is not Payload}
    with pytest.raises(AssertionError, match=r"Scene\.payload\.mass: 11\.0"):
        see_every_field_count(scene, without, key)


APART = (Subject.MEETINGS, Subject.POSTURE, Subject.LIFT)
"""One subject of each kind of key where bodies are kept apart."""

FREE = tuple({id(NO_PART_OF[each]): each for each in Subject}.values())
"""One of each kind elsewhere: of those whose keys leave out the same fields."""


@pytest.mark.parametrize(
    ("problem", "subject"),
    [
        *(("shared_lifting", subject) for subject in APART),
        *(("three_people_three_loads", subject) for subject in FREE),
        ("icub_materials", Subject.POSTURE),
    ],
)
def test_every_field_of_a_setting_counts_in_the_key_of_its_pieces(problem: str, subject: Subject) -> None:
    setting = setting_of(problem)
    scene = setting.middle
    without = no_part_of(setting, Piece(subject, scene.pair))
    if subject is Subject.PERSON_REACH:  # of which robots are no part
        scene = scene.only(*scene.people)
    one = replace(setting, scenes=(scene,))

    whole = (one, scene, Piece(subject, scene.pair, Hold(height_m=1.0)))

    def key(whole: tuple[PrecomputeSetting, Scene, Piece]) -> str:
        """The key with the scene before those of the setting, and the piece in it whatever it says."""
        setting, scene, piece = whole
        return key_of(replace(setting, scenes=(scene, *setting.scenes)), replace(piece, pair=scene.pair))

    seen = see_every_field_count(whole, without, key)
    assert {"Piece", "SolverOptions", "EffortWeights", "DesignParameter", "Payload", "Tree"} <= seen
    assert "JointStrength" in seen, "which only people have"


def test_where_bodies_are_kept_apart_keys_of_all_pieces_but_meetings_leave_out_the_same_fields() -> None:
    setting = setting_of("shared_lifting")
    without = {each: no_part_of(setting, Piece(each, setting.middle.pair)) for each in Subject}
    assert without.pop(Subject.MEETINGS) is not without[Subject.POSTURE]
    assert all(each is without[Subject.POSTURE] for each in without.values())


def test_a_piece_is_that_of_its_scene_and_of_symmetric_postures_or_not() -> None:
    setting = setting_of("three_people_three_loads")
    first, last = setting.scenes[0].pair, setting.scenes[-1].pair
    task = Hold(height_m=1.0)
    turned, unlike = replace(setting, scenes=setting.scenes[::-1]), replace(setting, symmetry=Symmetry.OFF)
    for subject in Subject:
        key = key_of(setting, Piece(subject, first, task))
        of_everyone = subject in (Subject.MEETINGS, Subject.LIFT)
        assert (key == key_of(turned, Piece(subject, first, task))) is not of_everyone
        assert key != key_of(setting, Piece(subject, last, task))
        assert key != key_of(unlike, Piece(subject, first, task))


@pytest.mark.parametrize("problem", ["shared_lifting", "three_people_three_loads", "icub_materials"])
def test_every_field_of_a_problem_file_counts_in_the_key_of_its_evaluations(
    problem: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = source_of(problem)
    tables = decode_toml(source.text, source.path, ProblemFile)
    files = {name: text for name, text in source.files.items() if name != tables.search.start}

    def key(whole: tuple[ProblemFile, ProblemSource]) -> str:
        monkeypatch.setattr("evodesign.evaluation.factory.decode_toml", lambda *_: whole[0])
        return problem_digest(whole[1])

    whole = (tables, msgspec.structs.replace(source, files=files))
    seen = see_every_field_count(whole, NO_PART_OF_EVALUATIONS, key)
    assert {"ProblemFile", "PayloadTable", "SolverTable", "BaselineTable", "ProblemSource"} <= seen


def test_the_designs_that_a_search_starts_from_are_no_part_of_evaluations() -> None:
    source = source_of("shared_lifting")
    (start,) = [name for name in source.files if name.endswith(".toml")]
    other = msgspec.structs.replace(source, files={**source.files, start: "other designs"})
    assert problem_digest(other) == problem_digest(source)


def test_where_bodies_are_kept_apart_pieces_follow_from_all_scenes_and_tasks() -> None:
    """What comes near whom is found with everyone's postures, and all that comes later has it."""
    free = setting_of("three_people_three_loads")
    scenes = tuple(
        scene.with_agents(*(replace(each, collisions=CollisionRules(0.005, ())) for each in scene.agents))
        for scene in free.scenes
    )
    setting = replace(free, scenes=scenes, middle=scenes[0])
    fewer, sooner = replace(setting, scenes=scenes[:1]), replace(setting, tasks=setting.tasks[:1])
    for subject in (Subject.PERSON_REACH, Subject.HIGHEST, Subject.LOWEST, Subject.POSTURE):
        piece = Piece(subject, scenes[0].pair, Hold(height_m=1.0))
        assert len({key_of(each, piece) for each in (setting, fewer, sooner)}) == 3
        assert (
            len(
                {
                    key_of(replace(each, middle=free.middle), piece)
                    for each in (free, replace(free, tasks=free.tasks[:1]))
                }
            )
            == 1
        )
