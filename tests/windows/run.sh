#!/bin/sh
# scree.exe under Wine beside the program of this system: the same choice, names and options as on Windows.
# usage: run.sh SCREE_EXE SCREE
set -eu
exe=$(realpath "$1")
scree=$(realpath "$2")
folder=$(mktemp -d)
trap 'WINEPREFIX="$folder/wine" wineserver -k 2>/dev/null || true; rm -rf "$folder"' EXIT
export WINEDEBUG=-all WINEPREFIX="$folder/wine" WINEDLLOVERRIDES="mscoree=;mshtml="
cd "$folder"
win() { wine "$exe" "$@" 2>err; }
passed=0
failed=0
check() { # name, status of what was tried
  if [ "$2" -eq 0 ]; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED: $1"
    sed 's/^/  /' err
  fi
}
try() {
  what=$1
  shift
  if "$@"; then check "$what" 0; else check "$what" 1; fi
}
expect_code() { # code, words: of scree.exe
  code=$1
  shift
  got=0
  win "$@" >out || got=$?
  [ "$got" -eq "$code" ]
}

"$scree" sample sp-1 --resolution 3mm -q -o phone.stl >/dev/null
wine "$exe" version >out 2>err
try "version names what is missing" grep -q "^without figures" out

# The same numbers to the last digit.
"$scree" choose phone.stl -q -o linux >/dev/null
try "choose" expect_code 0 choose phone.stl -q -o windows
plain() { sed 's/"\(mesh_file\|command\)": "[^"]*"//' "$1"; }
plain linux/choice.json >a
plain windows/choice.json >b
try "the same choice" cmp a b
tail -c +81 linux/phone.stl >a
tail -c +81 windows/phone.stl >b
try "the same mesh" cmp a b

name='Gerät größer.stl'
cp phone.stl "$name"
try "names in UTF-8" expect_code 0 measure "$name"
try "and told in UTF-8" grep -q "Gerät größer" out
try "a file that is there is refused" expect_code 1 simplify "$name" -n 100 -o phone.stl
try "with -f it is replaced" expect_code 0 simplify "$name" -n 100 -f -o b.stl
try "and again" expect_code 0 simplify "$name" -n 60 -f -o b.stl
mkdir -p scans && "$scree" sample box-12 sphere --resolution 3mm -q -o scans >/dev/null
try "wildcards stand for files" expect_code 0 measure 'scans\*.stl'
try "for all of them" test "$(grep -c '^scans/.*stl' out)" -eq 2
try "or for themselves" expect_code 1 measure 'scans\*.ply'
long=$(printf 'folder%.0s' 1 2 3 4 5 6 7 8 9 10)
mkdir -p "$long/$long/$long/$long/$long"
cp phone.stl "$long/$long/$long/$long/$long/p.stl"
try "long paths" expect_code 0 measure "$long/$long/$long/$long/$long/p.stl"
try "back slashes" expect_code 0 measure "$long\\$long\\$long\\$long\\$long\\p.stl"
printf 'OFF\r\n4 4 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n0 0 1\r\n3 0 2 1\r\n3 0 1 3\r\n3 1 2 3\r\n3 0 3 2\r\n' >crlf.off
try "lines that end in CR LF" expect_code 0 measure crlf.off
try "no such file" expect_code 1 measure nothing.stl
try "says so" grep -q "nothing.stl: cannot open" err
try "wrong usage" expect_code 2 measure --nothing

# Two worker processes; the same states as here.
cat >tiny.yaml <<'END'
name: tiny
replicates: 2
shapes: [sample:icosphere-1]
base:
  preset: demo
  particles: 8
  cylinder: {diameter: 0.4}
  phases: {pack_time: 0.3, settle_time: 0.05, lift_speed: 1, lift_time: 0.3, hold_time: 0.05}
factors:
  rp: [spheres]
END
hashes() { grep -h '"hash"' "$1"/results/*.yaml; }
"$scree" study tiny.yaml -o study-linux -q --jobs 1 >/dev/null
try "a study by two processes" expect_code 0 study tiny.yaml -o study-windows -q --jobs 2
hashes study-linux >a
hashes study-windows >b
try "ends in the same states" cmp a b

# Ctrl-C keeps what was done; 58 are the last eight bits of what Windows calls an end by Ctrl-C.
interrupted() {
  wine "$exe" drop sample:icosphere-2=100 -o dropped >out 2>err &
  program=$!
  for _ in $(seq 300); do
    [ -e dropped/motion.scree ] && break
    sleep 0.2
  done
  kill -INT $program
  got=0
  wait $program || got=$?
  [ "$got" -eq 58 ] && [ -e dropped/checkpoint.scree ]
}
try "Ctrl-C leaves a checkpoint" interrupted
try "says so" grep -q "can be resumed" err
try "and it goes on" expect_code 0 drop sample:icosphere-2=100 -o dropped --resume -q

printf '\n%d passed, %d failed\n' "$passed" "$failed"
[ "$failed" -eq 0 ]
