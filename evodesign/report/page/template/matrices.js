// Small linear algebra: 3 x 3 matrices as nine numbers in rows, 4 x 4 ones in columns as WebGL takes them.

const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1];

const times = (a, b) => {
  const product = new Array(9);
  for (let row = 0; row < 3; row += 1) {
    for (let column = 0; column < 3; column += 1) {
      product[3 * row + column] =
        a[3 * row] * b[column] + a[3 * row + 1] * b[3 + column] + a[3 * row + 2] * b[6 + column];
    }
  }
  return product;
};

const turned = (matrix, [x, y, z]) => [
  matrix[0] * x + matrix[1] * y + matrix[2] * z,
  matrix[3] * x + matrix[4] * y + matrix[5] * z,
  matrix[6] * x + matrix[7] * y + matrix[8] * z,
];

const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (factor, a) => [factor * a[0], factor * a[1], factor * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scaled(1 / (length(a) || 1), a);

// Rotation by an angle [rad] about a unit vector (Rodrigues).
const aboutAxis = ([x, y, z], angle) => {
  const [s, c] = [Math.sin(angle), Math.cos(angle)];
  const v = 1 - c;
  return [
    c + x * x * v,
    x * y * v - z * s,
    x * z * v + y * s,
    y * x * v + z * s,
    c + y * y * v,
    y * z * v - x * s,
    z * x * v - y * s,
    z * y * v + x * s,
    c + z * z * v,
  ];
};

// Rz(yaw) Ry(pitch) Rx(roll) [rad].
const fromAngles = ([roll, pitch, yaw]) =>
  times(times(aboutAxis([0, 0, 1], yaw), aboutAxis([0, 1, 0], pitch)), aboutAxis([1, 0, 0], roll));

// A rotation that takes z to a direction.
const fromZ = (direction) => {
  const z = unit(direction);
  const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z));
  const y = cross(z, x);
  return [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
};

const times4 = (a, b) => {
  const product = new Float32Array(16);
  for (let column = 0; column < 4; column += 1) {
    for (let row = 0; row < 4; row += 1) {
      let sum = 0;
      for (let k = 0; k < 4; k += 1) sum += a[4 * k + row] * b[4 * column + k];
      product[4 * column + row] = sum;
    }
  }
  return product;
};

// rotation * diagonal(size), then a translation.
const placed = (rotation, position, size) =>
  new Float32Array([
    rotation[0] * size[0],
    rotation[3] * size[0],
    rotation[6] * size[0],
    0,
    rotation[1] * size[1],
    rotation[4] * size[1],
    rotation[7] * size[1],
    0,
    rotation[2] * size[2],
    rotation[5] * size[2],
    rotation[8] * size[2],
    0,
    position[0],
    position[1],
    position[2],
    1,
  ]);

const perspective = (angle, ratio, near, far) => {
  const f = 1 / Math.tan(angle / 2);
  const depth = near - far;
  return new Float32Array([
    f / ratio,
    0,
    0,
    0,
    0,
    f,
    0,
    0,
    0,
    0,
    (far + near) / depth,
    -1,
    0,
    0,
    (2 * far * near) / depth,
    0,
  ]);
};

const lookAt = (eye, target) => {
  const back = unit(minus(eye, target));
  const right = unit(cross([0, 0, 1], back));
  const up = cross(back, right);
  return new Float32Array([
    right[0],
    up[0],
    back[0],
    0,
    right[1],
    up[1],
    back[1],
    0,
    right[2],
    up[2],
    back[2],
    0,
    -dot(right, eye),
    -dot(up, eye),
    -dot(back, eye),
    1,
  ]);
};
