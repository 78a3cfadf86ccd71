# heaps that users have: a scan on its side, an outline with its unit, and what is wrong with them
awk 'BEGIN { n = 81; printf("OFF\n%d %d 0\n", n * n, 2 * (n - 1) * (n - 1))
  for (j = 0; j < n; j++) for (i = 0; i < n; i++) {
    x = 5 * (i - 40); y = 5 * (j - 40); z = 0.5 * (150 - sqrt(x * x + y * y)); printf("%g %g %g\n", (z > 0 ? -z : 0), x, y) }
  for (j = 0; j + 1 < n; j++) for (i = 0; i + 1 < n; i++) { k = j * n + i; print 3, k, k + 1, k + n + 1; print 3, k, k + n + 1, k + n } }' >cone.off
run pile cone.off
run pile cone.off --unit m --sectors 12 | sed -n 2p
run pile cone.off --csv | awk -F, 'NR == 1 || ($2 > .07 && !n++) { print }'
"$SCREE" pile cone.off --json | grep -oE '"(kind|up|share|filled|sectors|volume_deg)"'
"$SCREE" pile cone.off --csv >seen.csv
run pile seen.csv | sed -n 4p
printf 'x [cm],z [cm]\n-15,0\n0,7.5\n15,0\n' >outline.csv
run pile outline.csv
printf -- '-150,0\n0,75\n150,0\n' >plain.csv
"$SCREE" pile plain.csv >in_mm
"$SCREE" pile outline.csv | cmp - in_mm
# what is wrong
box 3 2 1 >box.off
run pile outline.csv --picture-width 1m
run pile nowhere.png --picture-width 1m
run pile outline.csv --sectors 8
run pile outline.csv -o heap.png
run pile sample:icosphere-4
printf 'x,z\n1,0\n0,1\n' >wrong.csv
run pile wrong.csv
printf '\211PNG\r\n\032\n' >wrong.png
run pile wrong.png
run pile wrong.png --picture-width 1m
run pile cone.off --band-low 0.9
