// What src/report/pack.c packs: meshes and tables in meshoptimizer's formats, from base64 in the page.
import { MeshoptDecoder } from '../node_modules/meshoptimizer/meshopt_decoder_reference.js';

export const decoderReady = MeshoptDecoder.ready;

export class Reader {
  // at: where to begin, behind a header
  constructor(id, at = 0) {
    const bytes = bytesOf(id);
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset);
    this.at = at;
  }
  u32() {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }
  real() {
    this.at += 8;
    return this.view.getFloat64(this.at - 8, true);
  }
  reals(count) {
    return Array.from({ length: count }, () => this.real());
  }
  buffer() {
    const size = this.u32();
    this.at += size;
    return this.bytes.subarray(this.at - size, this.at);
  }
  text() {
    return new TextDecoder().decode(this.buffer());
  }
  mesh() {
    return { vertexCount: this.u32(), triangleCount: this.u32(), points: this.buffer(), triangles: this.buffer() };
  }
}

// Parts that the page got after it was loaded, by id.
const given = new Map();
export const give = (id, bytes) => given.set(id, bytes);

// Whether a part is in the page: what would make it too large is left out.
export const holds = (id) => Boolean(id && (given.has(id) || document.getElementById(id)));

function fromBase64(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const bytesOf = (id) => given.get(id) ?? fromBase64(document.getElementById(id).textContent);

export function decodeVertices(bytes, count, size) {
  const out = new Uint8Array(count * size);
  if (count) MeshoptDecoder.decodeVertexBuffer(out, count, size, bytes);
  return out.buffer;
}

// {points: 3 per vertex, in steps of the grid about its middle; triangles}
export function decodeMesh(packed) {
  const words = new Uint16Array(decodeVertices(packed.points, packed.vertexCount, 8));
  const points = new Float32Array(3 * packed.vertexCount);
  for (let v = 0; v < packed.vertexCount; v++) for (let k = 0; k < 3; k++) points[3 * v + k] = words[4 * v + k];
  const triangles = new Uint8Array(12 * packed.triangleCount);
  MeshoptDecoder.decodeIndexBuffer(triangles, 3 * packed.triangleCount, 4, packed.triangles);
  return { points, triangles: new Uint32Array(triangles.buffer) };
}
