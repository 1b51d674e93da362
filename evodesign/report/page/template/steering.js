// Drag to turn, arrow keys to turn, plus and minus (or the wheel with Ctrl) to come nearer.
const steer = (canvas) => {
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    let [x, y] = [event.clientX, event.clientY];
    const move = (moved) => {
      look(camera.turn - (moved.clientX - x) / 150, camera.tilt + (moved.clientY - y) / 150);
      [x, y] = [moved.clientX, moved.clientY];
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", () => canvas.removeEventListener("pointermove", move), {
      once: true,
    });
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      look(camera.turn, camera.tilt, camera.distance * Math.exp(event.deltaY / 400));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[
      event.key
    ];
    const factor = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
    if (!turns && !factor) return;
    event.preventDefault();
    const [turn, tilt] = turns ?? [0, 0];
    look(camera.turn + turn, camera.tilt + tilt, camera.distance * (factor ?? 1));
  });
};
