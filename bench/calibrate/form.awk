# Four answers of parameters a to d with noise; the means of `repeats` runs, 1 unless told.
# Angle and time are those of tests/unit/calibrate_twins.c: an angle that a and b trade in, a time that a rules.
function normal() { return sqrt(-2 * log(1 - rand())) * cos(6.283185307179586 * rand()) }
BEGIN {
  srand(seed)
  for (i = 0; i < 20; i++) rand() # the first of neighbouring seeds are alike
  n = repeats ? repeats : 1
  for (i = 0; i < n; i++) {
    angle += (30 + 8 * a + 6 * b + 2 * a * b + exp(0.4 * a) * normal()) / n
    time += (5 + 2 * a - 0.3 * b + 0.15 * normal()) / n
    third += (10 + 3 * c + b * d + normal()) / n
    fourth += (20 + 4 * d + a * c + normal()) / n
  }
  print "angle:", angle "\ntime:", time "\nthird:", third "\nfourth:", fourth
}
