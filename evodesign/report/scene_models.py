"""A posture on its stage: every link of robot and person, the load and the contact wrenches, in the world.

World frame: origin on the ground under the load, x from the robot towards the person, z up. A logged posture
is in its agent's own frame, which looks along +x at the load: the world turned about z by `Agent.facing`.

A foot's wrench is drawn where its moment about x and y vanishes, at the centre of pressure of the sole,

    CoP = (-m_y, m_x) / f_z        m' = (0, 0, m_z + CoP_y f_x - CoP_x f_y)

Source: Sartore et al. 2022, Section III-D (centre of pressure).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from evodesign.body.placement import Placement, Vector, rotate
from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.errors import RunError, on_one_line
from evodesign.mechanics.agent import HUMAN, ROBOT, Agent, Role
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.records import AgentDetail, CaseDetail, Task
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Link, Mesh, Tree

LOAD = "load"
"""Name of the load beside those of the agents."""

LEAST_FORCE = 1e-6
"""A foot with less normal force [N] has no centre of pressure."""


@dataclass(frozen=True, slots=True)
class SceneModels:
    """Who stands on the stage of a design.

    Args:
        agents: as the problem names them.
        trees: their trees of numbers by agent name, that of the design for robots that it changes.
        payload: the load.
    """

    agents: tuple[Agent, ...]
    trees: Mapping[str, Tree]
    payload: Payload

    @classmethod
    def of(cls, scene: Scene, robot_tree: Tree) -> SceneModels:
        """The models of a scene with the robot of a design."""
        trees = {each.name: robot_tree if each.designed else each.tree for each in scene.agents}
        return cls(scene.agents, trees, scene.payload)

    @property
    def pair(self) -> tuple[str, str]:
        """Names of people and load, each empty where there is one."""
        return " and ".join(each.label for each in self.people if each.label), self.payload.label

    @property
    def people(self) -> tuple[Agent, ...]:
        """The agents that are people."""
        return tuple(agent for agent in self.agents if agent.role is Role.PERSON)

    @property
    def label(self) -> str:
        """Who holds what, where there are several people or loads."""
        return ", ".join(name for name in self.pair if name)

    def agent(self, name: str) -> Agent:
        """The agent of a name."""
        return next(agent for agent in self.agents if agent.name == name)

    def kind(self, name: str) -> str:
        """What has a name: `ROBOT`, `HUMAN` or `LOAD`."""
        return LOAD if name == LOAD else ROBOT if self.agent(name).role is Role.ROBOT else HUMAN


@dataclass(frozen=True, slots=True)
class ContactWrench:
    """What a contact does to an agent, in the world.

    Args:
        agent: its name.
        contact: such as `left_foot`.
        point: where the force acts [m].
        force: [N].
        moment: about the point [N m].
        by_ground: whether the ground acts, and not the load.
    """

    agent: str
    contact: str
    point: Vector
    force: Vector
    moment: Vector
    by_ground: bool


@dataclass(frozen=True, slots=True)
class PlacedScene:
    """One moment of a task: where everything is.

    Args:
        task: that it belongs to.
        time: since the task began [s].
        place: what it is called: the load's height, and in a lift the time.
        models: robot, person and load.
        frames: world_from_link by agent and link name.
        world_from_load: of the load's box.
        wrenches: on robot and person.
    """

    task: Task
    time: float
    place: str
    models: SceneModels
    frames: Mapping[str, Mapping[str, Placement]]
    world_from_load: Placement
    wrenches: tuple[ContactWrench, ...]

    @property
    def solids(self) -> tuple[tuple[str, Shape, Placement], ...]:
        """Every shape that is seen: whose it is, its form, and its place in the world."""
        seen = [
            (name, shape, self.frames[name][link.name] @ place)
            for name, tree in self.models.trees.items()
            for link in tree.links
            for shape, place in looks_of(link)
        ]
        return (*seen, (LOAD, Box(*self.models.payload.size), self.world_from_load))

    @property
    def meshes(self) -> tuple[tuple[str, Mesh, Placement], ...]:
        """Every mesh that is seen: whose it is, its triangles, and world_from_link."""
        return tuple(
            (name, mesh, self.frames[name][link.name])
            for name, tree in self.models.trees.items()
            for link in tree.links
            for mesh in link.shown
        )


def looks_of(link: Link) -> tuple[tuple[Shape, Placement], ...]:
    """The shapes that show a link, with their places in it; none where meshes show it.

    Those are solids, looks and the housings of actuators; balls of actuators that are no bodies are not seen.
    """
    if link.shown:
        return ()
    housings = (solid for solid in link.mounted if isinstance(solid.shape, Cylinder))
    solids = [(solid.shape, solid.link_from_solid) for solid in (*link.solids, *housings)]
    return (*solids, *((look.shape, look.link_from_look) for look in link.looks))


def placed_scene(models: SceneModels, detail: CaseDetail) -> PlacedScene:
    """The stage of a logged posture of one instant."""
    frames: dict[str, Mapping[str, Placement]] = {}
    wrenches: list[ContactWrench] = []
    for agent in models.agents:
        posture = detail.agents[agent.name]
        world_from_agent = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, agent.facing))
        base = Placement.from_xyz_rpy(posture.base_position_m, posture.base_rpy_rad)
        placed = link_frames(models.trees[agent.name], world_from_agent @ base, posture.joints_rad)
        frames[agent.name] = placed
        wrenches += _wrenches(agent, posture, world_from_agent, placed)
    load = Placement(translation=(0.0, 0.0, detail.height_m))
    return PlacedScene(detail.case.task, detail.time_s, detail.place, models, frames, load, tuple(wrenches))


def _wrenches(
    agent: Agent, posture: AgentDetail, world_from_agent: Placement, frames: Mapping[str, Placement]
) -> list[ContactWrench]:
    found = []
    for hand in agent.hands:
        force, moment = _halves(posture.wrenches[hand.name])
        turned = (rotate(world_from_agent.rotation, force), rotate(world_from_agent.rotation, moment))
        found.append(ContactWrench(agent.name, hand.name, frames[hand.frame].translation, *turned, False))
    for foot in agent.feet:
        sole = frames[foot.frame]
        point, force, moment = _at_center_of_pressure(*_halves(posture.wrenches[foot.name]))
        turned = (rotate(sole.rotation, force), rotate(sole.rotation, moment))
        found.append(ContactWrench(agent.name, foot.name, sole.apply(point), *turned, True))
    return found


def _at_center_of_pressure(force: Vector, moment: Vector) -> tuple[Vector, Vector, Vector]:
    """A sole's wrench about its origin as point, force and moment about that point, in the sole frame."""
    if force[2] < LEAST_FORCE:
        return (0.0, 0.0, 0.0), force, moment
    x, y = -moment[1] / force[2], moment[0] / force[2]
    return (x, y, 0.0), force, (0.0, 0.0, moment[2] + y * force[0] - x * force[1])


