"$SCREE" sample icosphere-4 -o icosphere-4.stl >/dev/null 2>&1
run curve icosphere-4.stl --grid 1e-3:1e-1:2
run curve icosphere-4.stl --grid 1e-2:1e-1:2 -m qecd --distance --points 2000
run curve icosphere-4.stl --grid 1e-2:1e-1:1 --csv --threads 1
# the digits of the CSV are JSON's
"$SCREE" curve icosphere-4.stl --grid 1e-2:1e-1:1 --distance --json >levels.json
"$SCREE" curve icosphere-4.stl --grid 1e-2:1e-1:1 --distance --csv | tail -n 1 | tr ',' '\n' >numbers
grep -c . numbers
while read -r number; do
  awk -v n="$number" '{ gsub(/[,":]/, " "); for (i = 1; i <= NF; i++) found = found || ($i ~ /^[-0-9]/ && $i + 0 == n + 0) } END { if (!found) print n, "is not in the JSON" }' levels.json
done <numbers
# both ends are in the table, met by a step or not
run curve icosphere-4.stl --grid 1e-2:0.05:1
run simplify icosphere-4.stl -r 1e-2 -o out.ply
run simplify icosphere-4.stl -r 1e-2 --fit -o fitted.ply
run simplify icosphere-4.stl -n 3 -o least.off
head -3 least.off | tail -1
run simplify icosphere-4.stl -n 3 -o least.off
run simplify icosphere-4.stl -n 500 -m qecd -o - -q | wc -c
run simplify icosphere-4.stl -e 0.05mm -o fine.stl -q
run simplify icosphere-4.stl -o x.stl 2>&1
run simplify icosphere-4.stl -n 10 2>&1
run simplify icosphere-4.stl -n 10 -r 0.1 -o x.stl 2>&1
run simplify missing.stl -n 10 -o x.stl 2>&1
run curve icosphere-4.stl --grid 0.1:0.01:9 2>&1
# a length or a share of nothing, and one in hexadecimal
for e in 0 -0 1e-400m 0x1mm; do run simplify icosphere-4.stl -e $e -o x.stl 2>&1 | lines 2; done
run simplify icosphere-4.stl -r 0x10 -o x.stl 2>&1 | lines 2
run simplify icosphere-4.stl -n 0x10 -o x.stl 2>&1 | lines 2
# what is no closed surface is repaired first, or refused, or taken as it is when asked; as choose does
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >lone.off
printf 'OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n' >flat.off
box 3 2 1 | sed -e 's/^8 6 0/8 5 0/' -e '/^4 3 0 4 7/d' >hole.off
for name in lone flat; do
  run simplify $name.off -r 1 -o x.off
  run choose $name.off
  run simplify $name.off -r 1 --no-repair -o x.off
  run simplify $name.off -r 1 --unchecked -o $name-same.off
done
run simplify hole.off -r 1 --no-repair -o x.off
run simplify hole.off -r 1 --unchecked -o open.off
run simplify hole.off -r 1 --no-repair --unchecked -o x.off 2>&1 | lines 2
run simplify hole.off -r 1 -o closed.off
run check -q hole.off open.off closed.off
# a sheet thinner than single precision resolves there: an STL would not hold it
box 1 1 0.000001 | sed 's/ 0$/ 1000/; s/ 0.000001$/ 1000.000001/' >thin.off
for output in thin.stl -; do run simplify thin.off -r 1 -o $output; done
run repair thin.off -o thin.stl
run choose thin.off -o chosen -q
run simplify thin.off -r 1 --density 1000 -o thin.stl
run simplify thin.off -r 1 -o thin.ply
run check -q thin.ply
ls thin*
# the table and the picture of levels are of the scan that simplify and choose decimate
run curve hole.off --grid 1:1:9 2>&1
run curve hole.off --grid 1:1:9 --unchecked
run curve lone.off --no-repair 2>&1
run curve hole.off --no-repair --unchecked 2>&1 | lines 2
run render hole.off --rp 1 -o levels.png 2>&1
# the line of progress is gone when something else is printed, and keeps to a narrow terminal
"$SCREE" sample icosphere-6 -o fine.ply >/dev/null
for words in "simplify fine.ply -n 100 -o none.off" "curve fine.ply --grid 1e-2:1e-2:9"; do
  "$SCREE" $words --progress 2>&1 | tr '\r' '\n' | grep -c 'left *[^ ]'
done
command -v python3 >/dev/null || echo "lines of progress: some, longer than 29: 0" # no terminal to try it on
command -v python3 >/dev/null && python3 - "$SCREE" <<'PYTHON'
import fcntl, os, pty, re, struct, sys, termios
child, terminal = pty.fork()
if child == 0:
    fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 30, 0, 0))
    os.execv(sys.argv[1], [sys.argv[1], "simplify", "fine.ply", "-n", "100", "-o", "narrow.off", "-q", "--progress"])
said = b""
while True:
    try:
        part = os.read(terminal, 4096)
    except OSError:
        break
    if not part:
        break
    said += part
os.waitpid(child, 0)
lines = [line for line in re.split(rb"[\r\n]", said) if line.strip()]
print("lines of progress:", "some," if lines else "none,", "longer than 29:", sum(len(line) > 29 for line in lines))
PYTHON
