run render sample:icosphere-2
for size in 64 0x0 63x64 64x20001 64x64x 64x -64x64 " 64x64" 99999999999999999999x64; do
  run render sample:icosphere-2 -o a.png --size "$size" 2>&1 | lines 2
done
run pile missing.scree -o p.png --size 9x9
run render none.stl -o a.png
run render sample:icosphere-2 -o a.png --from under
run render sample:icosphere-2 -o a.png --rp 0.5,2
run render sample:icosphere-2 sample:box -o a.png --rp 0.5
ls
if "$SCREE" render sample:icosphere-2 -o no.png --size 64x64 --rays 1 2>&1 | grep -q "no ray tracer"; then
  # a build without Embree: the rest as it would be
  printf '\211PNG' >a.png
else
  "$SCREE" render sample:icosphere-2 sample:icosphere-0 -o a.png --size 128x64 --rays 1 --edges --reference sample:icosphere-3
  "$SCREE" render sample:icosphere-3 -o b.png --size 192x64 --rays 1 --rp 0.1,0.02 --color-by distance --from top
  "$SCREE" render sample:icosphere-3 -o c.png --size 192x64 --rays 1 --rp 0.1,0.02 --color-by distance --from left
  cmp -s b.png c.png && echo "the view does not count"
  rm b.png c.png
  rm no.png
fi
ls
head -c 4 a.png | tail -c 3
echo
"$SCREE" render sample:icosphere-2 -o a.png --size 64x64 --rays 1 2>&1 | grep -v "no ray tracer" | head -1
run render sample:icosphere-2 -o a.jpg --size 64x64
run pile missing.scree -o a.jpg 2>&1 | lines 2
