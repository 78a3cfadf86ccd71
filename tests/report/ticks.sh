#!/bin/sh
# The numbers along an axis: no two alike, none with digits that say nothing. usage: ticks.sh SOURCE_DIR
# Exits 77 where node is missing.
set -eu
command -v node >/dev/null || { echo "skipped: no node installed"; exit 77; }
cat >ticks.mjs <<END
import { ticks } from '$1/web/src/text.js';
const cases = [
  [[0, 0.0005, 0.001, 0.0015, 0.002], '0 0.0005 0.001 0.0015 0.002'],
  [[0, 2e-11, 4e-11], '0 2e-11 4e-11'],
  [[0, 0.1, 0.2, 0.1 + 0.2], '0 0.1 0.2 0.3'],
  [[-0.01, -0.005, 0], '-0.01 -0.005 0'],
  [[36.05, 36.1, 36.15], '36.05 36.1 36.15'],
  [[1e5, 1e5 + 1], '100000 100001'],
  [[1000, 1500], '1000 1500'],
];
for (const [at, right] of cases) {
  const made = ticks(at).join(' ');
  if (made !== right) {
    console.log(\`\${at}: \${made}, not \${right}\`);
    process.exitCode = 1;
  }
}
END
trap 'rm ticks.mjs' EXIT
node ticks.mjs
