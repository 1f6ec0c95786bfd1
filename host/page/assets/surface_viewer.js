// Organ surfaces before and after the deformation, side by side, in WebGL.

/** Colour maps as evenly spaced anchors; the first is diverging (after ColorBrewer RdBu), the second
 *  sequential (after viridis). Both can be told apart by colour-blind readers. */
const colourMaps = {
  diverging: ["#053061", "#2166ac", "#4393c3", "#92c5de", "#f4f3f0", "#f4a582", "#d6604d", "#b2182b", "#67001f"],
  sequential: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"],
};

/** A distance that stands for "the target does not show this part". */
const unseen = 1e4;

const vertexShader = `
attribute vec3 p, u, n0, n1;
attribute float s0, s1;
uniform float t;
uniform mat3 view;
uniform vec3 centre;
uniform vec3 scale;
uniform vec3 shift;
varying vec3 normal;
varying float value;
void main() {
  vec3 x = view * (p + t * u - centre);
  normal = view * mix(n0, n1, t);
  value = mix(s0, s1, t);
  gl_Position = vec4(x.xy * scale.xy + shift.xy, (shift.z - x.z) * scale.z, 1.0);
}`;

const fragmentShader = `
precision mediump float;
uniform sampler2D map;
uniform vec2 range;
uniform vec4 flat_colour;
uniform float glass;
varying vec3 normal;
varying float value;
void main() {
  vec3 n = normalize(normal);
  if (n.z < 0.0) n = -n;
  if (glass > 0.5) {
    float rim = pow(1.0 - n.z, 2.5);
    float alpha = flat_colour.a * (0.05 + 0.95 * rim);
    gl_FragColor = vec4(flat_colour.rgb * alpha, alpha);
    return;
  }
  vec3 base = flat_colour.a > 0.0 ? flat_colour.rgb
      : value > 2e2 ? vec3(0.62)  // unseen, and the edges that lead there
      : texture2D(map, vec2(clamp((value - range.x) / (range.y - range.x), 0.002, 0.998), 0.5)).rgb;
  float key = max(dot(n, normalize(vec3(-0.35, 0.55, 0.75))), 0.0);
  float shine = pow(max(dot(n, normalize(vec3(-0.18, 0.30, 0.94))), 0.0), 40.0);
  gl_FragColor = vec4(base * (0.56 + 0.48 * key) + 0.07 * shine, 1.0);
}`;

/** Normals of a surface with the displacement `part` applied, weighted by area. */
function vertexNormals(vertices, displacement, triangles, part) {
  const x = vertices.map((v, i) => v + part * (displacement ? displacement[i] : 0));
  const normals = new Float32Array(x.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const e = [0, 1, 2].map((k) => x[b + k] - x[a + k]), f = [0, 1, 2].map((k) => x[c + k] - x[a + k]);
    const n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) normals[corner + k] += n[k];
  }
  return normals;
}

/** The value below which the given part of the absolute values lies. */
function quantile(values, part) {
  const sorted = Float32Array.from(values, Math.abs).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] : 0;
}

const roundUp = (value) => {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].map((s) => s * power).find((v) => v >= value * 0.999);
};

function linesOf(triangles) {
  const lines = new Uint32Array(2 * triangles.length);
  for (let i = 0, at = 0; i < triangles.length; i += 3)
    for (let k = 0; k < 3; ++k) {
      lines[at++] = triangles[i + k];
      lines[at++] = triangles[i + (k + 1) % 3];
    }
  return lines;
}

