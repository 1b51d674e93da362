// A small WebGL view of robot, person, load and the ground's forces.

const LIGHT = unit([0.35, -0.5, 1]);

const compiled = (gl) => {
  const program = gl.createProgram();
  for (const [kind, source] of [
    [gl.VERTEX_SHADER, VERTEX],
    [gl.FRAGMENT_SHADER, FRAGMENT],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
};

const loadedMeshes = (gl, program) =>
  Object.fromEntries(
    Object.entries({ ...MESHES, ...surfaceMeshes() }).map(([name, make]) => {
      const corners = new Float32Array(make());
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
      for (const [attribute, offset] of [
        ["at", 0],
        ["normal", 12],
      ]) {
        const place = gl.getAttribLocation(program, attribute);
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 24, offset);
      }
      return [name, { array, count: corners.length / 6 }];
    }),
  );

// From the front, whoever stands before the camera is seen through.
const VIEWS = {
  Oblique: [-2.15, 0.2],
  Side: [-Math.PI / 2, 0.04],
  ...(hasPeople() ? { "Robot's front": [0, 0.04], "Person's front": [-Math.PI, 0.04] } : { Front: [0, 0.04] }),
};
const SEEN_THROUGH = 0.16;
const BEFORE_CAMERA = 0.85; // cosine of the angle between the camera and where an agent stands

// Where the camera of all views stands: angles [rad] and distance [m].
const camera = { turn: VIEWS["Oblique"][0], tilt: VIEWS["Oblique"][1], distance: 5.7 };
const viewers = [];

const look = (turn, tilt, distance = camera.distance) => {
  camera.turn = turn;
  camera.tilt = Math.min(1.5, Math.max(-0.05, tilt));
  camera.distance = Math.min(12, Math.max(1.5, distance));
  viewers.forEach((viewer) => viewer.draw());
  tell("view");
};

class Viewer {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", {
      antialias: true,
      stencil: true,
      alpha: true,
      premultipliedAlpha: true,
      preserveDrawingBuffer: true,
    });
    this.program = compiled(this.gl);
    this.meshes = loadedMeshes(this.gl, this.program);
    this.places = {};
    this.middle = 0.9;
    this.items = [];
    viewers.push(this);
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // items: [{ mesh, model, tint, over, stands }], `over`: drawn over everything else, without a shadow;
  // `stands`: on which side of the load, of what is seen through where it hides others
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
    const eye = plus(
      target,
      scaled(camera.distance, [
        Math.cos(camera.tilt) * Math.cos(camera.turn),
        Math.cos(camera.tilt) * Math.sin(camera.turn),
        Math.sin(camera.tilt),
      ]),
    );
    const projection = times4(perspective(0.44, canvas.width / canvas.height, 0.1, 40), lookAt(eye, target));
    gl.uniformMatrix4fv(this.place("camera"), false, projection);
    gl.uniform3fv(this.place("eye"), eye);
    gl.uniform3fv(this.place("light"), LIGHT);
    gl.uniform3fv(this.place("line"), rgb("faint"));
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.disable(gl.DEPTH_TEST);
    this.mesh("ground", placed(IDENTITY, [0, 0, 0], [2.4, 2.4, 1]), [0, 0, 0, 0], 1);
    if (camera.tilt > 0) this.shadows();
    gl.enable(gl.DEPTH_TEST);
    const way = [Math.cos(camera.turn), Math.sin(camera.turn)];
    const hides = ({ stands }) => stands && stands[0] * way[0] + stands[1] * way[1] > BEFORE_CAMERA;
    const solid = this.items.filter(({ over }) => !over);
    const draw = (items, opacity = 1) => items.forEach((item) => this.mesh(item.mesh, item.model, [...item.tint, opacity], 0));
    draw(solid.filter((item) => !hides(item)));
    draw(solid.filter(hides), SEEN_THROUGH);
    gl.clear(gl.DEPTH_BUFFER_BIT); // arrows stand inside the legs and are seen through them
    draw(this.items.filter((item) => item.over && !hides(item)));
  }

  // Every solid flattened onto the ground along the light; the stencil keeps shadows from adding up.
  shadows() {
    const { gl } = this;
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    const flat = new Float32Array([
      1,
      0,
      0,
      0,
      0,
      1,
      0,
      0,
      -LIGHT[0] / LIGHT[2],
      -LIGHT[1] / LIGHT[2],
      0,
      0,
      0,
      0,
      0,
      1,
    ]);
    for (const item of this.items) {
      if (!item.over) this.mesh(item.mesh, times4(flat, item.model), [0, 0, 0, 0.13], 2);
    }
    gl.disable(gl.STENCIL_TEST);
  }

  mesh(name, model, tint, mode) {
    const { gl } = this;
    const { array, count } = this.meshes[name];
    gl.uniformMatrix4fv(this.place("model"), false, model);
    gl.uniform4fv(this.place("tint"), tint);
    gl.uniform1i(this.place("mode"), mode);
    gl.bindVertexArray(array);
    gl.drawArrays(gl.TRIANGLES, 0, count);
  }
}
