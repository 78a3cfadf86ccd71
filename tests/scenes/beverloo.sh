#!/usr/bin/env bash
# Spheres out of a flat-bottomed bin through round openings: the rate over the width follows Beverloo's exponent
# (Beverloo, Leniger and van de Velde 1961), W ~ (D - 1.4 d)^2.5, within 0.2.
# usage: beverloo.sh SCREE
set -euo pipefail
scree=$(realpath -e "$1")
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT
export OMP_NUM_THREADS=1

# A plate of radius 60 mm with a hole, as a sheet of 96 x 2 triangles, mm.
plate() {
  awk -v r="$1" 'BEGIN {
    print "solid plate"
    for (i = 0; i < 96; i++) {
      a = i * 6.283185307179586 / 96; b = (i + 1) * 6.283185307179586 / 96
      split(sprintf("%g %g;%g %g;%g %g;%g %g", r*cos(a), r*sin(a), 60*cos(a), 60*sin(a), 60*cos(b), 60*sin(b), r*cos(b), r*sin(b)), p, ";")
      for (k = 2; k < 4; k++)
        printf "facet normal 0 0 1\nouter loop\nvertex %s 0\nvertex %s 0\nvertex %s 0\nendloop\nendfacet\n", p[1], p[k], p[k+1]
    }
    print "endsolid"
  }'
}

for width in 21 25 30 36; do
  plate "$(awk -v d=$width 'BEGIN { print d / 2 }')" >plate.stl
  cat >bin.yaml <<YAML
time: 0.9
materials:
  grain: {young: 5e5, density: 2500, restitution: 0.5, friction: 0.3}
shapes:
  ball: {sphere: 0.006}
geometry:
  plate: {file: plate.stl, unit: mm}
  tube: {cylinder: {radius: 0.045, length: 1}}
  # closes the opening, and falls away
  plug: {disc: {radius: 0.03}, at: [0, 0, -0.0005], motion: [{translate: {velocity: [0, 0, -4]}, from: 0.4}]}
inlets:
  fill: {cylinder: {at: [0, 0, 0.01], radius: 0.045}, shapes: ball, count: 3600, velocity: [0, 0, -1], layers: {packed: grid}}
domain: {min: [-1, -1, -0.1], max: [1, 1, 2]}
sensors:
  out: {flow: {through: [0, 0, -0.01], normal: [0, 0, -1]}}
output: {series: 0.05}
YAML
  "$scree" run bin.yaml -o "out-$width" --no-picture -q >/dev/null
  # bodies a second from 0.55 s on, when it flows steadily
  awk -F, -v width=$width 'NR == 2 { for (i = 1; i <= NF; i++) { if ($i ~ /^time /) t = i; if ($i ~ /^out.count/) c = i } }
    NR > 2 && $t >= 0.5499 && !seen { seen = 1; t0 = $t; c0 = $c } { t1 = $t; c1 = $c }
    END { printf "%g %g\n", width, (c1 - c0) / (t1 - t0) }' "out-$width/series.csv" | tee -a rates
done
awk '{ x = log($1 - 1.4 * 6); y = log($2); n++; sx += x; sy += y; sxx += x * x; sxy += x * y }
  END { e = (n * sxy - sx * sy) / (n * sxx - sx * sx); printf "exponent %.3f, Beverloo 2.5\n", e; exit !(e > 2.3 && e < 2.7) }' rates
