# Ctrl-C while `choose -o DIR` is at work, at many moments: nothing is left, or all is there and the exit code is 0.
# With -f the folder holds an earlier choice, all of it, or the new one, and nothing of the earlier.
export OMP_NUM_THREADS=1 # others are at work here
"$SCREE" sample icosphere-3 -o a.stl -q >/dev/null
"$SCREE" sample icosphere-4 -o b.stl -q >/dev/null
start=$(date +%s%N)
"$SCREE" choose a.stl b.stl -o whole >/dev/null
span=$(($(date +%s%N) - start))
(cd whole && find . | sort) >names
"$SCREE" choose sample:box-12 sample:icosphere-2 -o earlier >/dev/null 2>&1
(cd earlier && find . | sort) >earlier_names
mkdir -p kept && echo mine >kept/notes.txt
stopped=0 finished=0

# attempt FOLDER SECONDS [-f]: what is in the folder when it was stopped is in the file `before`
attempt() {
  timeout --foreground --preserve-status -s INT "$2" "$SCREE" choose a.stl b.stl -o "$1" $3 >said 2>&1
  code=$?
  (cd "$1" 2>/dev/null && find . ! -name notes.txt | sort) >found
  case $code in
  130)
    stopped=$((stopped + 1))
    cmp before found || echo "stopped after $2 s: $(tr '\n' ' ' <found)"
    grep -q cancelled said || echo "stopped after $2 s without a word"
    ;;
  0)
    finished=$((finished + 1))
    cmp names found || echo "finished in $2 s: $(tr '\n' ' ' <found)"
    ;;
  *) echo "exit code $code after $2 s: $(cat said)" ;;
  esac
  ls | grep part
}

i=1
while [ $i -le 18 ]; do
  [ $i -lt 18 ] || span=$((20 * span)) # the last ends, also where others came meanwhile
  seconds=$(echo $((span / 14 * i)) | awk '{ printf "%.4f", $1 / 1e9 }')
  rm -rf new
  : >before
  attempt new "$seconds" ""
  echo . >before
  attempt kept "$seconds" ""
  [ -f kept/notes.txt ] || echo "another's file is gone"
  find kept -mindepth 1 ! -name notes.txt -delete
  if [ $((i % 3)) -eq 0 ]; then
    cp earlier_names before
    rm -rf again && cp -r earlier again
    attempt again "$seconds" -f
  fi
  i=$((i + 1))
done
[ $stopped -gt 5 ] || echo "only $stopped of 42 were stopped"
[ $finished -gt 0 ] || echo "none of 42 was finished"
echo "nothing or all of it"
# the hull of a cylinder takes qhull half a minute, and is left at once
awk 'BEGIN { n = 16000; printf "OFF\n%d %d 0\n", 2 * n, n + 2
  for (i = 0; i < 2 * n; i++) printf "%.9f %.9f %d\n", cos(i % n * 6.283185307 / n), sin(i % n * 6.283185307 / n), (i >= n)
  for (i = 0; i < n; i++) printf "4 %d %d %d %d\n", i, (i + 1) % n, n + (i + 1) % n, n + i
  printf "%d", n; for (i = n; i > 0; i--) printf " %d", i - 1
  printf "\n%d", n; for (i = 0; i < n; i++) printf " %d", n + i; print "" }' >cylinder.off
timeout --foreground -s INT -k 8 2 "$SCREE" measure cylinder.off
echo "exit code $?"
