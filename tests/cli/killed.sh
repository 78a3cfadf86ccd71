# Whatever stops a verb, a file under its final name is whole: killed outright, ended by a signal, or out of
# room on the disk. The oracle is the same command left alone.
"$SCREE" sample icosphere-4 -o ball.stl >/dev/null
"$SCREE" choose ball.stl -o chosen >/dev/null

# What stands in `out` is as in ../left/out, or the beginning of a table that grows, or tells the time.
compare() {
  find out -type f 2>/dev/null | while read -r file; do
    whole=../left/$file
    case $file in
    *.part | *.part/* | *.scree-lock) [ "$1" = killed ] || echo "$2: $1 left $file" ;;
    *provenance.json) [ "$(tail -c 2 "$file")" = "}" ] || echo "$2: $1 left half of $file" ;;
    *motion.scree) # grows by a frame of 160 bytes; its last may be of the moment when the signal came
      at=$(cmp "$file" "$whole" 2>/dev/null | sed -n 's/.*differ: byte \([0-9]*\),.*/\1/p')
      [ "${at:-999999}" -gt $(($(wc -c <"$file") - 160)) ] || echo "$2: $1 changed $file"
      ;;
    *result.json) [ "$(tail -c 2 "$file")" = "}" ] || echo "$2: $1 left half of $file" ;;
    *checkpoint.scree) # stands where the other one never was: as long as its header says
      [ "$(wc -c <"$file")" -eq $(($(od -An -tu8 -j16 -N8 "$file") + 40)) ] ||
        echo "$2: $1 left half of $file"
      ;;
    *report.html) [ "$(tail -c 8 "$file")" = "</html>" ] || echo "$2: $1 left half of $file" ;;
    *.pdf) [ "$(tail -c 6 "$file")" = "%%EOF" ] || echo "$2: $1 left half of $file" ;;
    *series.csv) # its last line may be half of one, or of the moment when the signal came
      sed '$d' "$file" >../lines
      head -n "$(wc -l <../lines)" "$whole" | cmp -s - ../lines || echo "$2: $1 changed $file"
      ;;
    *.pvd) tail -1 "$file" | grep -q '^</VTKFile>$' || echo "$2: $1 left half of $file" ;; # grows with each frame
    *result.txt | *bodies.csv) # of the moment when the signal came
      [ "$1" = ended ] && [ -z "$(tail -c 1 "$file")" ] || cmp -s "$file" "$whole" || echo "$2: $1 left half of $file"
      ;;
    *) cmp -s "$file" "$whole" || echo "$2: $1 left half of $file" ;;
    esac
  done
}

# try NAME WORDS...
try() {
  name=$1
  shift
  rm -rf left && mkdir -p left/out && cd left || exit
  start=$(date +%s%N)
  "$SCREE" "$@" >/dev/null 2>said || cat said
  span=$(($(date +%s%N) - start))
  cd ..
  for part in 1 3 5; do
    for how in killed ended; do
      [ $how = killed ] && signal=KILL || signal=TERM
      rm -rf cut && mkdir -p cut/out && cd cut || exit
      timeout --foreground -s $signal "$(echo $((span * part / 6)) | awk '{ printf "%.3f", $1 / 1e9 }')" \
        "$SCREE" "$@" >/dev/null 2>said
      compare $how "$name"
      cd ..
    done
  done
  for room in 0 9 70; do # blocks of 512 bytes
    rm -rf cut && mkdir -p cut/out && cd cut || exit
    (
      ulimit -f $room
      "$SCREE" "$@" >/dev/null 2>&1 | cat >/dev/null
    )
    compare full "$name"
    cd ..
  done
  echo "$name: whole or not there"
}

try simplify simplify ../ball.stl -n 500 -o out/level.ply
try sample sample icosphere-5 -o out
try repair repair ../ball.stl -o out/repaired.ply
try choose choose ../ball.stl -o out
try render render ../ball.stl -o out/ball.png --size 200x200
try report report ../chosen -o out/page.html
try export export ../ball.stl -o out/ball.obj
try drop drop sphere:40mm=6 -o out --time 0.05 --no-picture --frames 0.02
