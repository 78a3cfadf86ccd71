"$SCREE" choose sample:icosphere-4 -o one >/dev/null
run report one
run report one
run report one -o one/report.html
"$SCREE" report one -o - | head -n 1
rm one/report.html
run report one -o one/report.html -q && cmp one/report.html report.html
grep -c 'id="part-' report.html
# levels that an earlier choice left are no part of the page
cp report.html kept.html
cp one/levels/icosphere-4.levels one/levels/stale.levels
run report one -q -f
cmp report.html kept.html && echo the same
rm one/levels/stale.levels
grep -o "default-src 'none'" report.html
mkdir empty
run report empty -o x.html
run report missing -o x.html
cp -r one bad && printf '{"a": [1,}' >bad/choice.json
run report bad -o x.html
cp -r one cut && head -c 3000 one/levels/icosphere-4.levels >cut/levels/icosphere-4.levels
run report cut -o x.html
cp -r one other && echo nothing >other/levels/icosphere-4.levels
run report other -o x.html
ls x.html* 2>/dev/null
run report
run report one -o
