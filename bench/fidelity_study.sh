#!/bin/sh
# Which level of the recommended one's multiples moves the physics: angle of repose, packing, coordination and
# rotation of three sets at six levels, 20 replicates of 300 bodies each. It takes days on two cores; the same call
# goes on where it was stopped, and several machines that share the folder work on it together.
# usage: bench/fidelity_study.sh SCREE SCANS FOLDER [SET...]     sets: devices stones tools, all by default
# A smaller one of stones, half an hour on one core:
#   PARTICLES=120 LEVELS="0.0625*recommended, 0.25*recommended, recommended, 2*recommended" \
#   PHASES="pack_time: 3, settle_time: 0.4, lift_speed: 0.3, lift_time: 3.6, hold_time: 2, still_energy: 1e-4" ...
set -eu
scree=$1 scans=$(cd "$2" && pwd) folder=$3
shift 3
mkdir -p "$folder"
cd "$folder"

# `study NAME SHAPES UNIT CYLINDER DISC` writes NAME.yaml and runs it; the cylinder is some five bodies wide.
study() {
  cat >"$1.yaml" <<YAML
name: $1
replicates: ${REPLICATES:-20}
shapes: [$2]
unit: $3
base:
  preset: ${PRESET:-small}
  particles: ${PARTICLES:-300}
  cylinder: {diameter: $4}
  disc: {diameter: $5}
  phases: {${PHASES:-}}
factors:
  rp: [${LEVELS:-0.0625*recommended, 0.125*recommended, 0.25*recommended, 0.5*recommended, recommended, 2*recommended}]
analysis: {margin_deg: 2, confidence: 0.95}
YAML
  "$scree" study "$1.yaml" -o "$1" --jobs "${JOBS:-1}"
}

for set in "${@:-devices stones tools}"; do
  for name in $set; do
    case $name in
    devices) study devices "sample:fp-1, sample:fp-2, sample:fp-3, sample:dc-1, sample:dc-2, sample:dc-3, sample:sp-1, sample:sp-2, sample:sp-3" mm 0.4 3 ;;
    stones) study stones "$scans/stone_073ac.ply, $scans/stone_E22.ply" m ${CYLINDER:-0.6} 4 ;;
    tools) # in one unit: the hammer's is the inch
      [ -e hammer.ply ] || "$scree" export "$scans/scan_hammer_raw.obj" -u inch --to m -o hammer.ply -q
      study tools "$scans/ycb_power_drill.obj, hammer.ply" m ${CYLINDER:-0.9} 5
      ;;
    *) echo "no set $name: devices, stones, tools" >&2 && exit 2 ;;
    esac
  done
done
