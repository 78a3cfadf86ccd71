#!/bin/sh
# What `make demo` runs: the choice on the nine built-in samples.
# usage: demo.sh PROGRAM FOLDER
set -eu
program=$1
folder=$2
"$program" choose --samples -o "$folder" -f
echo
echo "results: $folder/ (the curves as CSV, the chosen meshes as STL, the figure as PNG and SVG)"
echo "report:  $folder/report.html (open it in a browser)"
