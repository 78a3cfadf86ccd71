# decimation.csv as Markdown: one table per file, a block of rows per level, the levels of all methods
# side by side.
BEGIN { FS = ","; print "# Decimation: scree and its peers\n" }
/^#/ { print substr($0, 3) "  "; next }
$1 == "file" { next }
$1 != file {
  file = $1
  level = ""
  printf "\n## %s\n\n", file
  print "CPU seconds of one level (of all levels for scree and the chained peers, on the first row);"
  print "ratio to one meshopt_simplify call to Rp = 1e-3; lengths in the file's unit.\n"
  print "| method | asked | got | CPU s | ratio | B/tri | eps_s | eps_v | mean | mean back |" \
        " Hausdorff | folds | worst deg | crossings | non-manifold e/v | open | degenerate |"
  print "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
}
{
  printf "| %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s | %s/%s | %s | %s |\n",
    $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19
}
