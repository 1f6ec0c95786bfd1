// Three linked slice views: on plain ground reference areas, target and warped outlines; on an image
// of the patient the outlines that belong to it. They are cut from the surfaces (smooth) or follow the
// voxels.

/** How a view cuts the volume (index 0, 1, 2 run to left, back, head). */
const sliceCuts = {
  axial: { column: 0, row: 1, through: 2, rowsUp: false, letters: ["R", "L", "A", "P"] },
  coronal: { column: 0, row: 2, through: 1, rowsUp: true, letters: ["R", "L", "S", "I"] },
  sagittal: { column: 1, row: 2, through: 0, rowsUp: true, letters: ["A", "P", "S", "I"] },
};

/** Pairs of cell edges (0 top, 1 right, 2 bottom, 3 left) that the outline joins, by corner pattern. */
const outlineStrokes = [[], [3, 0], [0, 1], [3, 1], [1, 2], [3, 0, 1, 2], [0, 2], [3, 2], [2, 3],
  [2, 0], [0, 1, 2, 3], [2, 1], [1, 3], [1, 0], [0, 3], []];
const edgeMiddles = [[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]];

/** One slice as rows of values, first row on top. */
function cutSlice(voxels, size, cut, position) {
  const columns = size[cut.column], rows = size[cut.row];
  const strides = [1, size[0], size[0] * size[1]];
  const values = new Uint8Array(columns * rows);
  for (let r = 0; r < rows; ++r) {
    const row = cut.rowsUp ? rows - 1 - r : r;
    let at = position * strides[cut.through] + row * strides[cut.row];
    for (let c = 0; c < columns; ++c, at += strides[cut.column]) values[r * columns + c] = voxels[at];
  }
  return { columns, rows, values };
}

/** Outline of one organ by marching squares between pixel centres; path in units of pixels. */
function outlineOf(slice, organ) {
  const { columns, rows, values } = slice;
  const inside = (c, r) =>
    c >= 0 && r >= 0 && c < columns && r < rows && values[r * columns + c] === organ ? 1 : 0;
  const path = new Path2D();
  for (let r = -1; r < rows; ++r) {
    for (let c = -1; c < columns; ++c) {
      const pattern = inside(c, r) | inside(c + 1, r) << 1 | inside(c + 1, r + 1) << 2 |
        inside(c, r + 1) << 3;
      const strokes = outlineStrokes[pattern];
      for (let s = 0; s < strokes.length; s += 2) {
        const a = edgeMiddles[strokes[s]], b = edgeMiddles[strokes[s + 1]];
        path.moveTo(c + 0.5 + a[0], r + 0.5 + a[1]);
        path.lineTo(c + 0.5 + b[0], r + 0.5 + b[1]);
      }
    }
  }
  return path;
}

/** A surface in voxel coordinates of the volumes, with the displacement if there is one. */
function surfaceInVoxels(volumes, colour, { vertices: x, triangles }, u = null) {
  const at = new Float32Array(x.length);
  for (let v = 0; v < x.length; v += 3)
    for (let a = 0; a < 3; ++a) {
      let along = 0;
      for (let k = 0; k < 3; ++k)
        along += volumes.axes[a][k] * (x[v + k] + (u ? u[v + k] : 0) - volumes.origin_mm[k]);
      at[v + a] = along / volumes.spacing_mm[a];
    }
  return { colour, at, triangles };
}

/** Where a slice cuts a surface; path in units of pixels, like `outlineOf`. */
function cutOfSurface(surface, cut, size, position) {
  const { at, triangles } = surface;
  const path = new Path2D();
  const level = position + 1e-4;  // beside the voxel centre, where no vertex lies by accident
  const point = (a, b) => {
    const f = (level - at[a + cut.through]) / (at[b + cut.through] - at[a + cut.through]);
    const row = at[a + cut.row] + f * (at[b + cut.row] - at[a + cut.row]);
    return [at[a + cut.column] + f * (at[b + cut.column] - at[a + cut.column]) + 0.5,
      (cut.rowsUp ? size[cut.row] - 1 - row : row) + 0.5];
  };
  for (let i = 0; i < triangles.length; i += 3) {
    const corners = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const ends = [];
    for (let k = 0; k < 3; ++k) {
      const a = corners[k], b = corners[(k + 1) % 3];
      if ((at[a + cut.through] < level) !== (at[b + cut.through] < level)) ends.push(point(a, b));
    }
    if (ends.length === 2) {
      path.moveTo(...ends[0]);
      path.lineTo(...ends[1]);
    }
  }
  return path;
}

/** The tinted areas of a slice as a picture of one pixel a voxel. */
function areasOf(slice, colours) {
  const picture = document.createElement("canvas");
  picture.width = slice.columns;
  picture.height = slice.rows;
  const context = picture.getContext("2d");
  const image = context.createImageData(slice.columns, slice.rows);
  slice.values.forEach((value, i) => {
    if (value) image.data.set([...colours[value - 1], 92], 4 * i);
  });
  context.putImageData(image, 0, 0);
  return picture;
}

