// The triangles of the robot's meshes, shared by all designs, in the form of unit shapes.

// Faces that meet at a smaller angle than this belong to one rounded surface, and are shaded as such.
const ROUNDED = Math.cos((40 * Math.PI) / 180);

// Faces around a point that count: a run from elsewhere may have thousands there.
const MOST_AROUND = 64;

const surfaceName = (index) => `surface ${index}`;

const surfaceMeshes = () =>
  Object.fromEntries(
    (content.bodies?.surfaces ?? []).map((surface, index) => [
      surfaceName(index),
      () => cornersOf(...verticesOf(surface)),
    ]),
  );

// Little-endian numbers of 16 bits, in the letters of base64.
const numbersOf = (text) => {
  const letters = atob(text);
  return Array.from(
    { length: letters.length / 2 },
    (_, index) => letters.charCodeAt(2 * index) + 256 * letters.charCodeAt(2 * index + 1),
  );
};

const threes = (numbers) =>
  Array.from({ length: numbers.length / 3 }, (_, index) => numbers.slice(3 * index, 3 * index + 3));

// A surface as points, and triangles as three indices of points.
const verticesOf = ({ low, step, points, triangles }) => [
  threes(numbersOf(points)).map((point) => point.map((steps, axis) => low[axis] + step[axis] * steps)),
  threes(numbersOf(triangles)),
];

// [x, y, z, nx, ny, nz] for each corner: normals are the mean of the faces around that bend little, by area.
const cornersOf = (points, triangles) => {
  const areas = triangles.map(([a, b, c]) =>
    cross(minus(points[b], points[a]), minus(points[c], points[a])),
  );
  const units = areas.map(unit);
  const around = points.map(() => []);
  triangles.forEach((corners, face) => corners.forEach((corner) => around[corner].push(face)));
  return triangles.flatMap((corners, face) =>
    corners.flatMap((corner) => {
      const near = around[corner].slice(0, MOST_AROUND).filter((other) => dot(units[face], units[other]) > ROUNDED);
      const mean = near.reduce((sum, other) => plus(sum, areas[other]), [0, 0, 0]);
      return [...points[corner], ...(length(mean) > 0 ? unit(mean) : units[face])];
    }),
  );
};