/** Starts the viewer; returns the function that draws it anew, or null where there is no WebGL. */
function startSurfaceViewer(surfaceData) {
  const stage = document.getElementById("stage");
  const canvas = document.getElementById("space-canvas");
  const overlay = document.getElementById("space-overlay");
  const options = { alpha: true, antialias: true, preserveDrawingBuffer: true };
  const gl = canvas.getContext("webgl2", options) || canvas.getContext("webgl", options);
  if (!gl || !(gl instanceof WebGLRenderingContext ? gl.getExtension("OES_element_index_uint") : true)) {
    for (const part of document.querySelectorAll("#space > :not(h2, #no-webgl)")) part.style.display = "none";
    document.getElementById("no-webgl").hidden = false;
    return null;
  }

  const program = makeProgram();
  const place = (name) => gl.getUniformLocation(program, name);
  const uniforms = Object.fromEntries(["t", "view", "centre", "scale", "shift", "map", "range",
    "flat_colour", "glass"].map((name) => [name, place(name)]));
  const attributes = Object.fromEntries(["p", "u", "n0", "n1", "s0", "s1"].map((name) =>
    [name, gl.getAttribLocation(program, name)]));
  const maps = Object.fromEntries(Object.entries(colourMaps).map(([name, anchors]) =>
    [name, makeMap(anchors)]));
  const surfaces = surfaceData.map(makeSurface);
  const state = {
    part: 1, mode: "distance", target: "glass", azimuth: -0.55, elevation: 0.32, zoom: 1,
    pan: [0, 0], range: 1,
  };
  const bounds = findBounds();
  const ranges = findRanges();
  state.range = ranges.distance;
  let pending = false;

  makeControls();
  listen();
  return redraw;

  // ------------------------------------------------------------------ data on the device

  function makeProgram() {
    const made = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
        throw new Error("shader: " + gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost())
      throw new Error("shaders: " + gl.getProgramInfoLog(made));
    return made;
  }

  function makeMap(anchors) {
    const colours = anchors.map(rgbOf), bytes = new Uint8Array(4 * 256);
    for (let i = 0; i < 256; ++i) {
      const at = i / 255 * (colours.length - 1), low = Math.min(Math.floor(at), colours.length - 2);
      for (let k = 0; k < 3; ++k)
        bytes[4 * i + k] = colours[low][k] + (at - low) * (colours[low + 1][k] - colours[low][k]);
      bytes[4 * i + 3] = 255;
    }
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    for (const [key, value] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
      gl.texParameteri(gl.TEXTURE_2D, key, value);
    return texture;
  }

  function buffer(values, kind = gl.ARRAY_BUFFER) {
    const made = gl.createBuffer();
    gl.bindBuffer(kind, made);
    gl.bufferData(kind, values, gl.STATIC_DRAW);
    return made;
  }

  function makeSurface(data) {
    const vertices = floatsOf(data.vertices), u = floatsOf(data.displacement);
    const triangles = indicesOf(data.triangles);
    const before = floatsOf(data.distance_before_mm), after = floatsOf(data.distance_after_mm);
    const traction = floatsOf(data.traction_kpa);
    const length = new Float32Array(vertices.length / 3).map((_, v) =>
      Math.hypot(u[3 * v], u[3 * v + 1], u[3 * v + 2]));
    const targetVertices = floatsOf(data.target_vertices), targetTriangles = indicesOf(data.target_triangles);
    return {
      name: data.name, role: data.role, colour: rgbOf(data.colour).map((c) => c / 255), css: data.colour,
      visible: data.role !== "fixed", vertices, u, before, after, length, traction,
      p: buffer(vertices), du: buffer(u),
      n0: buffer(vertexNormals(vertices, u, triangles, 0)), n1: buffer(vertexNormals(vertices, u, triangles, 1)),
      scalars: {
        distance: [buffer(before), buffer(after)],
        displacement: [buffer(new Float32Array(length.length)), buffer(length)],
        traction: [buffer(new Float32Array(traction.length)), buffer(traction)],
      },
      triangles: buffer(triangles, gl.ELEMENT_ARRAY_BUFFER), count: triangles.length,
      target: {
        p: buffer(targetVertices), n: buffer(vertexNormals(targetVertices, null, targetTriangles, 0)),
        triangles: buffer(targetTriangles, gl.ELEMENT_ARRAY_BUFFER), count: targetTriangles.length,
        lines: buffer(linesOf(targetTriangles), gl.ELEMENT_ARRAY_BUFFER),
      },
    };
  }

  function findBounds() {
    const shown = surfaces.filter((s) => s.visible);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const s of shown.length ? shown : surfaces)
      s.vertices.forEach((x, i) => {
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
      });
    const centre = low.map((l, k) => (l + high[k]) / 2);
    return { centre, radius: Math.max(Math.hypot(...low.map((l, k) => high[k] - l)) / 2, 1e-3) };
  }

  function findRanges() {
    const largest = (pick, roles) => Math.max(1e-3, ...surfaces.filter((s) => roles.includes(s.role))
      .map((s) => quantile(pick(s), 0.97)));
    const moving = ["tissue", "driven"];
    return {
      distance: roundUp(largest((s) => s.before.filter((d) => d < unseen), moving)),
      displacement: roundUp(largest((s) => s.length, moving)),
      traction: roundUp(largest((s) => s.traction, ["driven"])),
    };
  }

  // ------------------------------------------------------------------ drawing

  function viewMatrix() {
    const { azimuth: a, elevation: e } = state;
    const right = [Math.cos(a), Math.sin(a), 0];
    const up = [Math.sin(e) * -Math.sin(a), Math.sin(e) * Math.cos(a), Math.cos(e)];
    const back = [Math.cos(e) * Math.sin(a), -Math.cos(e) * Math.cos(a), Math.sin(e)];
    return { right, up, back };
  }

  /** Left and right half of the stage, or the whole where it is narrow. */
  function panes() {
    const width = stage.clientWidth, height = stage.clientHeight;
    if (width < 560) return [{ x: 0, width, height, part: state.part }];
    return [{ x: 0, width: width / 2, height, part: 0 }, { x: width / 2, width: width / 2, height, part: state.part }];
  }

  function pixelsPerMm(pane) {
    return state.zoom * 0.62 * Math.min(pane.width, pane.height) / bounds.radius;
  }

  function redraw() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => { pending = false; draw(); });
  }

  function draw() {
    fitCanvas(canvas, stage.clientWidth, stage.clientHeight);
    fitCanvas(overlay, stage.clientWidth, stage.clientHeight);
    gl.disable(gl.SCISSOR_TEST);
    gl.depthMask(true);  // clearing obeys it
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.useProgram(program);
    const ratio = canvas.width / stage.clientWidth;
    for (const pane of panes()) drawPane(pane, ratio);
    drawOverlay();
  }

  function drawPane(pane, ratio) {
    const box = [Math.round(pane.x * ratio), 0, Math.round(pane.width * ratio), canvas.height];
    gl.viewport(...box);
    gl.scissor(...box);
    const { right, up, back } = viewMatrix();
    const scale = pixelsPerMm(pane);
    const shift = [2 * state.pan[0] / pane.width, 2 * state.pan[1] / pane.height];
    gl.uniformMatrix3fv(uniforms.view, false, [0, 1, 2].flatMap((k) => [right[k], up[k], back[k]]));
    gl.uniform3fv(uniforms.centre, bounds.centre);
    gl.uniform3f(uniforms.scale, 2 * scale / pane.width, 2 * scale / pane.height, 1 / (8 * bounds.radius));
    gl.uniform3f(uniforms.shift, ...shift, 0);
    gl.uniform1f(uniforms.t, pane.part);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, maps[state.mode === "distance" ? "diverging" : "sequential"]);
    gl.uniform1i(uniforms.map, 0);
    gl.uniform2f(uniforms.range, state.mode === "distance" ? -state.range : 0, state.range);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    const shown = surfaces.filter((s) => s.visible);
    shown.forEach(drawSolid);
    // The target a little further back, so that it does not speckle a surface that lies on it.
    gl.uniform3f(uniforms.shift, ...shift, 0.6);
    if (state.target !== "off") drawTargets(shown);
  }

  function bind(attribute, source, size) {
    gl.bindBuffer(gl.ARRAY_BUFFER, source);
    gl.enableVertexAttribArray(attribute);
    gl.vertexAttribPointer(attribute, size, gl.FLOAT, false, 0, 0);
  }

  function hasValue(s) {
    if (state.mode === "organ") return false;
    return state.mode === "traction" ? s.role === "driven" : s.role !== "fixed";
  }

  function drawSolid(s) {
    bind(attributes.p, s.p, 3);
    bind(attributes.u, s.du, 3);
    bind(attributes.n0, s.n0, 3);
    bind(attributes.n1, s.n1, 3);
    const [s0, s1] = s.scalars[state.mode] || s.scalars.distance;
    bind(attributes.s0, s0, 1);
    bind(attributes.s1, s1, 1);
    const colour = state.mode === "organ" || s.role === "fixed" ? s.colour : [0.62, 0.64, 0.66];
    gl.uniform4f(uniforms.flat_colour, ...colour, hasValue(s) ? 0 : 1);
    gl.uniform1f(uniforms.glass, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, s.triangles);
    gl.drawElements(gl.TRIANGLES, s.count, gl.UNSIGNED_INT, 0);
  }

  function drawTargets(shown) {
    const wire = state.target === "wire";
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.uniform1f(uniforms.t, 0);
    gl.uniform1f(uniforms.glass, 1);
    const ink = rgbOf(themeColour("target")).map((c) => c / 255);
    gl.uniform4f(uniforms.flat_colour, ...ink, wire ? 0.55 : 0.8);
    for (const name of ["u", "s0", "s1"]) {
      gl.disableVertexAttribArray(attributes[name]);
      gl.vertexAttrib3f(attributes[name], 0, 0, 0);
    }
    for (const { target, role } of shown) {
      if (role === "fixed" || !target.count) continue;
      bind(attributes.p, target.p, 3);
      bind(attributes.n0, target.n, 3);
      bind(attributes.n1, target.n, 3);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, wire ? target.lines : target.triangles);
      gl.drawElements(wire ? gl.LINES : gl.TRIANGLES, wire ? 2 * target.count : target.count, gl.UNSIGNED_INT, 0);
    }
  }

  /** Titles, a cross of patient directions, and a scale bar (the projection is parallel). */
  function drawOverlay() {
    const context = overlay.getContext("2d");
    const ratio = overlay.width / stage.clientWidth;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, stage.clientWidth, stage.clientHeight);
    const list = panes();
    list.forEach((pane, i) => {
      context.font = "600 13px system-ui, sans-serif";
      context.fillStyle = themeColour("ink");
      context.textAlign = "left";
      context.textBaseline = "alphabetic";
      const percent = Math.round(100 * pane.part) + " %";
      context.fillText(pane.part === 0 ? "Before" : pane.part === 1 ? "After" : percent, pane.x + 14, 24);
      if (i) {
        context.strokeStyle = themeColour("line");
        context.lineWidth = 1;
        context.strokeRect(pane.x - 0.5, -1, 0, pane.height + 2);
      }
    });
    context.font = "11px system-ui, sans-serif";
    drawScaleBar(context, pixelsPerMm(list[0]), 14, stage.clientHeight - 14, 110);
    drawDirections(context, list[list.length - 1]);
  }

  function drawDirections(context, pane) {
    const { right, up, back } = viewMatrix();
    const centre = [pane.x + pane.width - 44, pane.height - 44];
    const ends = [["L", 0, 1], ["R", 0, -1], ["P", 1, 1], ["A", 1, -1], ["S", 2, 1], ["I", 2, -1]]
      .map(([letter, axis, sign]) => ({ letter, x: sign * right[axis], y: sign * up[axis], z: sign * back[axis] }))
      .sort((a, b) => a.z - b.z);
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

  function makeControls() {
    const toggles = document.getElementById("organ-toggles");
    for (const s of surfaces) {
      const box = element("input", { type: "checkbox", checked: s.visible });
      box.addEventListener("change", () => { s.visible = box.checked; redraw(); });
      toggles.append(element("label", {}, box, swatchOf(s.css), s.name));
    }
    const faces = { A: [0, 0], P: [Math.PI, 0], R: [-Math.PI / 2, 0], L: [Math.PI / 2, 0], S: [0, Math.PI / 2], I: [0, -Math.PI / 2] };
    const titles = { A: "front", P: "back", R: "the patient's right", L: "the patient's left", S: "head", I: "feet" };
    for (const [letter, [azimuth, elevation]] of Object.entries(faces)) {
      const button = element("button", { type: "button", textContent: letter, title: "Look from " + titles[letter] });
      button.addEventListener("click", () => { Object.assign(state, { azimuth, elevation }); redraw(); });
      document.getElementById("view-buttons").append(button);
    }
    if (!surfaces.some((s) => s.role === "driven"))
      document.querySelector("#colour-mode option[value=traction]").remove();
    makeRanges();
    showColourBar();
  }

  function makeRanges() {
    const select = document.getElementById("colour-range");
    const values = [0.5, 1, 2, 5, 10].filter((v) => v < ranges.distance).concat(ranges.distance);
    for (const v of values) select.append(element("option", { value: v, textContent: "± " + v + " mm" }));
    select.value = state.range;
    select.addEventListener("change", () => { state.range = +select.value; showColourBar(); redraw(); });
  }

  function showColourBar() {
    const bar = document.getElementById("colourbar");
    bar.style.display = state.mode === "organ" ? "none" : "";
    document.getElementById("range-label").style.display = state.mode === "distance" ? "" : "none";
    const diverging = state.mode === "distance";
    const strip = element("div", { className: "strip" });
    strip.style.background = "linear-gradient(90deg," + colourMaps[diverging ? "diverging" : "sequential"].join() + ")";
    const digits = (v) => String(+v.toPrecision(3)).replace("-", "−");
    const values = [0, 0.25, 0.5, 0.75, 1].map((f) => diverging ? state.range * (2 * f - 1) : state.range * f);
    const ticks = element("div", { className: "ticks" }, ...values.map((v) =>
      element("span", { textContent: digits(v) })));
    const ends = {
      distance: ["inside the target", "outside, mm"], displacement: ["displacement", "mm"],
      traction: ["traction on driven organs", "kPa"], organ: ["", ""],
    }[state.mode];
    bar.replaceChildren(element("span", { textContent: ends[0] }), strip, element("span", { textContent: ends[1] }), ticks);
  }

  function setPart(part) {
    state.part = part;
    document.getElementById("deform").value = 100 * part;
    document.getElementById("deform-value").textContent = Math.round(100 * part) + " %";
    redraw();
  }

  function play() {
    const start = performance.now();
    const step = (now) => {
      const part = Math.min((now - start) / 1800, 1);
      setPart(part * part * (3 - 2 * part));
      if (part < 1) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  function listen() {
    const by = (id) => document.getElementById(id);
    by("deform").addEventListener("input", (event) => setPart(event.target.value / 100));
    by("show-before").addEventListener("click", () => setPart(0));
    by("show-after").addEventListener("click", () => setPart(1));
    by("play").addEventListener("click", play);
    by("target-mode").addEventListener("change", (event) => { state.target = event.target.value; redraw(); });
    by("colour-mode").addEventListener("change", (event) => {
      state.mode = event.target.value;
      state.range = state.mode === "distance" ? +by("colour-range").value : ranges[state.mode] || 1;
      showColourBar();
      redraw();
    });
    listenToPointers();
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoomBy(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
    }, { passive: false });
    canvas.addEventListener("dblclick", () => {
      Object.assign(state, { azimuth: -0.55, elevation: 0.32, zoom: 1, pan: [0, 0] });
      redraw();
    });
    canvas.addEventListener("keydown", (event) => {
      const turns = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
      if (turns[event.key]) turnBy(...turns[event.key]);
      else if (event.key === "+" || event.key === "=") zoomBy(1.15);
      else if (event.key === "-") zoomBy(1 / 1.15);
      else return;
      event.preventDefault();
    });
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  }

  function turnBy(azimuth, elevation) {
    state.azimuth += azimuth;
    state.elevation = Math.min(Math.max(state.elevation + elevation, -Math.PI / 2), Math.PI / 2);
    redraw();
  }

  function zoomBy(factor) {
    state.zoom = Math.min(Math.max(state.zoom * factor, 0.3), 20);
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
        state.pan = [state.pan[0] + dx, state.pan[1] - dy];
        redraw();
      } else {
        turnBy(-dx * 0.008, dy * 0.008);
      }
      pointers.set(event.pointerId, event);
    });
  }
}
