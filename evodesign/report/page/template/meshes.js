// Unit shapes as triangles with normals: [x, y, z, nx, ny, nz] for each corner.

const RINGS = 32;

const boxMesh = () => {
  const corners = [];
  for (let axis = 0; axis < 3; axis += 1) {
    for (const side of [-1, 1]) {
      const normal = [0, 0, 0];
      normal[axis] = side;
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const corner = (a, b) => {
        const p = [0, 0, 0];
        p[axis] = side / 2;
        p[u] = a / 2;
        p[v] = (b * side) / 2;
        return [...p, ...normal];
      };
      for (const [a, b] of [
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, -1],
        [1, 1],
        [-1, 1],
      ])
        corners.push(...corner(a, b));
    }
  }
  return corners;
};

// A surface of revolution about z: `profile` lists [radius, z, normal radius, normal z] from below.
const revolved = (profile) => {
  const corners = [];
  const corner = ([r, z, nr, nz], turn) => {
    const angle = (2 * Math.PI * turn) / RINGS;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [r * c, r * s, z, nr * c, nr * s, nz];
  };
  for (let i = 0; i + 1 < profile.length; i += 1) {
    for (let k = 0; k < RINGS; k += 1) {
      const [a, b, c, d] = [
        corner(profile[i], k),
        corner(profile[i], k + 1),
        corner(profile[i + 1], k + 1),
        corner(profile[i + 1], k),
      ];
      corners.push(...a, ...b, ...c, ...a, ...c, ...d);
    }
  }
  return corners;
};

const cylinderMesh = () =>
  revolved([
    [0, -0.5, 0, -1],
    [1, -0.5, 0, -1],
    [1, -0.5, 1, 0],
    [1, 0.5, 1, 0],
    [1, 0.5, 0, 1],
    [0, 0.5, 0, 1],
  ]);

const sphereMesh = () => {
  const profile = [];
  for (let i = 0; i <= RINGS / 2; i += 1) {
    const angle = (Math.PI * i) / (RINGS / 2) - Math.PI / 2;
    profile.push([Math.cos(angle), Math.sin(angle), Math.cos(angle), Math.sin(angle)]);
  }
  return revolved(profile);
};

const coneMesh = () =>
  revolved([
    [0, 0, 0, -1],
    [1, 0, 0, -1],
    [1, 0, 0.8, 0.6],
    [0, 1, 0.8, 0.6],
  ]);

const groundMesh = () =>
  [
    [-1, -1],
    [1, -1],
    [1, 1],
    [-1, -1],
    [1, 1],
    [-1, 1],
  ].flatMap(([x, y]) => [x, y, 0, 0, 0, 1]);

const MESHES = {
  box: boxMesh,
  cylinder: cylinderMesh,
  sphere: sphereMesh,
  cone: coneMesh,
  ground: groundMesh,
};

// Scale of the unit mesh for a shape's size.
const sizeOf = (shape) => {
  if (shape.kind === "box") return shape.size;
  if (shape.kind === "cylinder") return [shape.size[0], shape.size[0], shape.size[1]];
  return [shape.size[0], shape.size[0], shape.size[0]];
};
