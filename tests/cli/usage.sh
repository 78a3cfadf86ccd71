run 2>&1 | head -4
run nonsense
run help nonsense
"$SCREE" --version | sed 's/[0-9][0-9.]*/N/'
"$SCREE" help | tail -4
