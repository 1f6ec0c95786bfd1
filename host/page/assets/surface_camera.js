// From where surfaces are seen: turned, moved and enlarged with pointers, wheel and keys.

/** Faces of the room around: how to look from them, and which axis leads there. */
const viewFaces = [
  { axis: 1, sign: -1, letter: "A", words: "front", azimuth: 0, elevation: 0 },
  { axis: 1, sign: 1, letter: "P", words: "back", azimuth: Math.PI, elevation: 0 },
  { axis: 0, sign: -1, letter: "R", words: "the patient's right", azimuth: -Math.PI / 2, elevation: 0 },
  { axis: 0, sign: 1, letter: "L", words: "the patient's left", azimuth: Math.PI / 2, elevation: 0 },
  { axis: 2, sign: 1, letter: "S", words: "head", azimuth: 0, elevation: Math.PI / 2 },
  { axis: 2, sign: -1, letter: "I", words: "feet", azimuth: 0, elevation: -Math.PI / 2 },
];

/** The same with the names of axes where there is no patient. */
const axisFaces = viewFaces.map((face) => {
  const letter = (face.sign < 0 ? "−" : "+") + "xyz"[face.axis];
  return { ...face, letter, words: letter };
});

/** A camera that listens to the canvas; `start` has azimuth and elevation. The projection is parallel. */
function makeCamera(canvas, start, redraw) {
  const camera = { reset, lookFrom, axes, zoom: 1, pan: [0, 0] };
  reset();
  listenToPointers();
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomBy(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
  }, { passive: false });
  canvas.addEventListener("dblclick", reset);
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (turns[event.key]) turnBy(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") zoomBy(1.15);
    else if (event.key === "-") zoomBy(1 / 1.15);
    else if (event.key === "Home") reset();
    else return;
    event.preventDefault();
  });
  return camera;

  function reset() {
    Object.assign(camera, { azimuth: start.azimuth, elevation: start.elevation, zoom: 1, pan: [0, 0] });
    redraw();
  }

  function lookFrom({ azimuth, elevation }) {
    Object.assign(camera, { azimuth, elevation });
    redraw();
  }

  function axes() {
    const { azimuth: a, elevation: e } = camera;
    const right = [Math.cos(a), Math.sin(a), 0];
    const up = [Math.sin(e) * -Math.sin(a), Math.sin(e) * Math.cos(a), Math.cos(e)];
    const back = [Math.cos(e) * Math.sin(a), -Math.cos(e) * Math.cos(a), Math.sin(e)];
    return { right, up, back };
  }

  function turnBy(azimuth, elevation) {
    camera.azimuth += azimuth;
    camera.elevation = Math.min(Math.max(camera.elevation + elevation, -Math.PI / 2), Math.PI / 2);
    redraw();
  }

  function zoomBy(factor) {
    camera.zoom = Math.min(Math.max(camera.zoom * factor, 0.3), 20);
    redraw();
  }

  function listenToPointers() {
    const pointers = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
    });
    for (const kind of ["pointerup", "pointercancel"])
      canvas.addEventListener(kind, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const last = pointers.get(event.pointerId);
      if (!last) return;
      const dx = event.clientX - last.clientX, dy = event.clientY - last.clientY;
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
        const gap = (e) => Math.max(Math.hypot(e.clientX - other.clientX, e.clientY - other.clientY), 1);
        zoomBy(gap(event) / gap(last));
      } else if (event.shiftKey || event.buttons & 6) {
        camera.pan = [camera.pan[0] + dx, camera.pan[1] - dy];
        redraw();
      } else {
        turnBy(-dx * 0.008, dy * 0.008);
      }
      pointers.set(event.pointerId, event);
    });
  }
}
