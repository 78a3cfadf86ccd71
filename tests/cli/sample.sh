run sample --list
run sample fp-1 sp-3 box-12 --resolution 2mm -o out/samples
ls out/samples
run sample fp-1 --resolution 2mm -o out/samples 2>&1
run sample fp-1 --resolution 2mm -o out/samples -f --threads 1
run sample sphere --resolution 2mm -o sphere.ply
run sample dc-1 --resolution 2mm -o - 2>/dev/null | wc -c
run sample dc-9 2>&1
run sample dc-1 --noise 0.5mm 2>&1
run sample dc-1 --noise 0.5 2>&1
run sample --resolution 6mm 2>&1
run sample dc-1 dc-2 -o both.stl 2>&1
run sample box-12 sphere box-12 -o twice 2>&1 | lines 2
ls -d twice 2>&1
