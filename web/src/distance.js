// Exact distances from points to a mesh: a tree of boxes over the triangles, closest-point queries.

const leafSize = 4;

// Puts the k smallest of key[index[low..high)] before position k (quickselect).
function select(index, key, low, high, k) {
  high--;
  while (low < high) {
    const pivot = key[index[(low + high) >> 1]];
    let i = low, j = high;
    while (i <= j) {
      while (key[index[i]] < pivot) i++;
      while (key[index[j]] > pivot) j--;
      if (i <= j) {
        const kept = index[i];
        index[i++] = index[j];
        index[j--] = kept;
      }
    }
    if (k <= j) high = j;
    else if (k >= i) low = i;
    else return;
  }
}

export class Tree {
  constructor({ points, triangles }) {
    this.points = points;
    this.triangles = triangles;
    const count = triangles.length / 3;
    this.index = new Uint32Array(count);
    this.centres = [0, 1, 2].map(() => new Float32Array(count));
    for (let t = 0; t < count; t++) {
      this.index[t] = t;
      for (let k = 0; k < 3; k++) {
        let sum = 0;
        for (let i = 0; i < 3; i++) sum += points[3 * triangles[3 * t + i] + k];
        this.centres[k][t] = sum;
      }
    }
    let nodes = 1;
    while (nodes * leafSize < count) nodes *= 2;
    this.boxes = new Float32Array(6 * 4 * nodes);
    this.begin = new Uint32Array(4 * nodes);
    this.end = new Uint32Array(4 * nodes);
    this.build(1, 0, count);
    this.stack = new Int32Array(128);
    this.near = new Float64Array(128);
  }

  build(node, begin, end) {
    this.begin[node] = begin;
    this.end[node] = end;
    const box = 6 * node;
    const { boxes, index, points, triangles } = this;
    boxes.fill(Infinity, box, box + 3);
    boxes.fill(-Infinity, box + 3, box + 6);
    for (let i = begin; i < end; i++) {
      for (let c = 3 * index[i]; c < 3 * index[i] + 3; c++) {
        for (let k = 0; k < 3; k++) {
          const x = points[3 * triangles[c] + k];
          if (x < boxes[box + k]) boxes[box + k] = x;
          if (x > boxes[box + 3 + k]) boxes[box + 3 + k] = x;
        }
      }
    }
    if (end - begin <= leafSize) return;
    let axis = 0;
    for (let k = 1; k < 3; k++)
      if (boxes[box + 3 + k] - boxes[box + k] > boxes[box + 3 + axis] - boxes[box + axis]) axis = k;
    const middle = (begin + end) >> 1;
    select(index, this.centres[axis], begin, end, middle);
    this.build(2 * node, begin, middle);
    this.build(2 * node + 1, middle, end);
  }

  toBox(node, x, y, z) {
    const b = this.boxes, i = 6 * node;
    const dx = Math.max(b[i] - x, x - b[i + 3], 0);
    const dy = Math.max(b[i + 1] - y, y - b[i + 4], 0);
    const dz = Math.max(b[i + 2] - z, z - b[i + 5], 0);
    return dx * dx + dy * dy + dz * dz;
  }

  // The distance of (x, y, z), which is at most `bound`.
  distance(x, y, z, bound = Infinity) {
    const { stack, near } = this;
    let best = bound * bound, top = 0;
    stack[top] = 1;
    near[top++] = this.toBox(1, x, y, z);
    while (top > 0) {
      const node = stack[--top];
      if (near[top] > best) continue;
      if (this.end[node] - this.begin[node] <= leafSize) {
        for (let i = this.begin[node]; i < this.end[node]; i++) best = Math.min(best, this.toTriangle(this.index[i], x, y, z));
        continue;
      }
      const a = this.toBox(2 * node, x, y, z), b = this.toBox(2 * node + 1, x, y, z);
      const aLast = a <= b; // the nearer child is taken first
      stack[top] = aLast ? 2 * node + 1 : 2 * node;
      near[top++] = Math.max(a, b);
      stack[top] = aLast ? 2 * node : 2 * node + 1;
      near[top++] = Math.min(a, b);
    }
    return Math.sqrt(best);
  }

