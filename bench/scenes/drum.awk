# An OBJ of a drum about the y axis. With `wall` 0 an open sheet of n by m quadrilaterals: 2 n m triangles. Else closed:
# an inner surface and an outer one, `wall` m apart, each with two ends of three rings: 4 n (m + 5) triangles.
# usage: awk -v n=N -v m=M -v radius=R -v width=L -v wall=W -f drum.awk
function vertex(r, i, y) {
  printf "v %.9g %.9g %.9g\n", r * cos(2 * pi * i / n), y, r * sin(2 * pi * i / n)
}
function face(a, b, c, inward) {
  if (inward) print "f", a, b, c
  else print "f", a, c, b
}
function band(p, q, inward,   i, k) {
  for (i = 0; i < n; i++) {
    k = (i + 1) % n
    face(p + i, p + k, q + k, inward)
    face(p + i, q + k, q + i, inward)
  }
}
function surface(r, l, inward,   i, j, k, s, rings) {
  for (j = 0; j <= m; j++) for (i = 0; i < n; i++) vertex(r, i, l * (j / m - 0.5))
  for (j = 0; j < m; j++) band(first + j * n, first + (j + 1) * n, inward)
  if (!wall) return
  for (s = -1; s <= 1; s += 2) {
    for (k = 2; k >= 1; k--) for (i = 0; i < n; i++) vertex(r * k / 3, i, s * l / 2)
    vertex(0, 0, s * l / 2)
  }
  for (s = 0; s < 2; s++) {
    rings = first + (m + 1) * n + s * (2 * n + 1)
    k = s ? inward : !inward
    band(first + (s ? m * n : 0), rings, k)
    band(rings, rings + n, k)
    for (i = 0; i < n; i++) face(rings + n + i, rings + n + (i + 1) % n, rings + 2 * n, k)
  }
  first += (m + 1) * n + 2 * (2 * n + 1)
}
BEGIN {
  pi = atan2(0, -1)
  first = 1
  surface(radius, width, 1)
  if (wall) surface(radius + wall, width + 2 * wall, 0)
}
