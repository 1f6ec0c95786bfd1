// The viewer of surfaces that deform: its controls, titles and colour scale. What it shows stands as JSON
// inside its element; the canvas is drawn by surface_renderer.js as surface_camera.js looks at it.

const decoded = new WeakMap();

/** What a viewer's element shows: the view, and its surfaces unpacked. */
function surfaceViewOf(root) {
  if (!decoded.has(root)) {
    const view = JSON.parse(root.querySelector("script").textContent);
    decoded.set(root, { view, surfaces: view.surfaces.map((s) => unpackSurface(s, view)) });
  }
  return decoded.get(root);
}

/** Starts all viewers of the page; returns the functions that draw them anew. */
function startSurfaceViewers() {
  const started = [...document.querySelectorAll(".surface-viewer")].map(startSurfaceViewer);
  document.documentElement.dataset.webgl = started.length && started.every(Boolean) ? "yes" : "no";
  return started.filter(Boolean);
}

/** Starts a viewer; returns the function that draws it anew, or null where there is no WebGL. */
function startSurfaceViewer(root) {
  const { view, surfaces } = surfaceViewOf(root);
  const caption = root.querySelector(".caption");
  const canvas = element("canvas", { tabIndex: 0, className: "space" }), overlay = element("canvas", {});
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", view.label +
    "; drag to turn, arrow keys turn, plus and minus zoom, home goes back");
  overlay.setAttribute("aria-hidden", "true");
  const stage = element("div", { className: "stage" }, canvas, overlay);
  const renderer = makeSurfaceRenderer(canvas, view, surfaces);
  if (!renderer) {
    caption.replaceWith(element("p", { className: "notice no-webgl", textContent:
      "This browser offers no WebGL, so the surfaces cannot be turned here. " + view.without_webgl }));
    return null;
  }
  const last = view.states.length - 1, isTwo = last === 1;
  const look = {
    field: view.fields.length ? 0 : -1, range: 1, outline: "glass", mesh: false, factor: view.factor,
  };
  let at = view.first, pending = false, playing = 0;
  const camera = makeCamera(canvas, view, redraw), firstAxes = camera.axes();
  const faces = view.patient ? viewFaces : axisFaces;
  const bar = element("div", { className: "colourbar" });
  const range = element("select", {}), rangeLabel = labelled("Range", range);
  const slider = element("input", { type: "range", min: 0, max: isTwo ? 100 : last, step: 1 });
  const moment = element("output", {});

  caption.before(makeControls(), stage, makeLowerControls(), bar);
  chooseField();
  showState();
  return redraw;

  // ------------------------------------------------------------------ drawing

  /** Rest and the chosen state side by side if the view wants both and there is room, else one. */
  function panes() {
    const width = stage.clientWidth, height = stage.clientHeight;
    if (!view.beside || width < 560) return [{ x: 0, width, height, at }];
    return [{ x: 0, width: width / 2, height, at: 0 }, { x: width / 2, width: width / 2, height, at }];
  }

  function redraw() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => { pending = false; draw(); });
  }

  function draw() {
    if (!stage.clientWidth) return;
    fitCanvas(canvas, stage.clientWidth, stage.clientHeight);
    fitCanvas(overlay, stage.clientWidth, stage.clientHeight);
    const list = panes();
    look.pixelsPerMm = camera.zoom * fittingScale(list[0]);
    renderer.draw(list, camera, look);
    drawOverlay(list);
  }

  /** CSS pixels a mm at which the surfaces fill a pane as they are first seen, and as they are turned. */
  function fittingScale({ width, height }) {
    const turned = 0.62 * Math.min(width, height) / view.radius_mm;
    if (view.beside) return turned;
    const reach = (axis) => Math.max(axis.reduce((sum, a, k) => sum + Math.abs(a) * view.half_mm[k], 0), 1e-3);
    return Math.min(0.42 * width / reach(firstAxes.right), 0.4 * height / reach(firstAxes.up), 1.8 * turned);
  }

  /** Titles, a cross of directions, and a scale bar (the projection is parallel). */
  function drawOverlay(list) {
    const context = overlay.getContext("2d");
    const ratio = overlay.width / stage.clientWidth;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, stage.clientWidth, stage.clientHeight);
    list.forEach((pane, i) => {
      context.font = "600 13px system-ui, sans-serif";
      context.fillStyle = themeColour("ink");
      context.textAlign = "left";
      context.textBaseline = "alphabetic";
      context.fillText(titleOf(pane.at), pane.x + 14, 24);
      if (i) {
        context.strokeStyle = themeColour("line");
        context.lineWidth = 1;
        context.strokeRect(pane.x - 0.5, -1, 0, pane.height + 2);
      }
    });
    context.font = "11px system-ui, sans-serif";
    drawScaleBar(context, look.pixelsPerMm, 14, stage.clientHeight - 14, 110);
    drawDirections(context, list[list.length - 1]);
  }

  function titleOf(place) {
    const between = isTwo && place > 0 && place < 1;
    const name = between ? Math.round(100 * place) + " %" : view.states[Math.round(place)];
    return name + (look.factor !== 1 ? ", displacements × " + look.factor : "");
  }

  function drawDirections(context, pane) {
    const { right, up, back } = camera.axes();
    const centre = [pane.x + pane.width - 44, pane.height - 44];
    const ends = faces.filter(({ sign }) => view.patient || sign > 0)
      .map(({ letter, axis, sign }) => ({
        letter: view.patient ? letter : letter.slice(1), x: sign * right[axis], y: sign * up[axis],
        z: sign * back[axis],
      })).sort((a, b) => a.z - b.z);
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const end of ends) {
      context.globalAlpha = end.z < -0.05 ? 0.4 : 1;
      context.strokeStyle = themeColour("line");
      context.fillStyle = themeColour("soft");
      context.beginPath();
      context.moveTo(...centre);
      context.lineTo(centre[0] + 20 * end.x, centre[1] - 20 * end.y);
      context.stroke();
      if (Math.hypot(end.x, end.y) > 0.25 || end.z > 0)
        context.fillText(end.letter, centre[0] + 30 * end.x, centre[1] - 30 * end.y);
    }
    context.globalAlpha = 1;
  }

  // ------------------------------------------------------------------ controls

  function labelled(text, control) {
    return element("label", {}, text + " ", control);
  }

  function selectOf(choices, listener) {
    const select = element("select", {},
      ...choices.map(([value, textContent]) => element("option", { value, textContent })));
    select.addEventListener("change", () => { listener(select.value); redraw(); });
    return select;
  }

  function button(textContent, title, listener) {
    const made = element("button", { type: "button", textContent, title });
    made.addEventListener("click", listener);
    return made;
  }

  function makeControls() {
    const controls = element("div", { className: "controls" });
    const fields = view.fields.map((field, f) => [f, field.name]);
    if (view.plain) fields.push([-1, view.plain]);
    controls.append(labelled("Colour", selectOf(fields, (f) => { look.field = +f; chooseField(); })), rangeLabel);
    range.addEventListener("change", () => { look.range = +range.value; showColourBar(); redraw(); });
    if (view.outline)
      controls.append(labelled(view.outline, selectOf([["glass", "translucent"], ["wire", "wire"],
        ["off", "hidden"]], (value) => { look.outline = value; })));
    if (view.factor !== 1)
      controls.append(labelled("Displacements", selectOf([[view.factor, "× " + view.factor],
        [1, "× 1"]], (value) => { look.factor = +value; })));
    if (view.creased) {
      const box = element("input", { type: "checkbox" });
      box.addEventListener("change", () => { look.mesh = box.checked; redraw(); });
      controls.append(element("label", {}, box, " mesh"));
    }
    const buttons = element("span", { className: "buttons" });
    buttons.setAttribute("role", "group");
    buttons.setAttribute("aria-label", "Look from");
    for (const face of faces)
      buttons.append(button(face.letter, "Look from " + face.words, () => camera.lookFrom(face)));
    controls.append(buttons);
    return controls;
  }

  function makeLowerControls() {
    const toggles = element("span", { className: "toggles" });
    toggles.setAttribute("role", "group");
    toggles.setAttribute("aria-label", "Surfaces shown");
    if (surfaces.length > 1)
      for (const surface of surfaces) {
        const box = element("input", { type: "checkbox", checked: surface.visible });
        box.addEventListener("change", () => { surface.visible = box.checked; redraw(); });
        toggles.append(element("label", {}, box, swatchOf(surface.css), surface.name));
      }
    slider.addEventListener("input", () => setPlace(isTwo ? slider.value / 100 : +slider.value));
    const deform = element("span", { className: "deform" }, labelled(isTwo ? "Deformation" : "State", ""),
      button("Play", "Go through the deformation", play),
      button(isTwo ? "0 %" : "First", view.states[0], () => setPlace(0)), slider,
      button(isTwo ? "100 %" : "Last", view.states[last], () => setPlace(last)), moment);
    slider.setAttribute("aria-label", isTwo ? "Part of the deformation" : "State");
    return element("div", { className: "controls below" }, toggles, last > 0 ? deform : "");
  }

  /** Shows values of the chosen field with its widest range, and the ranges that it offers. */
  function chooseField() {
    const field = view.fields[look.field];
    const ranges = field ? field.ranges : [1];
    look.range = ranges[ranges.length - 1];
    range.replaceChildren(...ranges.map((value) => element("option", { value, textContent:
      field ? (field.signed ? "± " : "0 – ") + value + " " + field.unit : "" })));
    range.value = look.range;
    rangeLabel.style.display = ranges.length > 1 ? "" : "none";
    showColourBar();
  }

  function showColourBar() {
    const field = view.fields[look.field];
    bar.style.display = field ? "" : "none";
    if (!field) return;
    const strip = element("div", { className: "strip" });
    strip.style.background =
      "linear-gradient(90deg," + colourMaps[field.signed ? "diverging" : "sequential"].join() + ")";
    const digits = (v) => String(+v.toPrecision(3)).replace("-", "−");
    const ticks = element("div", { className: "ticks" }, ...[0, 0.25, 0.5, 0.75, 1].map((f) =>
      element("span", { textContent: digits(look.range * (field.signed ? 2 * f - 1 : f)) })));
    bar.replaceChildren(element("span", { textContent: field.left }), strip,
      element("span", { textContent: field.right }), ticks);
  }

  function setPlace(place) {
    playing = 0;
    at = place;
    showState();
  }

  function showState() {
    slider.value = isTwo ? 100 * at : Math.round(at);
    moment.textContent = isTwo ? Math.round(100 * at) + " %" : view.states[Math.round(at)];
    slider.setAttribute("aria-valuetext", moment.textContent);
    redraw();
  }

  function play() {
    const start = performance.now(), mine = playing = start;
    const duration = isTwo ? 1800 : Math.min(Math.max(400 * last, 1800), 8000);
    const step = (now) => {
      if (playing !== mine) return;
      const part = Math.min(Math.max(now - start, 0) / duration, 1);
      at = isTwo ? part * part * (3 - 2 * part) : part * last;
      showState();
      if (part < 1) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }
}
