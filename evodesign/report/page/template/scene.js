// From a posture to the solids that the viewer draws.

const NEWTONS_PER_METRE = 1000;

// What is drawn of a case's posture; the load stands at a height [m].
const sceneItems = (design, agents, at, height = at.height) => {
  const items = [];
  let stands = null;
  const solid = (mesh, rotation, position, size, tint, over = false) =>
    items.push({ mesh, model: placed(rotation, position, size), tint, over, stands });
  const neutral = rgb("faint");
  const tints = {
    robot: [rgb("accent"), mixed(rgb("accent"), rgb("surface"), 0.52)],
    person: [mixed(rgb("second"), neutral, 0.35), mixed(rgb("second"), neutral, 0.35)],
  };
  for (const [agent, posture] of Object.entries(agents)) {
    const tree = treeOf(agent, design, at.person);
    const poses = linkPoses(agent, tree, posture);
    const { role, designed } = agentOf(agent);
    if (Object.keys(agents).length > 1) stands = scaled(-1, turned(facing(agent), [1, 0, 0]));
    tree.links.forEach((link, index) => {
      const tint = tints[role][designed && content.bodies.changing.includes(index) ? 0 : 1];
      const { rotation, position } = poses[index];
      for (const mesh of link.meshes ?? [])
        solid(
          surfaceName(mesh.surface),
          times(rotation, mesh.linear),
          plus(position, turned(rotation, mesh.position)),
          [1, 1, 1],
          tint,
        );
      for (const shape of link.shapes) {
        solid(
          shape.kind,
          times(rotation, shape.rotation),
          plus(position, turned(rotation, shape.position)),
          sizeOf(shape),
          tint,
        );
      }
    });
    for (const { at, force } of groundForces(tree, poses, posture)) {
      const long = length(force) / NEWTONS_PER_METRE;
      if (long < 0.005) continue;
      const rotation = fromZ(force);
      const head = Math.min(0.09, 0.5 * long);
      const beside = plus(at, [0, 0, 0.002]);
      solid(
        "cylinder",
        rotation,
        plus(beside, scaled((long - head) / 2, unit(force))),
        [0.013, 0.013, long - head],
        rgb("third"),
        true,
      );
      solid(
        "cone",
        rotation,
        plus(beside, scaled(long - head, unit(force))),
        [0.035, 0.035, head],
        rgb("third"),
        true,
      );
    }
  }
  stands = null;
  solid(
    "box",
    IDENTITY,
    [0, 0, height],
    content.bodies.payloads[at.payload].size_m,
    mixed(rgb("soft"), rgb("surface"), 0.15),
  );
  return items;
};
