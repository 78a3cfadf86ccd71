# a box of 3 x 2 x 1 and its inner half, as OFF
box 3 2 1 >box.off
sed '$d' box.off | sed 's/^8 6 0/8 5 0/' >open.off
sed 's/^4 0 3 2 1/4 0 1 2 3/' box.off >unlike.off
awk 'NR > 2 && NF == 3 { print $1, $2, $3 + 1; next } { print }' box.off >moved.off
echo "solid nothing" >broken.stl
digits='s/"checksum": "[0-9a-f]*"/"checksum": "..."/; s/\(-\?[0-9]*\.[0-9]\{10\}\)[0-9]*/\1/g'

run measure box.off
# what encloses no volume has no centroid, nor anything else of a body
printf 'OFF 3 2 0\n0 0 0\n4 0 0\n0 4 0\n3 0 1 2\n3 0 2 1\n' >folded.off
run measure folded.off
run measure --json folded.off | grep -A 1 null
run measure --csv folded.off 2>/dev/null | tail -n 1 | cut -d, -f1-10
run measure --unit m open.off
run measure unlike.off
run measure broken.stl box.off | tail -n 3
echo "exit code of a set with a broken file:"
"$SCREE" measure -q broken.stl box.off >/dev/null 2>&1 || echo $?
run measure --json box.off | grep -v '"version"' | sed "$digits"
# what is rounding is shown as zero
run measure sample:icosphere-2 sample:icosphere-3 | grep centroid
awk 'NR > 2 && NF == 3 { print $2, -$1, $3; next } { print }' box.off >turned.off
run measure turned.off | grep -A 2 axes
run measure --csv --unit m box.off moved.off | cut -d, -f1-10
run measure - <box.off | head -n 2
run measure
run measure --json --csv box.off
run distance box.off moved.off
run distance --gap 0.001 --one-way box.off moved.off
run distance --json box.off moved.off | grep -v '"version"' | sed "$digits"
run distance box.off
run distance box.off broken.stl
# a double pyramid with a wall inside: every edge of the wall has three facets, which is not a matter of winding
printf 'OFF 5 7 0\n0 0 0\n4 0 0\n0 4 0\n1 1 3\n1 1 -3\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 1 0 4\n3 2 1 4\n3 0 2 4\n3 0 1 2\n' >wall.off
run measure wall.off 2>&1 | grep -E 'wound|warning'
# far from the origin, a place is told as exactly as beside it
printf 'OFF 4 4 0\n%s 0 0\n%s 0 0\n%s 4 0\n%s 0 4\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' 1000000 1000005 1000000 1000000 >far.off
run measure far.off | grep centroid
