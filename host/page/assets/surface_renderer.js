// Surfaces in WebGL: coloured by a value or as they are, translucent, and as lines.

/** Colour maps as evenly spaced anchors; the first is diverging (after ColorBrewer RdBu), the second
 *  sequential (after viridis). Both can be told apart by colour-blind readers. */
const colourMaps = {
  diverging: ["#053061", "#2166ac", "#4393c3", "#92c5de", "#f4f3f0", "#f4a582", "#d6604d", "#b2182b", "#67001f"],
  sequential: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"],
};

const vertexShader = `
attribute vec3 p, u0, u1, n0, n1;
attribute float s0, s1;
uniform float t, factor;
uniform mat3 view;
uniform vec3 centre;
uniform vec3 scale;
uniform vec3 shift;
uniform vec2 range;
varying vec3 normal;
varying float value;
void main() {
  vec3 x = view * (p + factor * mix(u0, u1, t) - centre);
  normal = view * mix(n0, n1, t);
  float s = mix(s0, s1, t);
  value = s > 1e29 ? 1e3 : clamp((s - range.x) / (range.y - range.x), -1.0, 2.0);
  gl_Position = vec4(x.xy * scale.xy + shift.xy, (shift.z - x.z) * scale.z, 1.0);
}`;

const fragmentShader = `
precision mediump float;
uniform sampler2D map;
uniform vec4 flat_colour;  // of alpha 0: the map's
uniform float style;       // 0 solid, 1 glass, 2 flat
varying vec3 normal;
varying float value;
void main() {
  vec3 n = normalize(normal);
  if (n.z < 0.0) n = -n;
  if (style > 0.5) {
    float rim = pow(1.0 - n.z, 2.5);
    float alpha = flat_colour.a * (style > 1.5 ? 1.0 : 0.05 + 0.95 * rim);
    gl_FragColor = vec4(flat_colour.rgb * alpha, alpha);
    return;
  }
  vec3 base = flat_colour.a > 0.0 ? flat_colour.rgb
      : value > 4.0 ? vec3(0.62)  // missing, and the edges that lead there
      : texture2D(map, vec2(clamp(value, 0.002, 0.998), 0.5)).rgb;
  float key = max(dot(n, normalize(vec3(-0.35, 0.55, 0.75))), 0.0);
  float shine = pow(max(dot(n, normalize(vec3(-0.18, 0.30, 0.94))), 0.0), 40.0);
  gl_FragColor = vec4(base * (0.56 + 0.48 * key) + 0.07 * shine, 1.0);
}`;

