#!/bin/sh
# The page's distances to triangles beside a fine net of points on them, corners on a coarse grid: many meet or lie on a
# line. usage: distances.sh SOURCE_DIR
# Exits 77 where node is missing.
set -eu
command -v node >/dev/null || { echo "skipped: no node installed"; exit 77; }
cat >distances.mjs <<END
import { Tree } from '$1/web/src/distance.js';
let state = 1;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
const net = 200;
for (let trial = 0; trial < 1000; trial++) {
  const corners = Float32Array.from({ length: 9 }, () => Math.floor(3 * random()));
  const x = [0, 1, 2].map(() => (trial % 2 ? Math.floor(5 * random()) - 1 : 5 * random() - 1));
  const found = new Tree({ points: corners, triangles: Uint32Array.of(0, 1, 2) }).distance(...x);
  let least = Infinity;
  for (let i = 0; i <= net; i++)
    for (let j = 0; i + j <= net; j++)
      least = Math.min(least, Math.hypot(...x.map((v, k) => v - (corners[k] * (net - i - j) + corners[3 + k] * i + corners[6 + k] * j) / net)));
  if (!(Math.abs(found - least) < 0.02)) {
    console.log(\`\${x} to \${corners}: \${found}, not \${least}\`);
    process.exitCode = 1;
    break;
  }
}
END
trap 'rm distances.mjs' EXIT
node distances.mjs