/** Grey values of a picture, index 0 fastest, from its slices side by side in a PNG file; `done` follows. */
function unpackPicture(data, done) {
  const picture = { size: data.size, voxels: null };
  const image = new Image();
  image.addEventListener("error", () => { throw new Error("a picture cannot be unpacked"); });
  image.addEventListener("load", () => {
    const { width, height } = image;
    const context = element("canvas", { width, height }).getContext("2d", { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, width, height).data;
    const [columns, rows, slices] = data.size;
    picture.voxels = new Uint8Array(columns * rows * slices);
    for (let k = 0, to = 0; k < slices; ++k) {
      const left = columns * (k % data.tiles_per_row), top = rows * Math.floor(k / data.tiles_per_row);
      for (let r = 0; r < rows; ++r)
        for (let c = 0; c < columns; ++c)
          picture.voxels[to++] = pixels[4 * ((top + r) * width + left + c)];
    }
    done();
  });
  image.src = "data:image/png;base64," + data.png;
  return picture;
}

/** One slice of a picture on a canvas, between two of its own where they lie elsewhere.
 *  `place`: 0 to 1 through the volume; `greys`: what each value looks like. */
function sliceOfPicture({ size, voxels }, cut, place, greys) {
  const columns = size[cut.column], rows = size[cut.row], strides = [1, size[0], size[0] * size[1]];
  const depth = Math.min(Math.max(place * size[cut.through] - 0.5, 0), size[cut.through] - 1);
  const low = Math.floor(depth), part = depth - low;
  const next = part > 0 ? strides[cut.through] : 0;
  const canvas = element("canvas", { width: columns, height: rows });
  const context = canvas.getContext("2d");
  const image = context.createImageData(columns, rows);
  for (let r = 0, to = 0; r < rows; ++r) {
    const row = cut.rowsUp ? rows - 1 - r : r;
    let at = low * strides[cut.through] + row * strides[cut.row];
    for (let c = 0; c < columns; ++c, at += strides[cut.column], to += 4) {
      const grey = greys[Math.round((1 - part) * voxels[at] + part * voxels[at + next])];
      image.data[to] = image.data[to + 1] = image.data[to + 2] = grey;
      image.data[to + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** What is drawn on which ground until the reader chooses otherwise. */
const layersOn = {
  target: { reference: false, target: true, warped: true },
  reference: { reference: true, target: false, warped: false },
  plain: { reference: true, target: true, warped: true },
};

const groundNames = { target: "target image", reference: "reference image", plain: "" };

/** Fills the figures of the page; returns the function that draws them anew. */
function startSliceViewer(data, surfaceData, pictureData) {
  const count = data.size[0] * data.size[1] * data.size[2];
  const volumes = {
    reference: voxelsOf(data.reference, count),
    target: voxelsOf(data.target, count),
    warped: voxelsOf(data.warped, count),
  };
  const colours = data.organs.map((organ) => rgbOf(organ.colour));
  const surfaces = {
    reference: surfaceData.map((s) => surfaceInVoxels(data, s.css, s)),
    target: surfaceData.map((s) => surfaceInVoxels(data, s.css, s.outline)),
    warped: surfaceData.map((s) => surfaceInVoxels(data, s.css, s, s.displacement(1))),
  };
  const withoutSurface = data.organs.map((organ, i) => ({ ...organ, value: i + 1 }))
    .filter((organ) => !surfaceData.some((s) => s.name === organ.name));
  let smooth = surfaceData.length > 0;
  const grounds = ["target", "reference"].filter((name) => pictureData[name]).concat("plain");
  const tone = { brightness: 0, contrast: 0, "line strength": 1 };
  let ground = grounds[0], shown = { ...layersOn[ground] };
  const position = [...data.centre];
  const views = [], paperViews = [], layerBoxes = {};
  const widths = {};  // of the views on the screen, which those for paper follow

  const pictures = {};
  for (const name of grounds.slice(0, -1))
    pictures[name] = unpackPicture(pictureData[name], () => {
      document.documentElement.dataset.pictures =
        Object.values(pictures).every((p) => p.voxels) ? "ready" : "starting";
      drawEverything();
    });

  for (const figure of document.querySelectorAll("figure[data-view]")) {
    const onPaper = figure.closest(".on-paper") !== null;
    (onPaper ? paperViews : views).push(makeSliceView(figure, sliceCuts[figure.dataset.view], onPaper));
  }
  makeSliceLegend();
  if (grounds.length > 1) makePictureControls();
  return drawEverything;

  function drawAll() {
    views.forEach((view) => view.draw(ground, shown));
  }

  /** The other row of slices, which is seen on paper only, too. */
  function drawEverything() {
    drawAll();
    const other = grounds.find((name) => name !== ground);
    paperViews.forEach((view) => view.draw(other, layersOn[other]));
  }

  function makePictureControls() {
    const controls = document.getElementById("picture-controls");
    const buttons = element("span", { className: "buttons" });
    buttons.setAttribute("role", "group");
    buttons.setAttribute("aria-label", "Under the outlines");
    const press = () => grounds.forEach((name, i) =>
      buttons.children[i].setAttribute("aria-pressed", name === ground));
    for (const name of grounds) {
      const button = element("button", { type: "button", textContent: groundNames[name] || "no image" });
      button.addEventListener("click", () => {
        ground = name;
        shown = { ...layersOn[name] };
        for (const [layer, box] of Object.entries(layerBoxes)) box.checked = shown[layer];
        press();
        drawAll();
      });
      buttons.append(button);
    }
    press();
    controls.append(buttons);
    const sliders = { brightness: [-1, 0], contrast: [-1, 0], "line strength": [0, 1] };
    for (const [name, [min, value]] of Object.entries(sliders)) {
      const slider = element("input", { type: "range", min, max: 1, step: 0.02, value });
      slider.addEventListener("input", () => { tone[name] = +slider.value; drawAll(); });
      slider.addEventListener("dblclick", () => { slider.value = tone[name] = value; drawAll(); });
      slider.title = "double click: as at first";
      controls.append(element("label", {}, name + " ", slider));
    }
  }

  /** Greys of the values 0 to 255 at the chosen brightness and contrast. */
  function greysNow() {
    const slope = 4 ** tone.contrast;
    return Uint8ClampedArray.from({ length: 256 }, (_, value) =>
      255 * (0.5 + 0.5 * tone.brightness + slope * (value / 255 - 0.5)));
  }

  function makeSliceLegend() {
    const legend = document.getElementById("slice-legend");
    data.organs.forEach((organ) =>
      legend.append(element("span", {}, swatchOf(organ.colour), organ.name)));
    const layers = { reference: "reference", target: "target", warped: "after" };
    for (const [layer, text] of Object.entries(layers)) {
      const box = element("input", { type: "checkbox", checked: shown[layer] });
      box.addEventListener("change", () => { shown[layer] = box.checked; drawAll(); });
      layerBoxes[layer] = box;
      legend.append(element("label", {}, box, " " + text));
    }
    if (!smooth) return;
    const select = element("select", {},
      element("option", { value: "surfaces", textContent: "from the surfaces" }),
      element("option", { value: "voxels", textContent: "from the voxels" }));
    select.addEventListener("change", () => { smooth = select.value === "surfaces"; drawAll(); });
    legend.append(element("label", {}, "outlines ", select));
  }

  function makeSliceView(figure, cut, onPaper) {
    const frame = figure.querySelector(".frame");
    const canvas = element("canvas", {});
    const where = element("span", { className: "where" });
    const slider = element("input", {
      type: "range", min: 0, max: data.size[cut.through] - 1, value: position[cut.through],
    });
    slider.setAttribute("aria-label", figure.dataset.view + " slice");
    frame.replaceChildren(canvas);
    figure.querySelector("figcaption").append(where);
    if (!onPaper) figure.append(slider);

    const width = data.size[cut.column] * data.spacing_mm[cut.column];
    const height = data.size[cut.row] * data.spacing_mm[cut.row];
    let scale = 1;
    slider.addEventListener("input", () => { position[cut.through] = +slider.value; drawAll(); });
    canvas.addEventListener("click", (event) => {
      const column = Math.floor(event.offsetX / scale / data.spacing_mm[cut.column]);
      const row = Math.floor(event.offsetY / scale / data.spacing_mm[cut.row]);
      const clamp = (v, axis) => Math.min(Math.max(v, 0), data.size[axis] - 1);
      position[cut.column] = clamp(column, cut.column);
      position[cut.row] = clamp(cut.rowsUp ? data.size[cut.row] - 1 - row : row, cut.row);
      drawAll();
    });

    function draw(ground, layers) {
      const across = frame.clientWidth || widths[figure.dataset.view] || 300;
      if (!onPaper) widths[figure.dataset.view] = across;
      scale = across / width;
      fitCanvas(canvas, across, height * scale);
      slider.value = position[cut.through];
      where.textContent = "slice " + (position[cut.through] + 1) + " / " + data.size[cut.through];
      figure.querySelector(".ground").textContent = groundNames[ground] && ", " + groundNames[ground];
      const context = canvas.getContext("2d");
      const ratio = canvas.width / across;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, canvas.width, canvas.height);
      const onPicture = ground !== "plain";
      canvas.style.background = onPicture ? "#000" : "";
      if (onPicture) drawPicture(context, pictures[ground]);
      drawContent(context, onPicture, layers);
      drawCross(context, onPicture);
      drawFurniture(context, onPicture);
    }

    function drawPicture(context, picture) {
      context.fillStyle = "#000";
      context.fillRect(0, 0, width * scale, height * scale);
      if (!picture.voxels) return;
      const place = (position[cut.through] + 0.5) / data.size[cut.through];
      const slice = smoothed(sliceOfPicture(picture, cut, place, greysNow()));
      context.imageSmoothingEnabled = true;
      context.drawImage(slice, 0, 0, width * scale, height * scale);
    }

    /** In as many pixels as are seen: on paper browsers leave the smoothing to the printer. */
    function smoothed(slice) {
      const fine = window.matchMedia("print").matches ? 3 : 1;
      const large = element("canvas", { width: fine * canvas.width, height: fine * canvas.height });
      const context = large.getContext("2d");
      context.imageSmoothingQuality = "high";
      context.drawImage(slice, 0, 0, large.width, large.height);
      return large;
    }

    function drawContent(context, onPicture, layers) {
      const sx = scale * data.spacing_mm[cut.column], sy = scale * data.spacing_mm[cut.row];
      context.globalAlpha = onPicture ? tone["line strength"] : 1;
      if (layers.reference && !onPicture) {
        const slice = cutSlice(volumes.reference, data.size, cut, position[cut.through]);
        const picture = areasOf(slice, colours);
        context.imageSmoothingEnabled = false;
        context.drawImage(picture, 0, 0, sx * picture.width, sy * picture.height);
      }
      context.lineCap = "round";
      const thick = { target: onPicture ? 2.2 : 3.2, warped: 1.5, reference: 1.5 };
      for (const layer of onPicture ? ["target", "reference", "warped"] : ["target", "warped"]) {
        if (!layers[layer]) continue;
        for (const [outline, colour] of outlinesOf(layer, onPicture)) {
          // Stretched to mm first, so that lines keep one width in both directions.
          const path = new Path2D();
          path.addPath(outline, new DOMMatrix([sx, 0, 0, sy, 0, 0]));
          if (onPicture) strokeOf(path, thick[layer] + 1.4, "rgb(0 0 0 / .5)");
          const ink = onPicture ? "#fff" : themeColour("target");
          strokeOf(path, thick[layer], layer === "target" ? ink : colour);
        }
      }
      context.globalAlpha = 1;

      function strokeOf(path, lineWidth, colour) {
        context.lineWidth = lineWidth;
        context.strokeStyle = colour;
        context.stroke(path);
      }
    }

    /** Pairs of path and colour. On pictures organs without a surface (the fixed ones) have some, too. */
    function outlinesOf(layer, onPicture) {
      const at = position[cut.through];
      const ofVoxels = (organs) => {
        const slice = cutSlice(volumes[layer], data.size, cut, at);
        return organs.map((organ) => [outlineOf(slice, organ.value), organ.colour]);
      };
      if (!smooth) return ofVoxels(data.organs.map((organ, i) => ({ ...organ, value: i + 1 })));
      return surfaces[layer].map((s) => [cutOfSurface(s, cut, data.size, at), s.colour])
        .concat(onPicture ? ofVoxels(withoutSurface) : []);
    }

    function drawCross(context, onPicture) {
      const row = cut.rowsUp ? data.size[cut.row] - 1 - position[cut.row] : position[cut.row];
      const x = (position[cut.column] + 0.5) * scale * data.spacing_mm[cut.column];
      const y = (row + 0.5) * scale * data.spacing_mm[cut.row];
      context.strokeStyle = onPicture ? "#9cf" : themeColour("accent");
      context.globalAlpha = 0.35;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(x, 0);
      context.lineTo(x, height * scale);
      context.moveTo(0, y);
      context.lineTo(width * scale, y);
      context.stroke();
      context.globalAlpha = 1;
    }

    function drawFurniture(context, onPicture) {
      const w = width * scale, h = height * scale;
      const ink = onPicture ? "#fff" : themeColour("soft");
      context.shadowColor = "#000";
      context.shadowBlur = onPicture ? 3 : 0;
      context.font = "600 12px system-ui, sans-serif";
      context.fillStyle = ink;
      context.textBaseline = "middle";
      context.textAlign = "left";
      context.fillText(cut.letters[0], 6, h / 2);
      context.textAlign = "right";
      context.fillText(cut.letters[1], w - 6, h / 2);
      context.textAlign = "center";
      context.fillText(cut.letters[2], w / 2, 11);
      context.fillText(cut.letters[3], w / 2, h - 9);
      context.font = "11px system-ui, sans-serif";
      drawScaleBar(context, scale, 8, h - 8, Math.min(w / 3, 90), ink);
      context.shadowBlur = 0;
    }

    return { draw };
  }
}
