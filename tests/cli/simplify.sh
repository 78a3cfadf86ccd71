"$SCREE" sample icosphere-4 -o icosphere-4.stl >/dev/null 2>&1
run curve icosphere-4.stl --from 1e-3 --per-decade 2
run curve icosphere-4.stl --from 1e-2 --per-decade 2 -m qecd --distance --samples 2000
run curve icosphere-4.stl --from 1e-2 --per-decade 1 --csv --threads 1
run simplify icosphere-4.stl -r 1e-2 -o out.ply
run simplify icosphere-4.stl -n 7 -o six.off
head -3 six.off | tail -1
run simplify icosphere-4.stl -n 7 -o six.off
run simplify icosphere-4.stl -n 500 -m qecd -o - -q | wc -c
run simplify icosphere-4.stl -e 0.05mm -o fine.stl -q
run simplify icosphere-4.stl -o x.stl 2>&1
run simplify icosphere-4.stl -n 10 2>&1
run simplify icosphere-4.stl -n 10 -r 0.1 -o x.stl 2>&1
run simplify missing.stl -n 10 -o x.stl 2>&1
run curve icosphere-4.stl --from 0.1 --to 0.01 2>&1
