// Link poses of an agent from its logged posture.
//
//     world_from_child = world_from_parent  parent_from_child  motion(axis, position)
//
// World frame: under the load, x from the robot to the person, z up. An agent's posture is given in its own
// frame, which looks along +x at the load: the world's turned by quarters about z.

const PAIR = [
  { name: "robot", role: "robot", quarters: 0, designed: true },
  { name: "human", role: "person", quarters: 2, designed: false },
];

// Everybody who holds the load; of a run whose problem is not known, those whom most have.
const everyAgent = () => content.bodies?.agents ?? PAIR;

const agentsHere = () => everyAgent().map(({ name }) => name);

const roleOf = (name) => (name.startsWith("robot") ? "robot" : "person");

const agentOf = (name) =>
  everyAgent().find((one) => one.name === name) ?? { ...PAIR[0], name, role: roleOf(name) };

const hasPeople = () => everyAgent().some(({ role }) => role === "person");

// What an agent is called: by its role, with a number where there are several.
const agentName = (name) => {
  const { role } = agentOf(name);
  const alike = everyAgent().filter((one) => one.role === role);
  const number = alike.length > 1 ? ` ${alike.findIndex((one) => one.name === name) + 1}` : "";
  return `${role === "robot" ? "Robot" : "Person"}${number}`;
};

const QUARTERS = [
  [1, 0],
  [0, 1],
  [-1, 0],
  [0, -1],
];
const facing = (agent) => {
  const [cos, sin] = QUARTERS[agentOf(agent).quarters];
  return [cos, -sin, 0, sin, cos, 0, 0, 0, 1];
};

// An agent's tree: the robot's with what the design changes, or that of somebody beside the person of a name.
const treeOf = (agent, design, human) => {
  if (!agentOf(agent).designed) return content.bodies.others[human][agent];
  const tree = content.bodies.robot;
  return {
    ...tree,
    links: tree.links.map((link, index) => design.links[index] ?? link),
    joints: tree.joints.map((joint, index) => design.joints[index] ?? joint),
  };
};

const linkPoses = (agent, tree, posture) => {
  const poses = new Array(tree.links.length);
  const children = new Set(tree.joints.map((joint) => joint.child));
  const base = tree.links.findIndex((_, index) => !children.has(index));
  const turn = facing(agent);
  poses[base] = {
    rotation: times(turn, fromAngles(posture.base_rpy_rad)),
    position: turned(turn, posture.base_position_m),
  };
  for (const joint of tree.joints)
    poses[joint.child] = childPose(poses[joint.parent], joint, posture.joints_rad[joint.name] ?? 0);
  return poses;
};

const childPose = (parent, joint, moved) => {
  const rotation = times(parent.rotation, joint.rotation);
  const position = plus(parent.position, turned(parent.rotation, joint.position));
  if (joint.kind === "fixed") return { rotation, position };
  if (joint.kind === "prismatic")
    return { rotation, position: plus(position, turned(rotation, scaled(moved, joint.axis))) };
  return { rotation: times(rotation, aboutAxis(joint.axis, moved)), position };
};

// Between two postures: every joint and base coordinate on its way.
const between = (from, to, share) => {
  const mix = (a, b) => a + share * (b - a);
  const named = (a, b) =>
    Object.fromEntries(Object.entries(b).map(([name, value]) => [name, mix(a[name] ?? value, value)]));
  return {
    ...to,
    base_position_m: to.base_position_m.map((value, index) => mix(from.base_position_m[index], value)),
    base_rpy_rad: to.base_rpy_rad.map((value, index) => mix(from.base_rpy_rad[index], value)),
    joints_rad: named(from.joints_rad, to.joints_rad),
  };
};

// Centre of pressure (-m_y, m_x) / f_z in a sole; nothing where the ground does not push.
const centreOfPressure = ([, , fz, mx, my]) => (fz > 1e-6 ? [-my / fz, mx / fz, 0] : null);

// Force of the ground on a foot, at its centre of pressure, in the world.
const groundForces = (tree, poses, posture) =>
  Object.entries(tree.soles).map(([contact, sole]) => {
    const wrench = posture.wrenches[contact];
    const pressure = centreOfPressure(wrench) ?? [0, 0, 0];
    const { rotation, position } = poses[sole];
    return { at: plus(position, turned(rotation, pressure)), force: turned(rotation, wrench.slice(0, 3)) };
  });
