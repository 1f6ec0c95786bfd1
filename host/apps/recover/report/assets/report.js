// Start of the report page: its viewers of surfaces and of slices.

/** Voxels from run lengths: a value byte, then its length with 7 bits a byte, low first. */
function voxelsOf(base64, count) {
  const bytes = bytesOf(base64);
  const voxels = new Uint8Array(count);
  let at = 0;
  for (let i = 0; i < bytes.length;) {
    const value = bytes[i++];
    let length = 0, shift = 0, byte;
    do {
      byte = bytes[i++];
      length += (byte & 127) * 2 ** shift;
      shift += 7;
    } while (byte & 128);
    voxels.fill(value, at, at + length);
    at += length;
  }
  if (at !== count) throw new Error("label volume: " + at + " voxels instead of " + count);
  return voxels;
}

/** The slices; where organs have surfaces their outlines are those that the viewer shows. */
function startSlices() {
  const data = JSON.parse(document.getElementById("palpate-data").textContent);
  const viewer = document.querySelector(".surface-viewer");
  const surfaces = viewer ? surfaceViewOf(viewer).surfaces : [];
  return data.volumes ? [startSliceViewer(data.volumes, surfaces, data.pictures)] : [];
}

startPage(startSurfaceViewers, startSlices);
