run export sample:box-12 --to cm --density 1000 -o box.stl
grep -E '"(mass|unit_m|density|volume)"' box.json
run export sample:box-12 -o box.stl
run export sample:box-12 -o box.ply -f --principal -q
run export sample:icosphere-1 --reference sample:icosphere-2 -o ball.vtp
run export sample:icosphere-1 -o ball.vtp
ls
run export sample:box-12
run export sample:box-12 -o box.txt
run export sample:box-12 -o box.vtp --centre
run export sample:box-12 -o box.stl --view points
run export sample:box-12 -o box.stl --reference ball.vtp
run export ball.vtp -o x.stl
printf 'OFF 4 3 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n' >open.off
run export open.off -o x.stl
printf 'screeWLD and nothing more' >cut.scree
run export cut.scree -o pile
run export cut.scree -o pile.stl
run export cut.scree cut.scree -o pile
run export sample:box-12 -o all.pvd
run export cut.scree sample:box-12 -o all.pvd
# endings in any case
run export sample:box-12 -o BOX.VTP -q
run export sample:box-12 -o all.PVD
# a clump of fewer spheres than were asked for says so
run export sample:icosphere-2 --to lammps -n 5 -o fewer 2>&1 | lines 2
# the spheres of a surface are fitted once, for whatever codes
"$SCREE" export sample:box-12 --to yade -n 3 -o first -q && "$SCREE" export sample:box-12 --to yade -n 3 -o second -q
ls "$XDG_CACHE_HOME/scree" | sed 's/-[0-9a-f]*-/-N-/; s/^[0-9.]*/V/' | sort | uniq -c
diff -r first second && echo the same
sed -i '$d' "$XDG_CACHE_HOME"/scree/*-3.csv # which is what is read
"$SCREE" export sample:box-12 --to yade -n 3 -o third | grep -o 'a clump of [0-9]* spheres'