def _halves(wrench: Sequence[float]) -> tuple[Vector, Vector]:
    return (wrench[0], wrench[1], wrench[2]), (wrench[3], wrench[4], wrench[5])


@dataclass(frozen=True, slots=True)
class SceneSet:
    """Everyone who holds a load with the robot of a design.

    Args:
        casts: every person with every load, all of them with the same robot; at least one.
    """

    models: tuple[SceneModels, ...]

    @classmethod
    def of(cls, scenes: Sequence[Scene], robot_tree: Tree) -> SceneSet:
        """The casts of scenes with the robot of a design."""
        return cls(tuple(SceneModels.of(scene, robot_tree) for scene in scenes))

    @property
    def robot(self) -> Tree:
        """The design's robot."""
        return self.models[0].trees[ROBOT]

    @property
    def robots(self) -> tuple[tuple[str, Tree], ...]:
        """Each robot's name, with the tree of numbers."""
        models = self.models[0]
        named = (each.name for each in models.agents if each.role is Role.ROBOT)
        return tuple((name, models.trees[name]) for name in named)

    @property
    def people(self) -> tuple[tuple[Agent, Tree], ...]:
        """Each person once, with the tree of numbers, in the problem's order."""
        found = {
            person.label: (person, models.trees[person.name])
            for models in self.models
            for person in models.people
        }
        return tuple(found.values())

    @property
    def others_files(self) -> dict[str, tuple[str, Tree]]:
        """By file name: label and tree of everyone whom designs do not change.

        Several people are numbered, whatever their labels.
        """
        models = self.models[0]
        robots = [each for each in models.agents if each.role is Role.ROBOT and not each.designed]
        found = {f"{each.name}.urdf": (each.name, models.trees[each.name]) for each in robots}
        for number, (person, tree) in enumerate(self.people, 1):
            suffix = f"_{number}" if len(self.people) > 1 else ""
            found[f"human{suffix}.urdf"] = person.label, tree
        return found

    def models_of(self, detail: CaseDetail) -> SceneModels:
        """Who stands there in a logged case.

        Raises:
            RunError: the run's problem has not its person, load or joints.
        """
        models = next((models for models in self.models if models.pair == detail.case.pair), None)
        if (
            models is None
            or detail.agents.keys() != models.trees.keys()
            or not all(
                posture.torques_n_m.keys()
                == posture.joints_rad.keys()
                <= models.trees[name].joint_by_name.keys()
                and posture.wrenches.keys() == {each.name for each in models.agent(name).contacts}
                for name, posture in detail.agents.items()
            )
        ):
            case = on_one_line(detail.case.name)
            raise RunError(f"the logged postures of case '{case}' are not those of the run's problem")
        return models

    def placed_scene(self, detail: CaseDetail) -> PlacedScene:
        """The stage of a logged case at its only instant."""
        return placed_scene(self.models_of(detail), detail)
