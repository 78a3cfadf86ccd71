# decimation.csv as a table of ratios: method `volume` over the peer that is best in it at each level
# asked for, its mean distance over Lindstrom-Turk's and its Hausdorff distance over chained
# meshoptimizer's, and what is wrong with the peer's level: edges folded over 150 degrees, pairs of
# facets that cross, edges of more than two facets, facets without an area, whatever the scan has.
BEGIN { FS = ","; least = 30 }
/^#/ || $1 == "file" { next }
{ key = $1 "," $3; got[$2, key] = $4; mean[$2, key] = $10; far[$2, key] = $12 }
{ folds[$2, key] = $13; cross[$2, key] = $15; edges[$2, key] = $16; flat[$2, key] = $19 }
$2 == "volume" { order[++count] = key }
function faults(peer, key, text) {
  if (folds[peer, key] > 0) text = text ", " folds[peer, key] " folded"
  if (cross[peer, key] > 0) text = text ", " cross[peer, key] " crossing"
  if (edges[peer, key] > 0) text = text ", " edges[peer, key] " non-manifold"
  if (flat[peer, key] > 0) text = text ", " flat[peer, key] " degenerate"
  return substr(text, 3)
}
# One column: the ratio, bold where it is over the bar, and the peer's faults.
function cell(peer, key, mine, its, bar, what, ratio, bad) {
  if (!((peer, key) in got) || its == "" || !(its > 0)) return "| | "
  ratio = mine / its
  bad = faults(peer, key)
  if (substr(key, index(key, ",") + 1) + 0 > least) {
    all[what]++; sum[what] += log(ratio); held[what] += ratio <= bar
    if (bad == "") { sound[what]++; sound_sum[what] += log(ratio); sound_held[what] += ratio <= bar }
  }
  return sprintf("| %s%.2f%s | %s ", ratio > bar ? "**" : "", ratio, ratio > bar ? "**" : "", bad == "" ? "sound" : bad)
}
function line(what, name, bar) {
  if (!all[what]) return
  printf "| %s | %g | %d of %d | %.2f | %d of %d | %s |\n", name, bar, held[what], all[what], exp(sum[what] / all[what]),
    sound_held[what], sound[what], sound[what] ? sprintf("%.2f", exp(sound_sum[what] / sound[what])) : ""
}
END {
  if (!count) exit
  for (i = 1; i <= count; i++) {
    key = order[i]
    split(key, part, ",")
    row = cell("cgal_lt", key, mean["volume", key], mean["cgal_lt", key], 1.05, "mean") \
      cell("meshopt_today_chained", key, far["volume", key], far["meshopt_today_chained", key], 1, "far")
    rows = rows sprintf("| %s | %s | %s %s|\n", part[1], part[2], got["volume", key], row)
  }
  print "\n## The bars\n"
  print "Method `volume` over the peer that is best in this at the same count. Sound: no edge of the peer's level is folded over"
  print "150 degrees, no facets cross, no edge has more than two, none is without an area. Levels asked for at more than 30 triangles count.\n"
  print "| | at most | held | geometric mean | held of levels where the peer's is sound | geometric mean |"
  print "|---|--:|--:|--:|--:|--:|"
  line("mean", "mean distance over Lindstrom-Turk's", 1.05)
  line("far", "Hausdorff distance over chained meshoptimizer's", 1)
  print "\n| body | asked | got | mean | Lindstrom-Turk's level | Hausdorff | chained meshoptimizer's level |"
  print "|---|--:|--:|--:|---|--:|---|"
  printf "%s", rows
}
