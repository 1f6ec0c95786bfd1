// Three linked slice views of the label volumes: reference areas, target and warped outlines. The
// outlines are cut from the surfaces (smooth) or follow the voxels.

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
function surfaceInVoxels(volumes, colour, vertices, displacement, triangles) {
  const x = floatsOf(vertices), u = displacement ? floatsOf(displacement) : null;
  const at = new Float32Array(x.length);
  for (let v = 0; v < x.length; v += 3)
    for (let a = 0; a < 3; ++a) {
      let along = 0;
      for (let k = 0; k < 3; ++k)
        along += volumes.axes[a][k] * (x[v + k] + (u ? u[v + k] : 0) - volumes.origin_mm[k]);
      at[v + a] = along / volumes.spacing_mm[a];
    }
  return { colour, at, triangles: indicesOf(triangles) };
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

const rgbOf = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** Fills the figures of the page; returns the function that draws them anew. */
function startSliceViewer(data, surfaceData) {
  const count = data.size[0] * data.size[1] * data.size[2];
  const volumes = {
    reference: voxelsOf(data.reference, count),
    target: voxelsOf(data.target, count),
    warped: voxelsOf(data.warped, count),
  };
  const colours = data.organs.map((organ) => rgbOf(organ.colour));
  const surfaces = {
    target: surfaceData.map((s) =>
      surfaceInVoxels(data, s.colour, s.target_vertices, null, s.target_triangles)),
    warped: surfaceData.map((s) =>
      surfaceInVoxels(data, s.colour, s.vertices, s.displacement, s.triangles)),
  };
  let smooth = surfaceData.length > 0;
  const shown = { reference: true, target: true, warped: true };
  const position = [...data.centre];
  const views = [];

  const drawAll = () => views.forEach((view) => view.draw());
  for (const figure of document.querySelectorAll("figure[data-view]")) {
    const cut = sliceCuts[figure.dataset.view];
    views.push(makeSliceView(figure, cut));
  }
  makeSliceLegend();
  return drawAll;

  function makeSliceLegend() {
    const legend = document.getElementById("slice-legend");
    data.organs.forEach((organ) =>
      legend.append(element("span", {}, swatchOf(organ.colour), organ.name)));
    const layers = { reference: "reference", target: "target", warped: "after" };
    for (const [layer, text] of Object.entries(layers)) {
      const box = element("input", { type: "checkbox", checked: true });
      box.addEventListener("change", () => { shown[layer] = box.checked; drawAll(); });
      legend.append(element("label", {}, box, " " + text));
    }
    if (!smooth) return;
    const select = element("select", {},
      element("option", { value: "surfaces", textContent: "from the surfaces" }),
      element("option", { value: "voxels", textContent: "from the voxels" }));
    select.addEventListener("change", () => { smooth = select.value === "surfaces"; drawAll(); });
    legend.append(element("label", {}, "outlines ", select));
  }

  function makeSliceView(figure, cut) {
    const frame = figure.querySelector(".frame");
    const canvas = element("canvas", {});
    const where = element("span", {});
    const slider = element("input", {
      type: "range", min: 0, max: data.size[cut.through] - 1, value: position[cut.through],
    });
    slider.setAttribute("aria-label", figure.dataset.view + " slice");
    frame.replaceChildren(canvas);
    figure.querySelector("figcaption").append(where);
    figure.append(slider);

    const width = data.size[cut.column] * data.spacing_mm[cut.column];
    const height = data.size[cut.row] * data.spacing_mm[cut.row];
    figure.style.flexGrow = width;  // one scale for all views
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

    function draw() {
      scale = frame.clientWidth / width;
      canvas.style.width = frame.clientWidth + "px";
      canvas.style.height = height * scale + "px";
      fitCanvas(canvas, frame.clientWidth, height * scale);
      slider.value = position[cut.through];
      where.textContent = "slice " + (position[cut.through] + 1) + " / " + data.size[cut.through];
      const context = canvas.getContext("2d");
      const ratio = canvas.width / frame.clientWidth;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, canvas.width, canvas.height);
      drawContent(context);
      drawCross(context);
      drawFurniture(context);
    }

    function drawContent(context) {
      const cutOf = (layer) => cutSlice(volumes[layer], data.size, cut, position[cut.through]);
      const sx = scale * data.spacing_mm[cut.column], sy = scale * data.spacing_mm[cut.row];
      context.imageSmoothingEnabled = false;
      if (shown.reference) {
        const picture = areasOf(cutOf("reference"), colours);
        context.drawImage(picture, 0, 0, sx * picture.width, sy * picture.height);
      }
      context.lineCap = "round";
      for (const [layer, lineWidth] of [["target", 3.2], ["warped", 1.5]]) {
        if (!shown[layer]) continue;
        context.lineWidth = lineWidth;
        for (const [outline, colour] of outlinesOf(layer)) {
          // Stretched to mm first, so that lines keep one width in both directions.
          const path = new Path2D();
          path.addPath(outline, new DOMMatrix([sx, 0, 0, sy, 0, 0]));
          context.strokeStyle = layer === "target" ? themeColour("target") : colour;
          context.stroke(path);
        }
      }
    }

    /** Pairs of path and colour. */
    function outlinesOf(layer) {
      const at = position[cut.through];
      if (smooth) return surfaces[layer].map((s) => [cutOfSurface(s, cut, data.size, at), s.colour]);
      const slice = cutSlice(volumes[layer], data.size, cut, at);
      return data.organs.map((organ, i) => [outlineOf(slice, i + 1), organ.colour]);
    }

    function drawCross(context) {
      const row = cut.rowsUp ? data.size[cut.row] - 1 - position[cut.row] : position[cut.row];
      const x = (position[cut.column] + 0.5) * scale * data.spacing_mm[cut.column];
      const y = (row + 0.5) * scale * data.spacing_mm[cut.row];
      context.strokeStyle = themeColour("accent");
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

    function drawFurniture(context) {
      const w = width * scale, h = height * scale;
      context.font = "600 12px system-ui, sans-serif";
      context.fillStyle = themeColour("soft");
      context.textBaseline = "middle";
      context.textAlign = "left";
      context.fillText(cut.letters[0], 6, h / 2);
      context.textAlign = "right";
      context.fillText(cut.letters[1], w - 6, h / 2);
      context.textAlign = "center";
      context.fillText(cut.letters[2], w / 2, 11);
      context.fillText(cut.letters[3], w / 2, h - 9);
      context.font = "11px system-ui, sans-serif";
      drawScaleBar(context, scale, 8, h - 8, Math.min(w / 3, 90));
    }

    return { draw };
  }
}
