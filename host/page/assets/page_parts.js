// What the scripts of all pages use: packed numbers, elements, colours, canvases, and how a page starts.

/** Bytes of base64 text. */
function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const floatsOf = (base64) => new Float32Array(bytesOf(base64).buffer);
const indicesOf = (base64) => new Uint32Array(bytesOf(base64).buffer);

/** Numbers of 16 bits between two ends; the largest stands for one that is missing. */
function scaledOf({ low, high, packed }, missing = 0) {
  const steps = new Uint16Array(bytesOf(packed).buffer);
  return Float32Array.from(steps, (step) => step === 65535 ? missing : low + (high - low) * step / 65534);
}

/** Red, green and blue, 0 to 255, of "#rrggbb". */
const rgbOf = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** A colour of the style sheet, as it is at this moment. */
const themeColour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

/** Makes an element with properties and children. */
function element(tag, properties, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

/** A small coloured square; set through the style object, which needs no parsing of markup. */
function swatchOf(colour) {
  const node = element("i", { className: "swatch" });
  node.style.background = colour;
  return node;
}

/** Gives a canvas as many pixels as the screen has there; true if that changed it. */
function fitCanvas(canvas, width, height) {
  const ratio = Math.max(window.devicePixelRatio || 1, 1);
  const w = Math.max(1, Math.round(width * ratio)), h = Math.max(1, Math.round(height * ratio));
  if (canvas.width === w && canvas.height === h) return false;
  canvas.width = w;
  canvas.height = h;
  return true;
}

/** The largest of 1, 2, 5 times a power of ten that is not above the value. */
function roundLength(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].map((s) => s * power).find((length) => length <= value) || power;
}

/** A scale bar with its length in mm, at the lower left of a 2D context in CSS pixels. */
function drawScaleBar(context, pixelsPerMm, x, y, longest, colour = themeColour("soft")) {
  const mm = roundLength(longest / pixelsPerMm);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y - 4);
  context.lineTo(x, y);
  context.lineTo(x + mm * pixelsPerMm, y);
  context.lineTo(x + mm * pixelsPerMm, y - 4);
  context.stroke();
  context.textAlign = "left";
  context.textBaseline = "alphabetic";
  context.fillText(mm + " mm", x + 4, y - 6);
}

/** Runs what each starter starts, draws the page anew when window, light or paper change, and notes in
 *  the attributes of the document how that went. A starter returns functions that draw. */
function startPage(...starters) {
  const page = document.documentElement;
  const failed = (error) => {
    page.dataset.report = "failed";
    page.dataset.error = String((error && error.message) || error);
  };
  window.addEventListener("error", (event) => failed(event.error || event.message));
  try {
    page.dataset.report = "starting";
    const redraws = starters.flatMap((start) => start());
    const redraw = () => redraws.forEach((draw) => draw());
    window.addEventListener("resize", redraw);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    window.matchMedia("print").addEventListener("change", redraw);
    window.addEventListener("beforeprint", () => {
      document.querySelectorAll("details").forEach((d) => { d.open = true; });
      redraw();
    });
    window.addEventListener("afterprint", redraw);
    redraw();
    page.dataset.report = "ready";
  } catch (error) {
    failed(error);
    throw error;
  }
}
