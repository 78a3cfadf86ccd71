# every option of every verb is in the one table, which is sorted and gives a letter once
"$SCREE" help --options >table && cut -f 1 table >names && LC_ALL=C sort -c names
cut -f 2 table | grep . | sort | uniq -d
tab=$(printf '\t')
for verb in $("$SCREE" help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | grep -v 'help\|version'); do
  "$SCREE" help $verb | sed -n "s/^  -\(.\), --\([a-z-]*\).*/\2$tab-\1/p; s/^      --\([a-z-]*\).*/\1$tab/p" >options
  while IFS= read -r option; do
    grep -q "^$option$tab" table || echo "$verb: not in the table: $option"
  done <options
  cut -f 1 options >>seen
done
# and there are no others in it
LC_ALL=C sort -u seen | comm -13 - names
