// Surfaces of a view as they are packed in the page, and what follows from their triangles.

/** What values stand for that are not known, such as distances to what the target does not show. */
const missingValue = 1e30;

const zeros = (count) => new Float32Array(count);

/** A surface of a view; displacements and values of a state are unpacked when they are asked for. */
function unpackSurface(data, view) {
  const vertices = floatsOf(data.vertices), triangles = indicesOf(data.triangles);
  const displacement = (k) => data.displacement[k] ? scaledOf(data.displacement[k]) : zeros(vertices.length);
  const lengths = (u) => zeros(u.length / 3).map((_, v) => Math.hypot(u[3 * v], u[3 * v + 1], u[3 * v + 2]));
  return {
    name: data.name, css: data.colour, colour: rgbOf(data.colour).map((c) => c / 255),
    visible: data.shown, plain: data.plain, glass: data.glass, inside: data.inside,
    vertices, triangles, displacement,
    /** Of field f in state k; null where the surface has none. */
    values(f, k) {
      if (f < 0 || data.plain) return null;
      if (view.fields[f].of_displacement) return lengths(displacement(k));
      if (!data.values[f]) return null;
      return data.values[f][k] ? scaledOf(data.values[f][k], missingValue) : zeros(vertices.length / 3);
    },
    outline: data.outline && { vertices: floatsOf(data.outline.vertices), triangles: indicesOf(data.outline.triangles) },
  };
}

/** Normals of the surface displaced by `factor` u, weighted by area. */
function vertexNormals(vertices, u, triangles, factor) {
  const x = u ? vertices.map((v, i) => v + factor * u[i]) : vertices;
  const normals = new Float32Array(x.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const e = [0, 1, 2].map((k) => x[b + k] - x[a + k]), f = [0, 1, 2].map((k) => x[c + k] - x[a + k]);
    const n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) normals[corner + k] += n[k];
  }
  return normals;
}

/** Ends of all edges of the triangles. */
function linesOf(triangles) {
  const lines = new Uint32Array(2 * triangles.length);
  for (let i = 0, at = 0; i < triangles.length; i += 3)
    for (let k = 0; k < 3; ++k) {
      lines[at++] = triangles[i + k];
      lines[at++] = triangles[i + (k + 1) % 3];
    }
  return lines;
}

/** Ends of the edges that belong to one triangle only: rims, and creases where surfaces are split. */
function rimsOf(triangles) {
  const lines = linesOf(triangles), count = new Map();
  const keyOf = (i) => Math.min(lines[i], lines[i + 1]) * 2 ** 26 + Math.max(lines[i], lines[i + 1]);
  for (let i = 0; i < lines.length; i += 2) count.set(keyOf(i), (count.get(keyOf(i)) || 0) + 1);
  return lines.filter((_, i) => count.get(keyOf(i - i % 2)) === 1);
}
