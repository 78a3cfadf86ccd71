run repose
run repose --resume box.off
run repose --rp 2 box.off
run repose --lift-speed 99 box.off
run repose -p tiny box.off
run repose --resume -o none
run repose sphere:40mm=3 sphere:30mm 2>&1 | lines 2
"$SCREE" repose --print -p demo --friction 0.4 --seed 7 >printed.yaml
grep "friction: 0.4\|^seed: 7\|^preset: demo" printed.yaml | cut -d"#" -f1
"$SCREE" repose -c printed.yaml --print >again.yaml
cmp printed.yaml again.yaml && echo the same
printf 'particles: 10\nphases:\n  lift_speed: fast\n' >broken.yaml
run repose -c broken.yaml --print
printf 'particles: 10\nphases: {lift_sped: 1}\n' >broken.yaml
run repose -c broken.yaml --print
printf 'particles: [1\nseed: 3\n' >broken.yaml
run repose -c broken.yaml --print
box 20 12 6 >box.off
printf 'x,y,z,r\n0,0,0,5\n8,0,0,5\n' >pair.csv
printf '0,0,0\n' >bad.csv
"$SCREE" repose -p demo --particles 12 --cylinder 0.08 --disc 0.3 --pack-time 0.1 --settle-time 0.05 \
  --lift-speed 1 --lift-time 0.08 --hold-time 0.02 --drop-height 0.01 --young 1e7 --stiffness 1 --series 0.01 \
  --stop-when-still false --print >small.yaml
small="-c small.yaml --no-picture -j 1"
run repose $small bad.csv
run repose $small --rp 1 sample:box --resolution 0.5mm
"$SCREE" repose $small box.off pair.csv -o whole --frames 0.1 -v >text 2>told || echo failed
grep -c "too small for an angle" told
# what is left of motion differs between compilers, and with it whether that is still
rest() { sed 's/ still.*//; s/ moving.*//'; }
grep -c "angle of repose\|the phases are over after" text
grep -c "particles  *12 in it" text
ls whole
run repose $small box.off pair.csv -o whole
run repose $small box.off pair.csv -o whole --resume --friction 0.3
grep -c "    friction: 0.5" whole/scene.yaml
# without shapes named it is the scene of the checkpoint, and what is said of it must be so there
run repose --resume -o whole --friction 0.1 --lift-speed 0.5 --seed 9
run repose --resume -o whole -p demo 2>&1 | cut -d: -f-3
run repose --resume -o whole --friction 0.5 --frames 0.1 --no-picture | grep -c "the phases are over"
run repose --resume -o whole --frames 0.2
for words in '--rp 0.5' '--rp 0.5,1 -m qecd' --spheres --no-repair '-u m'; do
  run repose --resume -o whole $words 2>&1 | lines 2
done
printf broken >whole/checkpoint.scree
run repose $small box.off pair.csv -o whole --resume

# killed outright, then gone on with
"$SCREE" repose $small --settle-time 100 --checkpoint 0.05 box.off pair.csv -o cut >/dev/null 2>&1 &
victim=$!
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
  [ -f cut/checkpoint.scree ] && break
  sleep 0.5
done
kill -9 $victim
wait $victim 2>/dev/null
"$SCREE" pile cut/checkpoint.scree | head -1 | grep -c "after"

run repose $small --spheres box.off 2>/dev/null | grep -v cost | head -3 | cut -c-60
"$SCREE" pile whole/last.scree >measured || echo failed
tail -n +2 measured >lines
sed -n '/  angle of repose/,$p' text | grep -v "cost\|look at" | diff - lines && echo the same measurement
run pile whole/last.scree --band-low 0.9
run pile whole/last.scree --vtp contacts.vtp --view contacts
run pile whole/last.scree --vtp contacts.txt
# one thing on stdout
for words in '--json --csv' '--json --vtp -' '--csv -o -'; do run pile whole/last.scree $words 2>&1 | lines 2; done
"$SCREE" pile whole/last.scree --csv | head -n 1 | cut -d, -f-3
"$SCREE" pile whole/last.scree --vtp /dev/stdout --json 2>&1 | lines 1
"$SCREE" pile whole/last.scree --vtp - 2>said | head -n 1
cmp said measured && "$SCREE" pile whole/last.scree -q --vtp - 2>&1 | lines 1
head -c 100 whole/last.scree >short.scree
run pile short.scree 2>&1 | sed 's/announces [0-9]*/announces N/'
run pile nothing.scree
"$SCREE" pile whole/frame-000001.scree --csv --vtp frame.vtp >series.csv || echo failed
head -1 series.csv
"$SCREE" pile whole/last.scree --json | grep -o '"heap"\|"mean_rotation"\|"packing_fraction"\|"piles"' | sort -u

# begun anew: nothing of the earlier runs stays, and nothing else goes
mkdir whole/rp-0.5 && touch whole/rp-0.5/result.json whole/rp-0.5/mine.txt whole/scene.png whole/frame-x.scree
"$SCREE" repose $small pair.csv -o whole -f >/dev/null 2>told || echo failed
ls whole whole/rp-0.5