/** Draws surfaces of `unpackSurface` on the canvas; null where there is no WebGL. */
function makeSurfaceRenderer(canvas, view, surfaces) {
  const options = { alpha: true, antialias: true, preserveDrawingBuffer: true };
  const gl = canvas.getContext("webgl2", options) || canvas.getContext("webgl", options);
  if (!gl || !(gl instanceof WebGLRenderingContext ? gl.getExtension("OES_element_index_uint") : true))
    return null;
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());

  const program = makeProgram();
  const uniforms = Object.fromEntries(["t", "factor", "view", "centre", "scale", "shift", "map", "range",
    "flat_colour", "style"].map((name) => [name, gl.getUniformLocation(program, name)]));
  const attributes = Object.fromEntries(["p", "u0", "u1", "n0", "n1", "s0", "s1"].map((name) =>
    [name, gl.getAttribLocation(program, name)]));
  const maps = Object.fromEntries(Object.entries(colourMaps).map(([name, anchors]) =>
    [name, makeMap(anchors)]));
  const last = view.states.length - 1;
  const devices = surfaces.map((surface) => makeDevice(surface));
  return { draw };

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

  function indices(values) {
    return { buffer: buffer(values, gl.ELEMENT_ARRAY_BUFFER), count: values.length };
  }

  function makeShape({ vertices, triangles }) {
    return { vertices, p: buffer(vertices), triangles: indices(triangles), all: triangles };
  }

  function makeDevice(surface) {
    const device = { surface, shape: makeShape(surface), states: new Map(), values: new Map() };
    if (view.creased) device.shape.rims = indices(rimsOf(surface.triangles));
    if (surface.outline) {
      device.outline = makeShape(surface.outline);
      const normals = buffer(vertexNormals(surface.outline.vertices, null, surface.outline.triangles));
      device.outline.state = { u: null, n: normals };
    }
    return device;
  }

  /** What `make` makes, made once for each key. */
  function kept(map, key, make) {
    if (!map.has(key)) map.set(key, make());
    return map.get(key);
  }

  /** Displacement of state k and the normals of the surface displaced so. */
  function stateOf({ surface, states }, k, factor) {
    return kept(states, k + "/" + factor, () => {
      const u = surface.displacement(k);
      return { u: buffer(u), n: buffer(vertexNormals(surface.vertices, u, surface.triangles, factor)) };
    });
  }

  function valuesOf({ surface, values }, field, k) {
    return kept(values, field + "/" + k, () => {
      const found = surface.values(field, k);
      return found && buffer(found);
    });
  }

  // ------------------------------------------------------------------ drawing

  /** Panes { x, width, height, at } in CSS pixels, `at` a place among the states; `look` says how. */
  function draw(panes, camera, look) {
    gl.disable(gl.SCISSOR_TEST);
    gl.depthMask(true);  // clearing obeys it
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(program);
    const ratio = canvas.width / canvas.clientWidth;
    for (const pane of panes) {
      const box = [Math.round(pane.x * ratio), 0, Math.round(pane.width * ratio), canvas.height];
      gl.viewport(...box);
      gl.scissor(...box);
      drawPane(pane, camera, look);
    }
  }

  function drawPane(pane, camera, look) {
    const { right, up, back } = camera.axes();
    const shift = [2 * camera.pan[0] / pane.width, 2 * camera.pan[1] / pane.height];
    const isSigned = look.field >= 0 && view.fields[look.field].signed;
    gl.uniformMatrix3fv(uniforms.view, false, [0, 1, 2].flatMap((k) => [right[k], up[k], back[k]]));
    gl.uniform3fv(uniforms.centre, view.centre_mm);
    gl.uniform3f(uniforms.scale, 2 * look.pixelsPerMm / pane.width, 2 * look.pixelsPerMm / pane.height,
      1 / (8 * view.radius_mm));
    gl.uniform1f(uniforms.factor, look.factor);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, maps[isSigned ? "diverging" : "sequential"]);
    gl.uniform1i(uniforms.map, 0);
    gl.uniform2f(uniforms.range, isSigned ? -look.range : 0, look.range);
    const place = { k: Math.max(0, Math.min(Math.floor(pane.at), last - 1)), look };
    place.t = pane.at - place.k;
    const shown = devices.filter((d) => d.surface.visible);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    setDepth(shift, 0);
    for (const device of shown) if (!device.surface.glass) drawSolid(device, place);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    setDepth(shift, -0.003 * view.radius_mm);  // lines lie on the faces
    for (const device of shown) drawLines(device, place);
    // The outline a little further back, so that it does not speckle a surface that lies on it.
    setDepth(shift, Math.min(0.6, 0.01 * view.radius_mm));
    const isOpen = shown.every(({ surface }) => surface.inside || surface.glass);
    const hasOutline = (surface) => !surface.plain && (isOpen || !surface.inside);
    for (const device of shown) {
      if (device.surface.glass) drawGlass(device.shape, statesAt(device, place), device.surface.colour, 0.8);
      else if (look.outline !== "off" && hasOutline(device.surface)) drawOutline(device, look);
    }
  }

  function setDepth(shift, behind_mm) {
    gl.uniform3f(uniforms.shift, ...shift, behind_mm);
  }

  function bind(name, source, size) {
    if (!source) {
      gl.disableVertexAttribArray(attributes[name]);
      gl.vertexAttrib3f(attributes[name], 0, 0, 0);
      return;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, source);
    gl.enableVertexAttribArray(attributes[name]);
    gl.vertexAttribPointer(attributes[name], size, gl.FLOAT, false, 0, 0);
  }

  function statesAt(device, { k, t, look }) {
    return { from: stateOf(device, k, look.factor), to: stateOf(device, Math.min(k + 1, last), look.factor), t };
  }

  /** Draws triangles or lines between two states; `values` of both, or null for the flat colour. */
  function drawShape(shape, { from, to, t }, values, kind, { buffer: ends, count }) {
    if (!count) return;
    bind("p", shape.p, 3);
    bind("u0", from.u, 3);
    bind("u1", to.u, 3);
    bind("n0", from.n, 3);
    bind("n1", to.n, 3);
    bind("s0", values && values[0], 1);
    bind("s1", values && values[1], 1);
    gl.uniform1f(uniforms.t, t);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, ends);
    gl.drawElements(kind, count, gl.UNSIGNED_INT, 0);
  }

  function drawSolid(device, place) {
    const { surface, shape } = device, { field } = place.look;
    const pair = [valuesOf(device, field, place.k), valuesOf(device, field, Math.min(place.k + 1, last))];
    const values = pair[0] && pair[1] ? pair : null;
    const colour = field < 0 || surface.plain ? surface.colour : [0.62, 0.64, 0.66];
    gl.uniform4f(uniforms.flat_colour, ...colour, values ? 0 : 1);
    gl.uniform1f(uniforms.style, 0);
    drawShape(shape, statesAt(device, place), values, gl.TRIANGLES, shape.triangles);
  }

  function inkOf(name) {
    return rgbOf(themeColour(name)).map((c) => c / 255);
  }

  /** Creases, and the edges of all triangles if they are asked for. */
  function drawLines(device, place) {
    const { shape, surface } = device;
    if (!shape.rims) return;
    const isMesh = place.look.mesh && !surface.glass;
    const [ink, alpha] = surface.glass ? [surface.colour, 0.8] : [[0, 0, 0], isMesh ? 0.3 : 0.45];
    gl.uniform1f(uniforms.style, 2);
    gl.uniform4f(uniforms.flat_colour, ...ink, alpha);
    const lines = isMesh ? linesIn(shape) : shape.rims;
    drawShape(shape, statesAt(device, place), null, gl.LINES, lines);
  }

  function linesIn(shape) {
    return shape.lines || (shape.lines = indices(linesOf(shape.all)));
  }

  function drawGlass(shape, states, colour, alpha) {
    gl.uniform1f(uniforms.style, 1);
    gl.uniform4f(uniforms.flat_colour, ...colour, alpha);
    drawShape(shape, states, null, gl.TRIANGLES, shape.triangles);
  }

  /** The surface's outline, or else the surface as it was at rest. */
  function drawOutline(device, { outline, factor }) {
    const shape = device.outline || device.shape;
    const state = shape.state || stateOf(device, 0, factor), states = { from: state, to: state, t: 0 };
    const ink = inkOf("target");
    if (outline === "wire") {
      gl.uniform1f(uniforms.style, 1);
      gl.uniform4f(uniforms.flat_colour, ...ink, 0.55);
      drawShape(shape, states, null, gl.LINES, linesIn(shape));
      return;
    }
    drawGlass(shape, states, ink, 0.8);
    if (!shape.rims) return;
    gl.uniform1f(uniforms.style, 2);
    gl.uniform4f(uniforms.flat_colour, ...ink, 0.8);
    drawShape(shape, states, null, gl.LINES, shape.rims);
  }
}