  // Squared; by the regions of the triangle (Ericson, Real-Time Collision Detection, 5.1.5).
  toTriangle(t, x, y, z) {
    const p = this.points, i = 3 * this.triangles[3 * t], j = 3 * this.triangles[3 * t + 1], k = 3 * this.triangles[3 * t + 2];
    const ax = x - p[i], ay = y - p[i + 1], az = z - p[i + 2];
    const ux = p[j] - p[i], uy = p[j + 1] - p[i + 1], uz = p[j + 2] - p[i + 2];
    const vx = p[k] - p[i], vy = p[k + 1] - p[i + 1], vz = p[k + 2] - p[i + 2];
    const d1 = ux * ax + uy * ay + uz * az, d2 = vx * ax + vy * ay + vz * az;
    const to = (s, r) => {
      const dx = ax - s * ux - r * vx, dy = ay - s * uy - r * vy, dz = az - s * uz - r * vz;
      return dx * dx + dy * dy + dz * dz;
    };
    if (d1 <= 0 && d2 <= 0) return to(0, 0);
    const uu = ux * ux + uy * uy + uz * uz, uv = ux * vx + uy * vy + uz * vz, vv = vx * vx + vy * vy + vz * vz;
    const d3 = d1 - uu, d4 = d2 - uv; // at the second corner
    if (d3 >= 0 && d4 <= d3) return to(1, 0);
    const d5 = d1 - uv, d6 = d2 - vv; // at the third
    if (d6 >= 0 && d5 <= d6) return to(0, 1);
    // a triangle whose corners meet or lie on a line, as coordinates rounded to a grid make, ends at its edges or corners
    const c = d1 * d4 - d3 * d2;
    if (c <= 0 && d1 > 0 && d3 < 0) return to(d1 / (d1 - d3), 0);
    const b = d5 * d2 - d1 * d6;
    if (b <= 0 && d2 > 0 && d6 < 0) return to(0, d2 / (d2 - d6));
    const a = d3 * d6 - d5 * d4;
    if (a <= 0 && d4 - d3 > 0 && d5 - d6 > 0) {
      const w = (d4 - d3) / (d4 - d3 + (d5 - d6));
      return to(1 - w, w);
    }
    const whole = a + b + c;
    return whole > 0 ? to(b / whole, c / whole) : Math.min(to(0, 0), to(1, 0), to(0, 1));
  }
}

// The mesh cut into small triangles with the distance of each corner to the tree's mesh: {points (9 per small
// triangle), distances (3), largest, mean over the area}. Long edges are cut so that about `most` small triangles
// come out.
export function distanceField(mesh, tree, most) {
  const { points, triangles } = mesh;
  const count = triangles.length / 3;
  const areas = new Float64Array(count);
  let total = 0;
  for (let t = 0; t < count; t++) total += areas[t] = areaOf(points, triangles, t);
  const cuts = new Uint16Array(count);
  let made = 0;
  for (let t = 0; t < count; t++) {
    cuts[t] = Math.max(1, Math.min(200, Math.floor(Math.sqrt((areas[t] / (total || 1)) * Math.max(0, most - count)))));
    made += cuts[t] * cuts[t];
  }
  const out = { points: new Float32Array(9 * made), distances: new Float32Array(3 * made), largest: 0, mean: 0 };
  let used = 0, weighted = 0;
  for (let t = 0; t < count; t++) {
    const n = cuts[t];
    const [a, b, c] = [0, 1, 2].map((i) => 3 * triangles[3 * t + i]);
    const row = n + 1, place = new Float32Array(3 * row * row), value = new Float32Array(row * row);
    let sum = 0, corners = 0;
    for (let i = 0; i <= n; i++) {
      for (let j = 0; j + i <= n; j++) {
        const at = i * row + j;
        for (let k = 0; k < 3; k++) place[3 * at + k] = (points[a + k] * (n - i - j) + points[b + k] * i + points[c + k] * j) / n;
        value[at] = tree.distance(place[3 * at], place[3 * at + 1], place[3 * at + 2]);
        out.largest = Math.max(out.largest, value[at]);
        sum += value[at];
        corners++;
      }
    }
    weighted += (areas[t] * sum) / corners;
    for (let i = 0; i < n; i++) {
      for (let j = 0; j + i < n; j++) {
        const at = i * row + j;
        const cells = [[at, at + row, at + 1]];
        if (i + j + 2 <= n) cells.push([at + row, at + row + 1, at + 1]);
        for (const cell of cells) {
          for (const corner of cell) {
            for (let k = 0; k < 3; k++) out.points[3 * used + k] = place[3 * corner + k];
            out.distances[used++] = value[corner];
          }
        }
      }
    }
  }
  out.mean = total > 0 ? weighted / total : 0;
  return out;
}

function areaOf(p, triangles, t) {
  const [i, j, k] = [0, 1, 2].map((c) => 3 * triangles[3 * t + c]);
  const ux = p[j] - p[i], uy = p[j + 1] - p[i + 1], uz = p[j + 2] - p[i + 2];
  const vx = p[k] - p[i], vy = p[k + 1] - p[i + 1], vz = p[k + 2] - p[i + 2];
  return Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
}
