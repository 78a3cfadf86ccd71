#!/bin/sh
# What `make demo` runs: the choice on the nine built-in samples, then a small heap of the chosen shapes.
# usage: demo.sh PROGRAM FOLDER
set -eu
program=$1
folder=$2
"$program" choose --samples -o "$folder" -f
echo
echo "results: $folder/ (the curves as CSV, the chosen meshes as STL, the figure as PNG and SVG)"
echo "report:  $folder/report.html (open it in a browser)"

echo
echo "A heap of these nine shapes at the chosen triangles, in a minute or two:"
"$program" repose "$folder"/*.stl --rp 1 -p demo -o "$folder/heap" -f
[ ! -f "$folder/heap/scene.png" ] || echo "picture:           $folder/heap/scene.png"
