// A small WebGL view of robot, person, load and the ground's forces.

const NEWTONS_PER_METRE = 1000;
const LIGHT = unit([0.35, -0.5, 1]);

const VERTEX = `#version 300 es
in vec3 at; in vec3 normal;
uniform mat4 model, camera; uniform vec3 scale;
out vec3 outward; out vec3 place;
void main() {
  vec4 world = model * vec4(at, 1.0);
  outward = mat3(model) * (normal / (scale * scale));
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
  float sky = 0.5 + 0.5 * n.z;
  float sun = max(dot(n, light), 0.0);
  float rim = pow(1.0 - max(dot(n, view), 0.0), 3.0);
  vec3 shaded = tint.rgb * (0.50 + 0.22 * sky + 0.42 * sun) - 0.10 * rim;
  result = vec4(shaded, 1.0);
}`;

const compiled = (gl) => {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
};

const loadedMeshes = (gl, program) => Object.fromEntries(Object.entries(MESHES).map(([name, make]) => {
  const corners = new Float32Array(make());
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
  for (const [attribute, offset] of [["at", 0], ["normal", 12]]) {
    const place = gl.getAttribLocation(program, attribute);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 24, offset);
  }
  return [name, { array, count: corners.length / 6 }];
}));

const rgb = (name) => {
  const hex = colour(name).slice(1);
  return [0, 2, 4].map((start) => parseInt(hex.slice(start, start + 2), 16) / 255);
};

const mixed = (a, b, share) => a.map((value, index) => value + share * (b[index] - value));

const VIEWS = { "Oblique": [-2.15, 0.2], "Side": [-Math.PI / 2, 0.04], "Behind robot": [-Math.PI, 0.12] };

class Viewer {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: true, premultipliedAlpha: true, preserveDrawingBuffer: true });
    this.program = compiled(this.gl);
    this.meshes = loadedMeshes(this.gl, this.program);
    this.places = {};
    [this.turn, this.tilt] = VIEWS["Oblique"];
    this.distance = 5.7;
    this.middle = 0.9;
    this.items = [];
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // items: [{ mesh, model, size, tint, over }], `over`: drawn over everything else, without a shadow
  show(items) {
    this.items = items;
    this.draw();
  }

  place(name) {
    if (!(name in this.places)) this.places[name] = this.gl.getUniformLocation(this.program, name);
    return this.places[name];
  }

  draw() {
    const { gl, canvas } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.useProgram(this.program);
    const target = [0, 0, this.middle];
    const eye = plus(target, scaled(this.distance, [Math.cos(this.tilt) * Math.cos(this.turn), Math.cos(this.tilt) * Math.sin(this.turn), Math.sin(this.tilt)]));
    const camera = times4(perspective(0.44, canvas.width / canvas.height, 0.1, 40), lookAt(eye, target));
    gl.uniformMatrix4fv(this.place("camera"), false, camera);
    gl.uniform3fv(this.place("eye"), eye);
    gl.uniform3fv(this.place("light"), LIGHT);
    gl.uniform3fv(this.place("line"), rgb("faint"));
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.disable(gl.DEPTH_TEST);
    this.mesh("ground", placed(IDENTITY, [0, 0, 0], [2.4, 2.4, 1]), [2.4, 2.4, 1], [0, 0, 0, 0], 1);
    if (this.tilt > 0) this.shadows();
    gl.enable(gl.DEPTH_TEST);
    for (const item of this.items.filter(({ over }) => !over)) this.mesh(item.mesh, item.model, item.size, [...item.tint, 1], 0);
    gl.clear(gl.DEPTH_BUFFER_BIT); // arrows stand inside the legs and are seen through them
    for (const item of this.items.filter(({ over }) => over)) this.mesh(item.mesh, item.model, item.size, [...item.tint, 1], 0);
  }

  // Every solid flattened onto the ground along the light; the stencil keeps shadows from adding up.
  shadows() {
    const { gl } = this;
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    const flat = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, -LIGHT[0] / LIGHT[2], -LIGHT[1] / LIGHT[2], 0, 0, 0, 0, 0, 1]);
    for (const item of this.items) {
      if (!item.over) this.mesh(item.mesh, times4(flat, item.model), item.size, [0, 0, 0, 0.13], 2);
    }
    gl.disable(gl.STENCIL_TEST);
  }

  mesh(name, model, size, tint, mode) {
    const { gl } = this;
    const { array, count } = this.meshes[name];
    gl.uniformMatrix4fv(this.place("model"), false, model);
    gl.uniform3fv(this.place("scale"), size);
    gl.uniform4fv(this.place("tint"), tint);
    gl.uniform1i(this.place("mode"), mode);
    gl.bindVertexArray(array);
    gl.drawArrays(gl.TRIANGLES, 0, count);
  }

  look(turn, tilt) {
    this.turn = turn;
    this.tilt = Math.min(1.5, Math.max(-0.05, tilt));
    this.draw();
  }

  zoom(factor) {
    this.distance = Math.min(12, Math.max(1.5, this.distance * factor));
    this.draw();
  }
}

// Drag to turn, arrow keys to turn, plus and minus (or the wheel with Ctrl) to come nearer.
const steer = (viewer) => {
  const { canvas } = viewer;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    let [x, y] = [event.clientX, event.clientY];
    const move = (moved) => {
      viewer.look(viewer.turn - (moved.clientX - x) / 150, viewer.tilt + (moved.clientY - y) / 150);
      [x, y] = [moved.clientX, moved.clientY];
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", () => canvas.removeEventListener("pointermove", move), { once: true });
  });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    viewer.zoom(Math.exp(event.deltaY / 400));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    const factor = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
    if (!turns && !factor) return;
    event.preventDefault();
    if (turns) viewer.look(viewer.turn + turns[0], viewer.tilt + turns[1]);
    else viewer.zoom(factor);
  });
};

// What is drawn of a posture at a load height [m].
const sceneItems = (design, agents, height) => {
  const items = [];
  const solid = (mesh, rotation, position, size, tint, over = false) => items.push({ mesh, model: placed(rotation, position, size), size, tint, over });
  const neutral = rgb("faint");
  const tints = { robot: [rgb("accent"), mixed(rgb("accent"), rgb("surface"), 0.52)], human: [mixed(rgb("second"), neutral, 0.35), mixed(rgb("second"), neutral, 0.35)] };
  for (const [agent, posture] of Object.entries(agents)) {
    const tree = treeOf(agent, design);
    const poses = linkPoses(agent, tree, posture);
    tree.links.forEach((link, index) => {
      const tint = tints[agent][agent === "robot" && !content.bodies.changing.includes(index) ? 1 : 0];
      for (const shape of link.shapes) {
        const { rotation, position } = poses[index];
        solid(shape.kind, times(rotation, shape.rotation), plus(position, turned(rotation, shape.position)), sizeOf(shape), tint);
      }
    });
    for (const { at, force } of groundForces(tree, poses, posture)) {
      const long = length(force) / NEWTONS_PER_METRE;
      if (long < 0.005) continue;
      const rotation = fromZ(force);
      const head = Math.min(0.09, 0.5 * long);
      const beside = plus(at, [0, 0, 0.002]);
      solid("cylinder", rotation, plus(beside, scaled((long - head) / 2, unit(force))), [0.013, 0.013, long - head], rgb("third"), true);
      solid("cone", rotation, plus(beside, scaled(long - head, unit(force))), [0.035, 0.035, head], rgb("third"), true);
    }
  }
  solid("box", IDENTITY, [0, 0, height], content.bodies.payload_size_m, mixed(rgb("soft"), rgb("surface"), 0.15));
  return items;
};
