// What the graphics card computes: plain shading (mode 0), the ground's grid (1), flat shadows (2).

const VERTEX = `#version 300 es
in vec3 at; in vec3 normal;
uniform mat4 model, camera;
out vec3 outward; out vec3 place;
void main() {
  vec4 world = model * vec4(at, 1.0);
  outward = transpose(inverse(mat3(model))) * normal;
  place = world.xyz;
  gl_Position = camera * world;
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 outward; in vec3 place;
uniform vec4 tint; uniform vec3 light, eye, surface, line; uniform int mode;
out vec4 result;
float grid(vec2 p, float step) {
  vec2 cell = abs(fract(p / step - 0.5) - 0.5) * step / fwidth(p);
  return 1.0 - min(min(cell.x, cell.y), 1.0);
}
void main() {
  if (mode == 1) {
    float fade = 1.0 - smoothstep(0.8, 2.3, length(place.xy));
    result = vec4(line, 1.0) * grid(place.xy, 0.25) * fade;
    return;
  }
  if (mode == 2) { result = tint; return; }
  vec3 n = normalize(outward);
  vec3 view = normalize(eye - place);
  if (dot(n, view) < 0.0) n = -n; // a sheet seen from behind
  float sky = 0.5 + 0.5 * n.z;
  float sun = max(dot(n, light), 0.0);
  float rim = pow(1.0 - max(dot(n, view), 0.0), 3.0);
  vec3 shaded = tint.rgb * (0.50 + 0.22 * sky + 0.42 * sun) - 0.10 * rim;
  result = vec4(shaded, 1.0) * tint.a;
}`;
