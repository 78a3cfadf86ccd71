# What the how-tos speak of: a scan and levels of it, a heap, a study.
scree sample fp-1 --resolution 2mm -q -o scan.stl
scree simplify scan.stl -u mm -n 200 -q -o level.stl
scree simplify scan.stl -u mm -n 100 -q -o p.stl
scree repose p.stl -u mm --particles 8 --pack-time 0.3 --settle-time 0.1 --lift-time 0.3 --hold-time 0.1 --no-picture -q -o heap
cat >study.yaml <<'END'
shapes: [sample:box-12]
base: {preset: demo, particles: 4}
replicates: 2
END
